//! Materials, and the small bitmaps they use.

use glam::{Affine2, Vec2, Vec3};
use lie_geom::RandomKey;

use crate::{
    Material, Texture, TextureRef,
    draft::Draft,
    generate::bitmaps::{add_texture, bitmap, noise},
};

/// Indices of the mosque's materials.
pub(super) struct Palette {
    /// Polished marbles of the shafts.
    pub(super) stones: [u32; 5],
    pub(super) marble: u32,
    pub(super) limestone: u32,
    pub(super) brick: u32,
    pub(super) plaster: u32,
    pub(super) panel: u32,
    pub(super) tile: u32,
    pub(super) shade: u32,
    pub(super) floor: u32,
    pub(super) nave_floor: u32,
    pub(super) boards: u32,
    pub(super) beam: u32,
    pub(super) door: u32,
    pub(super) brass: u32,
    pub(super) glass: u32,
    pub(super) gold: u32,
    pub(super) blue: u32,
}

impl Palette {
    pub(super) fn new(draft: &mut Draft, key: RandomKey) -> Self {
        let stones = STONES.map(|stone| {
            let picture = marble_texture(key.mix(stone.grain), &stone);
            // Once round the shaft, once along it.
            polished(draft, stone.name, 0.24, (picture, Vec2::ONE))
        });
        let floor = (floor_texture(key.mix(20)), Vec2::splat(1.0 / 2.2));
        let nave_floor = (nave_texture(key.mix(21)), Vec2::splat(1.0 / 2.8));
        let boards = (board_texture(key.mix(22)), Vec2::splat(1.0 / 2.0));
        let panel = (marble_texture(key.mix(23), &PANEL), Vec2::splat(1.0 / 1.6));
        let tile = (tile_texture(), Vec2::splat(1.0 / 0.6));
        let panel = polished(draft, "panel marble", 0.34, panel);
        let floor = polished(draft, "floor marble", 0.36, floor);
        let nave_floor = polished(draft, "nave marble", 0.32, nave_floor);
        let boards = matt(draft, "painted boards", Vec3::ONE, Some(boards));
        let tile = matt(draft, "stucco", Vec3::ONE, Some(tile));
        Self {
            stones,
            panel,
            floor,
            nave_floor,
            boards,
            tile,
            marble: coated(draft, "white marble", [0.76, 0.70, 0.60], 0.36, 0.0),
            limestone: matt(draft, "limestone", Vec3::new(0.76, 0.66, 0.49), None),
            brick: matt(draft, "brick", Vec3::new(0.46, 0.105, 0.06), None),
            plaster: matt(draft, "plaster", Vec3::new(0.74, 0.66, 0.54), None),
            shade: matt(draft, "shade", Vec3::new(0.055, 0.05, 0.05), None),
            beam: matt(draft, "cedar", Vec3::new(0.27, 0.135, 0.065), None),
            door: coated(draft, "door", [0.20, 0.095, 0.045], 0.45, 0.0),
            brass: coated(draft, "brass", [0.78, 0.56, 0.24], 0.38, 0.5),
            glass: coated(draft, "lamp glass", [0.80, 0.74, 0.62], 0.30, 0.0),
            gold: coated(draft, "gold", [0.88, 0.60, 0.20], 0.42, 0.35),
            blue: coated(draft, "lapis", [0.04, 0.10, 0.34], 0.40, 0.0),
        }
    }
}

fn matt(draft: &mut Draft, name: &str, color: Vec3, picture: Option<(Texture, Vec2)>) -> u32 {
    let base_color_texture = picture.map(|picture| reference(draft, picture));
    draft.add_material(Material {
        base_color_texture,
        ..Material::diffuse(name, color)
    })
}

fn polished(draft: &mut Draft, name: &str, roughness: f32, picture: (Texture, Vec2)) -> u32 {
    let base_color_texture = Some(reference(draft, picture));
    draft.add_material(Material {
        roughness,
        specular: 1.0,
        base_color_texture,
        ..Material::diffuse(name, Vec3::ONE)
    })
}

fn coated(draft: &mut Draft, name: &str, color: [f32; 3], roughness: f32, metallic: f32) -> u32 {
    draft.add_material(Material {
        roughness,
        metallic,
        specular: 1.0,
        ..Material::diffuse(name, Vec3::from(color))
    })
}

fn reference(draft: &mut Draft, (texture, repeats): (Texture, Vec2)) -> TextureRef {
    TextureRef {
        texture: add_texture(draft, texture),
        texture_from_uv: Affine2::from_scale(repeats),
    }
}

/// A marble: its ground, its clouds and its veins.
struct Stone {
    name: &'static str,
    grain: u64,
    ground: [f32; 3],
    cloud: [f32; 3],
    vein: [f32; 3],
}

const STONES: [Stone; 5] = [
    Stone {
        name: "rose breccia",
        grain: 1,
        ground: [0.42, 0.19, 0.15],
        cloud: [0.56, 0.33, 0.26],
        vein: [0.74, 0.62, 0.52],
    },
    Stone {
        name: "grey-blue marble",
        grain: 2,
        ground: [0.17, 0.20, 0.24],
        cloud: [0.30, 0.33, 0.37],
        vein: [0.60, 0.60, 0.58],
    },
    Stone {
        name: "green serpentine",
        grain: 3,
        ground: [0.06, 0.11, 0.085],
        cloud: [0.12, 0.20, 0.145],
        vein: [0.36, 0.42, 0.34],
    },
    Stone {
        name: "black marble",
        grain: 4,
        ground: [0.045, 0.042, 0.045],
        cloud: [0.09, 0.085, 0.085],
        vein: [0.52, 0.46, 0.38],
    },
    Stone {
        name: "honey marble",
        grain: 5,
        ground: [0.56, 0.42, 0.27],
        cloud: [0.68, 0.56, 0.40],
        vein: [0.36, 0.22, 0.13],
    },
];

