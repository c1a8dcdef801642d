//! Materials, all of them matt, and the small bitmaps they use.

use glam::{Affine2, Vec2, Vec3};
use lie_geom::RandomKey;

use crate::{
    Material, Texture, TextureRef,
    draft::Draft,
    generate::bitmaps::{add_texture, bitmap, noise},
};

/// Indices of the science centre's materials.
pub(super) struct Palette {
    /// Tones of slabs and panels, the usual one first.
    pub(super) terrazzo: [u32; 2],
    pub(super) carpet: u32,
    pub(super) plaster: [u32; 2],
    pub(super) accent: [u32; 2],
    pub(super) ceiling: u32,
    pub(super) soffit: u32,
    pub(super) steel: u32,
    pub(super) column: u32,
    pub(super) oak: u32,
    pub(super) leaf: u32,
    pub(super) bark: u32,
    pub(super) soil: u32,
    pub(super) concrete: u32,
    pub(super) globe: u32,
    /// Bright paints: of chairs, and of the exhibits.
    pub(super) paints: [u32; 5],
    pub(super) posters: Vec<u32>,
}

/// Posters on the walls.
pub(super) const POSTERS: u32 = 6;

impl Palette {
    pub(super) fn new(draft: &mut Draft, key: RandomKey) -> Self {
        let mut textured = |name: &str, texture: Texture, repeats: Vec2| {
            let texture = add_texture(draft, texture);
            draft.add_material(Material {
                base_color_texture: Some(TextureRef {
                    texture,
                    texture_from_uv: Affine2::from_scale(repeats),
                }),
                ..Material::diffuse(name, Vec3::ONE)
            })
        };
        let terrazzo = [
            ("pale terrazzo", Vec3::new(0.60, 0.58, 0.54)),
            ("dark terrazzo", Vec3::new(0.37, 0.36, 0.345)),
        ]
        .map(|(name, ground)| textured(name, terrazzo_texture(key.mix(1), ground), Vec2::ONE));
        let oak = textured("oak", oak_texture(key.mix(2)), Vec2::splat(1.0 / 1.6));
        let soffit = textured(
            "slatted soffit",
            slat_texture(key.mix(3)),
            Vec2::splat(1.0 / 1.2),
        );
        let globe = textured("globe", globe_texture(key.mix(4)), Vec2::ONE);
        let posters = (0..POSTERS)
            .map(|number| {
                let picture = poster_texture(key.mix(100 + u64::from(number)));
                textured(&format!("poster {number}"), picture, Vec2::ONE)
            })
            .collect();
        let mut paint = |name: &str, r: f32, g: f32, b: f32| {
            draft.add_material(Material::diffuse(name, Vec3::new(r, g, b)))
        };
        Self {
            terrazzo,
            oak,
            soffit,
            globe,
            posters,
            carpet: paint("carpet", 0.16, 0.21, 0.25),
            plaster: [
                paint("plaster", 0.82, 0.75, 0.65),
                paint("warm plaster", 0.79, 0.705, 0.59),
            ],
            accent: [
                paint("teal wall", 0.10, 0.29, 0.31),
                paint("dark teal wall", 0.085, 0.25, 0.275),
            ],
            ceiling: paint("ceiling", 0.84, 0.83, 0.80),
            steel: paint("steel", 0.16, 0.18, 0.20),
            column: paint("white concrete", 0.78, 0.76, 0.72),
            leaf: paint("leaves", 0.13, 0.29, 0.075),
            bark: paint("bark", 0.22, 0.14, 0.085),
            soil: paint("soil", 0.09, 0.065, 0.05),
            concrete: paint("concrete", 0.46, 0.45, 0.43),
            paints: [
                paint("orange", 0.78, 0.27, 0.06),
                paint("yellow", 0.82, 0.58, 0.10),
                paint("blue", 0.07, 0.23, 0.52),
                paint("red", 0.62, 0.085, 0.07),
                paint("cream", 0.78, 0.72, 0.58),
            ],
        }
    }
}

/// A slab: chips in a plain ground, and half a joint along two sides.
fn terrazzo_texture(key: RandomKey, ground: Vec3) -> Texture {
    const SIDE: u32 = 128;
    bitmap(SIDE, SIDE, |x, y| {
        let chip = key.mix(u64::from(x / 2)).mix(u64::from(y / 2)).uniform(0);
        let joint = x == 0 || y == 0;
        ground * (1.0 + 0.16 * (chip - 0.5)) * if joint { 0.6 } else { 1.0 }
    })
}

