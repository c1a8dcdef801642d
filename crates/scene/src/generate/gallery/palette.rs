//! Materials, and the small bitmaps they use.

use glam::{Affine2, Vec2, Vec3};
use lie_geom::RandomKey;

use crate::{
    Material, Texture, TextureRef,
    draft::Draft,
    generate::bitmap::{add_texture, bitmap, noise},
};

/// Indices of the gallery's materials.
pub(super) struct Palette {
    pub(super) plaster: u32,
    pub(super) ceiling: u32,
    pub(super) green_wall: u32,
    pub(super) red_wall: u32,
    pub(super) limestone: u32,
    pub(super) trim: u32,
    pub(super) checker: u32,
    pub(super) planks: u32,
    pub(super) glossy_planks: u32,
    pub(super) tiles: u32,
    pub(super) marble: u32,
    pub(super) bronze: u32,
    pub(super) gold: u32,
    pub(super) black: u32,
    pub(super) wood: u32,
    pub(super) leather: u32,
    pub(super) brass: u32,
    pub(super) celadon: u32,
}

impl Palette {
    pub(super) fn new(draft: &mut Draft, seed: u64) -> Self {
        let key = RandomKey::new(seed).mix(1);
        let checker = add_texture(draft, checker_texture(key.mix(0)));
        let planks = add_texture(draft, plank_texture(key.mix(1)));
        let tiles = add_texture(draft, tile_texture(key.mix(2)));
        let mut matt = |name: &str, r: f32, g: f32, b: f32| {
            draft.add_material(Material::diffuse(name, Vec3::new(r, g, b)))
        };
        let plaster = matt("plaster", 0.80, 0.75, 0.67);
        let ceiling = matt("ceiling", 0.84, 0.82, 0.77);
        let green_wall = matt("green wall", 0.27, 0.38, 0.32);
        let red_wall = matt("red wall", 0.50, 0.15, 0.12);
        let limestone = matt("limestone", 0.72, 0.66, 0.56);
        let trim = matt("trim", 0.82, 0.79, 0.72);
        let mut coated = |name: &str, color: Vec3, roughness: f32, texture: Option<(u32, f32)>| {
            draft.add_material(Material {
                roughness,
                specular: 1.0,
                base_color_texture: texture.map(|(texture, repeat_m)| TextureRef {
                    texture,
                    texture_from_uv: Affine2::from_scale(Vec2::splat(1.0 / repeat_m)),
                }),
                ..Material::diffuse(name, color)
            })
        };
        Self {
            plaster,
            ceiling,
            green_wall,
            red_wall,
            limestone,
            trim,
            checker: coated("checkered marble", Vec3::ONE, 0.32, Some((checker, 1.4))),
            planks: coated("oak planks", Vec3::ONE, 0.5, Some((planks, 1.6))),
            glossy_planks: coated(
                "polished planks",
                Vec3::new(0.62, 0.5, 0.44),
                0.24,
                Some((planks, 1.6)),
            ),
            tiles: coated("stone tiles", Vec3::ONE, 0.45, Some((tiles, 2.4))),
            marble: coated("marble", Vec3::new(0.85, 0.83, 0.79), 0.38, None),
            black: coated("black iron", Vec3::splat(0.03), 0.45, None),
            wood: coated("walnut", Vec3::new(0.22, 0.12, 0.06), 0.42, None),
            leather: coated("leather", Vec3::new(0.30, 0.10, 0.05), 0.5, None),
            celadon: coated("celadon", Vec3::new(0.36, 0.55, 0.47), 0.28, None),
            bronze: metal(draft, "bronze", Vec3::new(0.62, 0.42, 0.24), 0.4, 1.0),
            gold: metal(draft, "gilt", Vec3::new(0.86, 0.58, 0.22), 0.5, 0.35),
            brass: metal(draft, "brass", Vec3::new(0.78, 0.56, 0.24), 0.4, 0.5),
        }
    }
}

fn metal(draft: &mut Draft, name: &str, color: Vec3, roughness: f32, metallic: f32) -> u32 {
    draft.add_material(Material {
        metallic,
        specular: 1.0,
        roughness,
        ..Material::diffuse(name, color)
    })
}

/// Two by two slabs of cream and dark marble with soft veins.
fn checker_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / 16.0, y as f32 / 16.0);
        let vein = noise(key, u, v, 16) + 0.5 * noise(key.mix(9), 2.0 * u, 2.0 * v, 32);
        let dark = (x / 128 + y / 128) % 2 == 1;
        let joint = x % 128 < 2 || y % 128 < 2;
        let base = if dark {
            Vec3::new(0.10, 0.085, 0.08)
        } else {
            Vec3::new(0.74, 0.68, 0.58)
        };
        base * (0.8 + 0.27 * vein) * if joint { 0.55 } else { 1.0 }
    })
}

/// Eight planks with their own tint, grain along u and staggered ends.
fn plank_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let row = y / 32;
        let shifted = (x + row * 97) % SIDE;
        let plank = key.mix(u64::from(row)).mix(u64::from(shifted / 128));
        let tint = 0.72 + 0.5 * plank.uniform(0);
        let grain = noise(plank, shifted as f32 / 32.0, y as f32 / 2.0, 256);
        let joint = y % 32 == 0 || shifted.is_multiple_of(128);
        Vec3::new(0.42, 0.25, 0.13) * tint * (0.8 + 0.35 * grain) * if joint { 0.35 } else { 1.0 }
    })
}