const PANEL: Stone = Stone {
    name: "panel marble",
    grain: 6,
    ground: [0.50, 0.42, 0.34],
    cloud: [0.62, 0.55, 0.46],
    vein: [0.34, 0.24, 0.19],
};

/// Clouds in the ground, and veins where another cloud crosses its mean.
fn marble_texture(key: RandomKey, stone: &Stone) -> Texture {
    const SIDE: u32 = 256;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let octave = |layer: u64, cells: u32| {
            noise(key.mix(layer), u * cells as f32, v * cells as f32, cells)
        };
        let cloud = 0.6 * octave(1, 8) + 0.4 * octave(2, 24);
        let crack = 0.65 * octave(3, 6) + 0.25 * octave(4, 18) + 0.1 * octave(5, 64);
        let vein = (1.0 - 26.0 * (crack - 0.5).abs()).max(0.0) * octave(6, 9);
        let speckle = 0.9 + 0.2 * octave(7, 96);
        let ground = Vec3::from(stone.ground).lerp(Vec3::from(stone.cloud), cloud);
        ground.lerp(Vec3::from(stone.vein), vein) * speckle
    })
}

const CREAM: Vec3 = Vec3::new(0.60, 0.52, 0.40);
const RUST: Vec3 = Vec3::new(0.36, 0.13, 0.075);
const SLATE: Vec3 = Vec3::new(0.085, 0.10, 0.11);
const MOSS: Vec3 = Vec3::new(0.13, 0.18, 0.12);

/// Distances of a point in a cell of side 1 from its middle: to a square's sides, and to those
/// of one turned by an eighth.
fn star(u: f32, v: f32) -> (f32, f32) {
    let (x, y) = ((u - 0.5).abs(), (v - 0.5).abs());
    (x.max(y), (x + y) * std::f32::consts::FRAC_1_SQRT_2)
}

/// Eight-pointed stars in octagons, with crosses between.
fn floor_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 384;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let (square, diamond) = star(u, v);
        let near = |edge: f32, at: f32| (edge - at).abs() < 0.008;
        let (star, octagon) = (square.min(diamond), square.max(diamond));
        let color = if near(star, 0.24) || near(octagon, 0.44) || square > 0.49 {
            0.45 * CREAM
        } else if octagon < 0.13 {
            CREAM
        } else if star < 0.24 {
            RUST
        } else if octagon < 0.44 {
            CREAM
        } else {
            MOSS
        };
        let cloud = noise(key, 24.0 * u, 24.0 * v, 24) + noise(key.mix(1), 96.0 * u, 96.0 * v, 96);
        color * (0.78 + 0.22 * cloud)
    })
}

/// Large slabs in bands, dark diamonds where they meet.
fn nave_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 384;
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let (square, diamond) = star(2.0 * u % 1.0, 2.0 * v % 1.0);
        let (_, across) = star(u, v);
        let joint = square > 0.488;
        let color = if diamond > 0.565 {
            SLATE
        } else if joint {
            0.4 * CREAM
        } else if across < 0.10 || diamond < 0.16 {
            RUST
        } else if diamond < 0.175 {
            SLATE
        } else {
            CREAM
        };
        let slab = key.mix((2.0 * u) as u64).mix((2.0 * v) as u64).uniform(0);
        let cloud = noise(key, 16.0 * u, 16.0 * v, 16) + noise(key.mix(1), 64.0 * u, 64.0 * v, 64);
        color * (0.72 + 0.18 * cloud + 0.12 * slab)
    })
}

/// Painted boards: a chain of lozenges in red, ochre and green between dark joints.
fn board_texture(key: RandomKey) -> Texture {
    const SIDE: u32 = 256;
    const OCHRE: Vec3 = Vec3::new(0.55, 0.35, 0.13);
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let board = (4.0 * v) as u64;
        let (square, diamond) = star(4.0 * u % 1.0, 4.0 * v % 1.0);
        let color = if square > 0.47 {
            Vec3::new(0.05, 0.03, 0.02)
        } else if square > 0.42 || diamond < 0.12 || (0.28..0.31).contains(&diamond) {
            OCHRE
        } else if diamond < 0.28 {
            RUST
        } else {
            MOSS
        };
        let grain = noise(key.mix(board), 16.0 * u, 128.0 * v, 128);
        color * (0.7 + 0.4 * grain)
    })
}

/// Carved stucco, gilt on blue and red: crossing bands with rosettes in the meshes.
fn tile_texture() -> Texture {
    const SIDE: u32 = 128;
    const GILT: Vec3 = Vec3::new(0.72, 0.50, 0.19);
    const LAPIS: Vec3 = Vec3::new(0.04, 0.085, 0.22);
    bitmap(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let (square, diamond) = star(u, v);
        let (corner_square, corner_diamond) = star((u + 0.5) % 1.0, (v + 0.5) % 1.0);
        let band = |edge: f32, at: f32| (edge - at).abs() < 0.03;
        let rosette = square.min(diamond) < 0.14 || corner_square.min(corner_diamond) < 0.14;
        if band(diamond, 0.353) || rosette || band(square.min(diamond), 0.23) {
            GILT
        } else if diamond < 0.353 {
            LAPIS
        } else {
            RUST
        }
    })
}
