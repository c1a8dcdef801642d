//! What is rendered: geometry, materials, textures, lights, cameras and walkthroughs.
//!
//! Conventions: right-handed, y up, metres, radians, linear Rec. 709 RGB. Radiant
//! intensity in W·sr⁻¹, radiance in W·sr⁻¹·m⁻², irradiance in W·m⁻², each per channel.
//! glTF's candela and cd·m⁻² are taken one to one as these; an exposure setting does the
//! rest. A cone's angles are measured from its axis. All geometry is in world space:
//! loaders apply every transform.
//!
//! [`Scene`] is the whole; [`load`] reads one from a file; [`cornell_box`], [`gallery`], [`bar`],
//! [`mosque`], [`science_center`] and [`rooms`] make one by rule; [`export_glb`] and [`export_obj`] write one, and [`Summary`] says what
//! is in it.
//!
//! ```
//! let scene = lie_scene::cornell_box();
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("cornell.glb");
//! std::fs::write(&path, lie_scene::export_glb(&scene)?.content)?;
//! let loaded = lie_scene::load(&path)?;
//! assert_eq!(loaded.scene.geometry, scene.geometry);
//! println!("{}", lie_scene::Summary::new(&loaded.scene));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod area_light;
mod area_shape;
mod camera;
mod draft;
mod export;
mod generate;
mod geometry;
mod light;
mod light_reach;
mod load;
mod material;
mod model;
mod summary;
mod surface;
mod surface_lanes;
mod texture;
mod walkthrough;

pub use area_light::{AreaLight, AreaShape, LightPoint};
pub use camera::{Camera, CameraFilm};
pub use export::{ExportError, Exported, ObjText, export_glb, export_obj};
pub use generate::{
    Bar, Gallery, Mosque, Rooms, ScienceCenter, bar, cornell_box, gallery, mosque, rooms,
    science_center,
};
pub use geometry::{Geometry, GeometryError, MeshPart, Vertex};
pub use light::{Light, LightKind, LightSample, ramp_slope};
pub use load::{LoadError, Loaded, MAX_FILE_BYTES, load};
pub use material::{AlphaMode, Material, TextureRef};
pub use model::{Background, RenderSettings, Scene, SceneError};
pub use summary::{LightSummary, MaterialCounts, Summary};
pub use surface::Surface;
pub use surface_lanes::{SURFACE_LANES, SurfaceLanes};
pub use texture::{Texture, TextureError};
pub use walkthrough::{KeyFrame, Walkthrough};