/// Four planks with grain along u.
fn oak_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 128;
    bitmap(SIDE, SIDE, |x, y| {
        let plank = key.mix(u64::from(y / 32));
        let grain = noise(plank, x as f32 / 16.0, y as f32 / 2.0, 128);
        let joint = y % 32 == 0;
        let tint = 0.8 + 0.3 * plank.uniform(0) + 0.3 * (grain - 0.5);
        Vec3::new(0.52, 0.33, 0.17) * tint * if joint { 0.5 } else { 1.0 }
    })
}

/// Slats with dark gaps between them.
fn slat_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 96;
    bitmap(SIDE, SIDE, |x, y| {
        let slat = key.mix(u64::from(y / 12));
        let grain = noise(slat, x as f32 / 12.0, y as f32 / 2.0, 48);
        let tint = 0.85 + 0.2 * slat.uniform(0) + 0.2 * (grain - 0.5);
        Vec3::new(0.70, 0.50, 0.31) * tint * if y % 12 < 3 { 0.34 } else { 1.0 }
    })
}

/// Continents in a sea, ice at both ends.
fn globe_texture(key: RandomKey) -> Texture {
    bitmap(256, 128, |x, y| {
        let (u, v) = (x as f32 / 256.0, y as f32 / 128.0);
        let octave = |layer: u64, cells: u32| {
            noise(key.mix(layer), u * cells as f32, v * cells as f32, cells)
        };
        let land = 0.6 * octave(1, 6) + 0.28 * octave(2, 14) + 0.12 * octave(3, 40);
        let pole = (2.0 * v - 1.0).abs() + 0.1 * (land - 0.5);
        if pole > 0.88 {
            Vec3::new(0.80, 0.82, 0.84)
        } else if land > 0.53 {
            Vec3::new(0.30, 0.33, 0.13).lerp(Vec3::new(0.52, 0.40, 0.20), octave(4, 10))
        } else {
            Vec3::new(0.05, 0.19, 0.36) * (0.75 + 0.6 * land)
        }
    })
}

/// A planet before the stars, in one of a few colours, some with a ring.
fn poster_texture(key: RandomKey) -> Texture {
    const COLORS: [[f32; 3]; 5] = [
        [0.80, 0.42, 0.16],
        [0.26, 0.52, 0.72],
        [0.72, 0.64, 0.42],
        [0.62, 0.16, 0.10],
        [0.36, 0.60, 0.42],
    ];
    let color = Vec3::from(COLORS[(key.uniform(0) * 5.0) as usize % 5]);
    let center = Vec2::new(0.35 + 0.3 * key.uniform(1), 0.45 + 0.3 * key.uniform(2));
    let radius = 0.22 + 0.16 * key.uniform(3);
    let has_ring = key.uniform(4) < 0.5;
    bitmap(128, 176, |x, y| {
        let at = Vec2::new(x as f32, y as f32) / 128.0;
        let offset = (at - center) / radius;
        let depth = (1.0 - offset.length_squared()).max(0.0).sqrt();
        let ring = Vec2::new(
            offset.x + 0.35 * offset.y,
            3.2 * (offset.y - 0.35 * offset.x),
        );
        let in_ring = has_ring && (1.35..1.9).contains(&ring.length());
        if in_ring && (depth == 0.0 || ring.y > 0.0) {
            let groove = noise(key.mix(5), 14.0 * ring.length(), 0.5, 64);
            color.lerp(Vec3::splat(0.7), 0.5) * (0.5 + 0.6 * groove)
        } else if depth > 0.0 {
            let swirl = noise(key.mix(6), 3.0 * at.x, 20.0 * at.y, 64);
            let light = Vec3::new(offset.x, -offset.y, depth).dot(Vec3::new(-0.5, 0.5, 0.7));
            color * (0.55 + 0.7 * swirl) * light.clamp(0.04, 1.0)
        } else {
            let star = key.mix(8).mix(u64::from(x)).mix(u64::from(y)).uniform(0);
            let glow = noise(key.mix(9), 5.0 * at.x, 5.0 * at.y, 16);
            let night = Vec3::new(0.018, 0.024, 0.055) * (0.6 + 1.4 * glow);
            night + Vec3::splat(if star > 0.992 { 0.7 } else { 0.0 })
        }
    })
}
