use std::sync::{Arc, atomic::{AtomicBool, Ordering}};
use glam::{UVec2, Vec2, Vec3};
use lie_scene::{Camera, Scene};
pub struct World { pub scene: Arc<Scene> }
impl World { pub fn new(scene: Arc<Scene>) -> Self { Self { scene } } pub fn scene(&self) -> &Arc<Scene> { &self.scene } }
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings { pub size: UVec2, pub samples_per_pixel: u32, pub light_samples: u32, pub integrator: Integrator, pub seed: u64 }
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator { Standard, Lie }
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile { pub origin: UVec2, pub size: UVec2 }
pub fn tiles(size: UVec2) -> Vec<Tile> {
    let mut out = vec![];
    for y in (0..size.y).step_by(32) { for x in (0..size.x).step_by(32) {
        let origin = UVec2::new(x, y);
        out.push(Tile { origin, size: (size - origin).min(UVec2::splat(32)) });
    } }
    out
}
pub trait LieLookup { fn version(&self) -> u64; }
#[derive(Default)]
pub struct TileStats { pub primary_rays: u64, pub shadow_rays: u64, pub occluder_tests: u64, pub trusted_pixels: u64 }
pub struct TileResult { pub radiance: Vec<Vec3>, pub stats: TileStats }
pub fn render_tile(_world: &World, lies: &dyn LieLookup, camera: &Camera, settings: &FrameSettings, tile: Tile, cancelled: &AtomicBool) -> Option<TileResult> {
    let mut radiance = vec![];
    std::thread::sleep(std::time::Duration::from_millis(3));
    if cancelled.load(Ordering::Relaxed) { return None; }
    for y in 0..tile.size.y { for x in 0..tile.size.x {
        let p = tile.origin + UVec2::new(x, y);
        radiance.push(camera.ray(p.as_vec2() + Vec2::splat(0.5), settings.size).direction.abs());
    } }
    let n = radiance.len() as u64;
    Some(TileResult { radiance, stats: TileStats { primary_rays: n, trusted_pixels: if lies.version() > 0 { n } else { 0 }, ..Default::default() } })
}
