//! Everything of a scene but its long arrays. Colours, places and directions as `[f32; 3]`.

use lie_protocol::{WireCamera, WireRenderSettings, WireWalkthrough, codec};
use serde::{Deserialize, Serialize};

/// Most memory that a description may claim when it is read, in bytes.
pub(super) const CLAIM: usize = 1 << 30;

#[derive(Serialize, Deserialize)]
pub(super) struct Description {
    #[serde(deserialize_with = "codec::text")]
    pub(super) name: String,
    pub(super) vertices: u64,
    pub(super) triangles: u64,
    pub(super) parts: Vec<Part>,
    pub(super) materials: Vec<MaterialDescription>,
    pub(super) textures: Vec<TextureDescription>,
    pub(super) lights: Vec<LightDescription>,
    pub(super) cameras: Vec<WireCamera>,
    pub(super) walkthroughs: Vec<WireWalkthrough>,
    pub(super) background: [f32; 3],
    pub(super) settings: WireRenderSettings,
}

#[derive(Serialize, Deserialize)]
pub(super) struct Part {
    #[serde(deserialize_with = "codec::text")]
    pub(super) name: String,
    pub(super) start: u32,
    pub(super) end: u32,
    pub(super) material: u32,
}

#[derive(Serialize, Deserialize)]
pub(super) struct MaterialDescription {
    #[serde(deserialize_with = "codec::text")]
    pub(super) name: String,
    pub(super) base_color: [f32; 3],
    pub(super) base_color_texture: Option<TextureUse>,
    pub(super) alpha: f32,
    pub(super) metallic: f32,
    pub(super) roughness: f32,
    pub(super) metallic_roughness_texture: Option<TextureUse>,
    pub(super) specular: f32,
    pub(super) emission: [f32; 3],
    pub(super) double_sided: bool,
    pub(super) mask_cutoff: Option<f32>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct TextureUse {
    pub(super) texture: u32,
    /// Columns of the affine map.
    pub(super) texture_from_uv: [f32; 6],
}

#[derive(Serialize, Deserialize)]
pub(super) struct TextureDescription {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) srgb: bool,
}

#[derive(Serialize, Deserialize)]
pub(super) struct LightDescription {
    #[serde(deserialize_with = "codec::text")]
    pub(super) name: String,
    pub(super) kind: KindDescription,
}

#[derive(Serialize, Deserialize)]
pub(super) enum KindDescription {
    Point {
        position: [f32; 3],
        radiant_intensity: [f32; 3],
    },
    Spot {
        position: [f32; 3],
        direction: [f32; 3],
        radiant_intensity: [f32; 3],
        cosines: [f32; 2],
    },
    Directional {
        direction: [f32; 3],
        irradiance: [f32; 3],
    },
    Rectangle {
        corner: [f32; 3],
        edge_u: [f32; 3],
        edge_v: [f32; 3],
        radiance: [f32; 3],
        double_sided: bool,
    },
    Mesh {
        triangles: u64,
        radiance: [f32; 3],
        double_sided: bool,
    },
}
