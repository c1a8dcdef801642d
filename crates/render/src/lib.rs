//! From a scene and a camera to a picture: integrators, the tile renderer, film, tone
//! mapping, image files and image metrics.
//!
//! [`World`] is a scene with its acceleration structure. [`render_tile`] renders one
//! [`Tile`] of a frame; [`render_frame`] all of them, on the threads at hand. What the
//! local illumination environments say is asked through [`LieLookup`]: this crate knows
//! cells, not trees.
//!
//! [`Aovs`] is what a frame's pixels show and cost beside their light, found in a pass of its
//! own: the renderer knows nothing of it.
//!
//! [`PixelLight`] is one pixel's light, light by light, as LIEs have it and as it is.
//!
//! Every pixel is a function of scene, camera, [`FrameSettings`] and the LIEs alone: the
//! random numbers are keyed by pixel, sample and light, and sums are taken in one order.
//!
//! ```no_run
//! # use std::sync::Arc;
//! # use lie_render::{FrameSettings, World, render_frame};
//! # fn scene() -> lie_scene::Scene { unimplemented!() }
//! let world = World::new(Arc::new(scene()));
//! let settings = FrameSettings::new(&world.scene().settings);
//! let camera = &world.scene().cameras[0];
//! let (film, stats) = render_frame(&world, None, camera, &settings, &mut |_| {});
//! println!("{} shadow rays", stats.shadow_rays);
//! lie_render::write_exr("picture.exr".as_ref(), &film, lie_render::Precision::Float)?;
//! # Ok::<(), lie_render::ImageError>(())
//! ```

mod aov;
mod area_lanes;
mod audit;
mod brdf;
mod camera_ray;
mod cell;
mod cell_answers;
mod cell_sort;
mod closed_form;
mod delta_lanes;
mod expected_error;
mod film;
mod first_hits;
mod frame;
mod groups;
mod image_file;
mod light_form;
mod light_rays;
mod light_set;
mod metrics;
mod occluder_lists;
mod one_by_one;
mod pixel_light;
mod point_group;
mod point_lanes;
mod shading_point;
mod shadow_cache;
mod shadow_queue;
mod stats;
mod tile;
mod tile_renderer;
mod tone_map;
mod ward;
mod world;

pub use aov::{AovLies, AovPixel, Aovs, CellAov, CellFacts, CostModel, OddsOf, Work, write_aovs};
pub use audit::{Audit, Mismatch, audit};
pub use brdf::Brdf;
pub use cell::{LieCell, LieLookup};
pub use cell_answers::LightAnswer;
pub use expected_error::{AtStake, ExpectedError, RayOdds};
pub use film::{Film, Precision};
pub use frame::render_frame;
pub use image_file::{ImageError, read_image, write_exr, write_png};
pub use lie_accel::AccelKind;
pub use light_rays::{LightPoints, LightRay};
pub use light_set::LightSet;
pub use metrics::{Comparison, compare};
pub use occluder_lists::OccluderLists;
pub use pixel_light::{LightShare, PixelLight};
pub use stats::RenderStats;
pub use tile::{RadianceTile, TILE_SIDES, Tile, TileError, tiles, tiles_of};
pub use tile_renderer::{FrameSettings, TileResult, render_tile};
pub use tone_map::{ToneCurve, ToneMap};
pub use world::World;

/// Luminance of linear Rec. 709 colour.
#[must_use]
pub fn luminance(color: glam::Vec3) -> f32 {
    color.dot(glam::Vec3::new(0.2126, 0.7152, 0.0722))
}
