//! Bitmaps that are computed.

use glam::Vec3;
use lie_geom::RandomKey;

use crate::{Texture, draft::Draft};

/// Puts a texture into a draft; its index.
pub(super) fn add_texture(draft: &mut Draft, texture: Texture) -> u32 {
    draft.textures.push(texture);
    draft.textures.len() as u32 - 1
}

/// A bitmap of linear colours, stored as sRGB.
pub(super) fn bitmap(width: u32, height: u32, color: impl Fn(u32, u32) -> Vec3) -> Texture {
    let encode = |linear: f32| (linear.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0).round() as u8;
    let texels = (0..width * height)
        .map(|index| {
            let [r, g, b] = color(index % width, index / width).to_array().map(encode);
            [r, g, b, 255]
        })
        .collect();
    match Texture::new(width, height, true, texels) {
        Ok(texture) => texture,
        Err(error) => unreachable!("a bitmap has the size it was made with: {error}"),
    }
}

/// Value noise that repeats after `period` cells.
pub(super) fn noise(key: RandomKey, x: f32, y: f32, period: u32) -> f32 {
    let at = |x: u32, y: u32| {
        key.mix(u64::from(x % period))
            .mix(u64::from(y % period))
            .uniform(0)
    };
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let (sx, sy) = (fx * fx * (3.0 - 2.0 * fx), fy * fy * (3.0 - 2.0 * fy));
    let (x0, y0) = (x0 as u32, y0 as u32);
    let top = at(x0, y0) * (1.0 - sx) + at(x0 + 1, y0) * sx;
    let bottom = at(x0, y0 + 1) * (1.0 - sx) + at(x0 + 1, y0 + 1) * sx;
    top * (1.0 - sy) + bottom * sy
}
