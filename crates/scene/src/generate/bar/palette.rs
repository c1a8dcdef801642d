//! Materials, and the small bitmaps they use.

use glam::{Affine2, Vec2, Vec3};
use lie_geom::RandomKey;

use crate::{
    Material, Texture, TextureRef,
    draft::Draft,
    generate::bitmaps::{add_texture, bitmap, noise},
};

/// Indices of the bar's materials.
pub(super) struct Palette {
    pub(super) floor: u32,
    pub(super) floor_border: u32,
    pub(super) plaster: u32,
    pub(super) wallpaper: u32,
    pub(super) walnut: u32,
    pub(super) ebony: u32,
    pub(super) mahogany: u32,
    pub(super) oak: u32,
    pub(super) beech: u32,
    pub(super) cane: u32,
    pub(super) oxblood: u32,
    pub(super) tan: u32,
    pub(super) brass: u32,
    pub(super) steel: u32,
    pub(super) iron: u32,
    pub(super) enamel: u32,
    pub(super) opal: u32,
    pub(super) china: u32,
    pub(super) marble: u32,
    pub(super) glass: u32,
    pub(super) gilt: u32,
    pub(super) clay: u32,
    pub(super) leaf: u32,
    pub(super) bark: u32,
    pub(super) lemon: u32,
    pub(super) rose: u32,
    pub(super) beer: u32,
    pub(super) wine: u32,
    pub(super) rum: u32,
    /// Glass of the bottles.
    pub(super) bottles: [u32; 7],
    /// Paper of their labels.
    pub(super) labels: [u32; 4],
}

impl Palette {
    pub(super) fn new(draft: &mut Draft, key: RandomKey) -> Self {
        let mut maker = Maker { draft };
        let tiles = maker.texture(tile_texture(key.mix(0)), 1.8, 45.0);
        let grain = maker.texture(grain_texture(key.mix(1)), 1.0, 0.0);
        let stripes = maker.texture(stripe_texture(key.mix(2)), 0.48, 0.0);
        let veins = maker.texture(vein_texture(key.mix(3)), 1.3, 20.0);
        Self {
            floor: maker.coated("floor tiles", [1.0; 3], 0.24, Some(tiles)),
            floor_border: maker.coated("floor border", [0.035, 0.04, 0.038], 0.24, None),
            plaster: maker.matt("plaster", [0.80, 0.71, 0.56], None),
            wallpaper: maker.matt("wallpaper", [1.0; 3], Some(stripes)),
            walnut: maker.matt("walnut", [0.44, 0.24, 0.13], Some(grain)),
            ebony: maker.matt("dark oak", [0.24, 0.14, 0.085], Some(grain)),
            mahogany: maker.coated("mahogany", [0.62, 0.24, 0.11], 0.3, Some(grain)),
            oak: maker.matt("oak", [0.72, 0.45, 0.25], Some(grain)),
            beech: maker.matt("bent beech", [0.33, 0.135, 0.06], None),
            cane: maker.matt("cane", [0.66, 0.46, 0.24], None),
            oxblood: maker.coated("oxblood leather", [0.36, 0.055, 0.04], 0.48, None),
            tan: maker.coated("tan leather", [0.46, 0.20, 0.075], 0.5, None),
            brass: maker.metal("brass", [0.82, 0.56, 0.22], 0.36),
            steel: maker.metal("steel", [0.66, 0.66, 0.64], 0.34),
            iron: maker.matt("black iron", [0.035, 0.033, 0.03], None),
            enamel: maker.coated("green enamel", [0.03, 0.11, 0.08], 0.3, None),
            opal: maker.matt("opal glass", [0.94, 0.90, 0.82], None),
            china: maker.coated("china", [0.84, 0.81, 0.74], 0.25, None),
            marble: maker.coated("marble", [1.0; 3], 0.32, Some(veins)),
            glass: maker.coated("glass", [0.68, 0.77, 0.76], 0.16, None),
            gilt: maker.metal("gilt", [0.86, 0.58, 0.22], 0.5),
            clay: maker.matt("fired clay", [0.48, 0.20, 0.10], None),
            leaf: maker.matt("leaf", [0.12, 0.30, 0.075], None),
            bark: maker.matt("bark", [0.22, 0.14, 0.08], None),
            lemon: maker.matt("lemon", [0.88, 0.68, 0.07], None),
            rose: maker.matt("rose", [0.78, 0.07, 0.09], None),
            beer: maker.matt("beer", [0.78, 0.42, 0.05], None),
            wine: maker.matt("wine", [0.24, 0.012, 0.03], None),
            rum: maker.matt("rum", [0.55, 0.22, 0.04], None),
            bottles: [
                ("green glass", [0.05, 0.19, 0.07]),
                ("brown glass", [0.20, 0.085, 0.025]),
                ("amber glass", [0.62, 0.28, 0.045]),
                ("aqua glass", [0.36, 0.58, 0.54]),
                ("blue glass", [0.05, 0.14, 0.42]),
                ("red glass", [0.60, 0.05, 0.03]),
                ("clear glass", [0.66, 0.68, 0.62]),
            ]
            .map(|(name, color)| maker.coated(name, color, 0.2, None)),
            labels: [
                ("cream paper", [0.86, 0.78, 0.60]),
                ("red paper", [0.62, 0.09, 0.06]),
                ("black paper", [0.05, 0.045, 0.04]),
                ("ochre paper", [0.78, 0.54, 0.16]),
            ]
            .map(|(name, color)| maker.matt(name, color, None)),
        }
    }
}