/// Three by three square stone tiles.
fn tile_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 258;
    bitmap(SIDE, SIDE, |x, y| {
        let tile = key.mix(u64::from(x / 86)).mix(u64::from(y / 86));
        let cloud = noise(tile, x as f32 / 12.0, y as f32 / 12.0, 64);
        let joint = x % 86 < 1 || y % 86 < 1;
        let tint = 0.85 + 0.25 * tile.uniform(0);
        Vec3::new(0.50, 0.45, 0.38) * tint * (0.85 + 0.25 * cloud) * if joint { 0.5 } else { 1.0 }
    })
}

/// A canvas of its own for each number: bands, discs, or blocks in one of a few harmonies.
pub(super) fn painting(key: RandomKey, width: u32, height: u32) -> Texture {
    const HARMONIES: [[Vec3; 4]; 5] = [
        [
            Vec3::new(0.62, 0.16, 0.05),
            Vec3::new(0.85, 0.48, 0.10),
            Vec3::new(0.10, 0.08, 0.15),
            Vec3::new(0.88, 0.78, 0.58),
        ],
        [
            Vec3::new(0.05, 0.14, 0.36),
            Vec3::new(0.16, 0.42, 0.55),
            Vec3::new(0.85, 0.70, 0.38),
            Vec3::new(0.80, 0.82, 0.78),
        ],
        [
            Vec3::new(0.34, 0.04, 0.06),
            Vec3::new(0.72, 0.20, 0.16),
            Vec3::new(0.90, 0.60, 0.45),
            Vec3::new(0.12, 0.10, 0.10),
        ],
        [
            Vec3::new(0.08, 0.22, 0.12),
            Vec3::new(0.45, 0.55, 0.18),
            Vec3::new(0.88, 0.74, 0.22),
            Vec3::new(0.16, 0.12, 0.28),
        ],
        [
            Vec3::new(0.80, 0.76, 0.68),
            Vec3::new(0.14, 0.13, 0.13),
            Vec3::new(0.68, 0.10, 0.07),
            Vec3::new(0.10, 0.22, 0.50),
        ],
    ];
    let colors = HARMONIES[(key.uniform(0) * 5.0) as usize % 5];
    let style = (key.uniform(1) * 3.0) as u32;
    bitmap(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / width as f32);
        let brush = noise(key.mix(3), 24.0 * u, 6.0 * v, 512) - 0.5;
        let grain = noise(key.mix(4), 90.0 * u, 90.0 * v, 512) - 0.5;
        let color = match style {
            0 => bands(
                key,
                colors,
                u,
                v * width as f32 / height as f32,
                0.03 * brush,
            ),
            1 => discs(key, colors, u + 0.02 * brush, v + 0.02 * grain),
            _ => blocks(key, colors, u, v),
        };
        color * (1.0 + 0.25 * brush + 0.18 * grain)
    })
}

/// Soft-edged fields one above the other.
fn bands(key: RandomKey, colors: [Vec3; 4], u: f32, v: f32, wobble: f32) -> Vec3 {
    let mut color = colors[2];
    let inset = ((u - 0.08).min(0.92 - u) / 0.05 + 8.0 * wobble).clamp(0.0, 1.0);
    let mut top = 0.07;
    for (index, field) in [colors[0], colors[1], colors[3]].into_iter().enumerate() {
        let height = 0.16 + 0.2 * key.mix(20).uniform(index as u32);
        let edge = ((v - top).min(top + height - v) / 0.035 + 8.0 * wobble).clamp(0.0, 1.0);
        color = color.lerp(field, edge * inset);
        top += height + 0.04;
    }
    color
}

/// Rings and discs that overlap.
fn discs(key: RandomKey, colors: [Vec3; 4], u: f32, v: f32) -> Vec3 {
    let mut color = colors[3];
    for disc in 0..7 {
        let own = key.mix(40 + disc);
        let distance = (Vec2::new(u, v) - own.uniform2(0) * Vec2::new(1.0, 1.2)).length();
        let radius = 0.08 + 0.24 * own.uniform(1);
        if distance < radius && (distance > 0.55 * radius || own.uniform(2) < 0.5) {
            color = colors[disc as usize % 3].lerp(color, 0.15);
        }
    }
    color
}

/// Rectangles parted by dark lines.
fn blocks(key: RandomKey, colors: [Vec3; 4], u: f32, v: f32) -> Vec3 {
    let (mut min, mut max, mut own) = (Vec2::ZERO, Vec2::new(1.0, 1.4), key.mix(60));
    for depth in 0..5 {
        let cut = 0.3 + 0.4 * own.uniform(0);
        let axis = (depth + usize::from(own.uniform(1) < 0.3)) % 2;
        let line = min[axis] + cut * (max[axis] - min[axis]);
        let at = if axis == 0 { u } else { v };
        if (at - line).abs() < 0.008 {
            return colors[1].min(Vec3::splat(0.1));
        }
        let below = at < line;
        if below {
            max[axis] = line;
        } else {
            min[axis] = line;
        }
        own = own.mix(u64::from(below));
    }
    if own.uniform(2) < 0.45 {
        colors[0].max(Vec3::splat(0.55))
    } else {
        colors[(own.uniform(3) * 4.0) as usize % 4]
    }
}
