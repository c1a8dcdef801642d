//! What is rendered: geometry, materials, textures, lights, cameras and walkthroughs.
//!
//! Conventions: right-handed, y up, metres, radians, linear Rec. 709 RGB. Radiant
//! intensity in W·sr⁻¹, radiance in W·sr⁻¹·m⁻², irradiance in W·m⁻², each per channel.
//! glTF's candela and cd·m⁻² are taken one to one as these; an exposure setting does the
//! rest. A cone's angles are measured from its axis. All geometry is in world space:
//! loaders apply every transform.

mod camera;
mod draft;
mod export;
mod generate;
mod geometry;
mod light;
mod load;
mod material;
mod model;
mod summary;
mod surface;
mod texture;
mod walkthrough;

pub use camera::Camera;
pub use export::{ExportError, Exported, ObjText, export_glb, export_obj};
pub use generate::{Gallery, cornell_box, gallery};
pub use geometry::{Geometry, GeometryError, MeshPart, Vertex};
pub use light::{AreaLight, AreaShape, Light, LightKind, LightPoint, LightSample};
pub use load::{LoadError, Loaded, MAX_FILE_BYTES, load};
pub use material::{AlphaMode, Material, TextureRef};
pub use model::{Background, RenderSettings, Scene, SceneError};
pub use summary::{LightSummary, MaterialCounts, Summary};
pub use surface::Surface;
pub use texture::{Texture, TextureError};
pub use walkthrough::{KeyFrame, Walkthrough};