struct Maker<'a> {
    draft: &'a mut Draft,
}

impl Maker<'_> {
    /// A texture that repeats after so many metres, turned.
    fn texture(&mut self, texture: Texture, repeat_m: f32, degrees: f32) -> TextureRef {
        TextureRef {
            texture: add_texture(self.draft, texture),
            texture_from_uv: Affine2::from_scale_angle_translation(
                Vec2::splat(1.0 / repeat_m),
                degrees.to_radians(),
                Vec2::ZERO,
            ),
        }
    }

    fn matt(&mut self, name: &str, color: [f32; 3], texture: Option<TextureRef>) -> u32 {
        self.draft.add_material(Material {
            base_color_texture: texture,
            ..Material::diffuse(name, Vec3::from(color))
        })
    }

    /// A diffuse body under a clear coat.
    fn coated(
        &mut self,
        name: &str,
        color: [f32; 3],
        roughness: f32,
        texture: Option<TextureRef>,
    ) -> u32 {
        self.draft.add_material(Material {
            roughness,
            specular: 1.0,
            base_color_texture: texture,
            ..Material::diffuse(name, Vec3::from(color))
        })
    }

    /// Half metal only: the other half stands for what a mirror would show.
    fn metal(&mut self, name: &str, color: [f32; 3], roughness: f32) -> u32 {
        self.draft.add_material(Material {
            roughness,
            metallic: 0.45,
            specular: 1.0,
            ..Material::diffuse(name, Vec3::from(color))
        })
    }
}

/// Four by four cement tiles, cream and bottle green in turn, each worn in its own way.
fn tile_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 512;
    const TILE: u32 = SIDE / 4;
    bitmap(SIDE, SIDE, |x, y| {
        let (column, row) = (x / TILE, y / TILE);
        let own = key.mix(u64::from(column)).mix(u64::from(row));
        let cloud = noise(own, x as f32 / 22.0, y as f32 / 22.0, 1024);
        let speck = noise(own.mix(7), x as f32 / 3.0, y as f32 / 3.0, 1024);
        let base = if (column + row) % 2 == 0 {
            Vec3::new(0.70, 0.62, 0.47)
        } else {
            Vec3::new(0.055, 0.12, 0.095)
        };
        let joint = x % TILE < 2 || y % TILE < 2;
        let worn = (0.88 + 0.2 * own.uniform(5)) * (0.84 + 0.22 * cloud + 0.1 * speck);
        base * worn * if joint { 0.45 } else { 1.0 }
    })
}

/// Wood, light and dark about 1, with its grain along u.
fn grain_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let drift = noise(key, 3.0 * u, 5.0 * v, 15);
        let rings = (std::f32::consts::TAU * (9.0 * v + 1.2 * drift)).sin();
        let fibre = noise(key.mix(1), 8.0 * u, 96.0 * v, 96 * 8);
        Vec3::ONE * (0.74 + 0.09 * rings + 0.22 * fibre)
    })
}

/// Petrol wallpaper: stripes of two tones, parted by thin gold lines.
fn stripe_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let across = x % 64;
        let weave = noise(key, x as f32 / 1.5, y as f32 / 6.0, 1024);
        let tone = if across < 32 {
            Vec3::new(0.15, 0.335, 0.325)
        } else {
            Vec3::new(0.20, 0.415, 0.395)
        };
        let gold = matches!(across, 0 | 1 | 32 | 33);
        let color = if gold {
            Vec3::new(0.42, 0.33, 0.14)
        } else {
            tone
        };
        color * (0.9 + 0.2 * weave)
    })
}

/// Dark green marble with pale veins.
fn vein_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / 32.0, y as f32 / 32.0);
        let warp = noise(key, u, v, 8) + 0.5 * noise(key.mix(1), 2.0 * u, 2.0 * v, 16);
        let fold = (noise(key.mix(2), u + 2.0 * warp, v, 8) - 0.5).abs();
        let vein = (1.0 - 9.0 * fold).clamp(0.0, 1.0).powi(2);
        Vec3::new(0.10, 0.15, 0.12).lerp(Vec3::new(0.62, 0.62, 0.54), 0.75 * vein)
            * (0.85 + 0.2 * warp)
    })
}

/// A poster: a sun over the sea, a fan of rays, or a glass under arches, in a harmony of its own.
pub(super) fn poster(key: RandomKey) -> Texture {
    const HARMONIES: [[Vec3; 4]; 4] = [
        [
            Vec3::new(0.86, 0.70, 0.42),
            Vec3::new(0.70, 0.16, 0.07),
            Vec3::new(0.05, 0.20, 0.24),
            Vec3::new(0.88, 0.82, 0.66),
        ],
        [
            Vec3::new(0.10, 0.34, 0.36),
            Vec3::new(0.88, 0.60, 0.16),
            Vec3::new(0.04, 0.07, 0.14),
            Vec3::new(0.86, 0.80, 0.64),
        ],
        [
            Vec3::new(0.72, 0.28, 0.12),
            Vec3::new(0.90, 0.74, 0.34),
            Vec3::new(0.16, 0.05, 0.07),
            Vec3::new(0.90, 0.84, 0.70),
        ],
        [
            Vec3::new(0.84, 0.77, 0.60),
            Vec3::new(0.08, 0.26, 0.15),
            Vec3::new(0.08, 0.07, 0.06),
            Vec3::new(0.74, 0.46, 0.10),
        ],
    ];
    let colors = HARMONIES[(key.uniform(0) * 4.0) as usize % 4];
    let style = (key.uniform(1) * 3.0) as u32;
    let (width, height) = (192, 256);
    bitmap(width, height, |x, y| {
        let (u, v) = (
            x as f32 / width as f32 - 0.5,
            y as f32 / width as f32 - 0.66,
        );
        let print = noise(key.mix(4), 80.0 * u + 64.0, 80.0 * v + 64.0, 512) - 0.5;
        let border = 0.5 - u.abs() < 0.055 || y < 10 || y > height - 34;
        let color = if border {
            colors[3]
        } else {
            match style {
                0 => sunset(colors, u, v),
                1 => rays(colors, u, v),
                _ => arches(colors, u, v),
            }
        };
        color * (1.0 + 0.14 * print)
    })
}

fn sunset(colors: [Vec3; 4], u: f32, v: f32) -> Vec3 {
    let wave = 0.02 * (30.0 * u + 60.0 * v).sin();
    if v > 0.12 {
        return if ((v + wave) * 22.0).fract() < 0.4 {
            colors[0]
        } else {
            colors[2]
        };
    }
    if Vec2::new(u, v - 0.05).length() < 0.27 {
        return colors[1];
    }
    colors[0]
}

fn rays(colors: [Vec3; 4], u: f32, v: f32) -> Vec3 {
    let from = Vec2::new(u, v - 0.32);
    if from.length() < 0.15 {
        return colors[3];
    }
    let sector = (from.y.atan2(from.x) / std::f32::consts::TAU * 32.0).floor() as i32;
    if sector.rem_euclid(2) == 0 {
        colors[0]
    } else {
        colors[1].lerp(colors[2], (1.1 * from.length()).min(1.0))
    }
}

fn arches(colors: [Vec3; 4], u: f32, v: f32) -> Vec3 {
    let from = Vec2::new(u, (v + 0.1).min(0.0));
    // A cocktail glass: cone, stem and foot.
    let in_cone = (-0.12..0.12).contains(&v) && u.abs() < 0.9 * (0.12 - v);
    let in_stem = (0.12..0.34).contains(&v) && u.abs() < 0.012;
    let in_foot = (0.34..0.37).contains(&v) && u.abs() < 0.11;
    if in_cone || in_stem || in_foot {
        return if in_cone && v > -0.06 {
            colors[1]
        } else {
            colors[3]
        };
    }
    colors[((from.length() * 11.0) as usize) % 2 * 2]
}
