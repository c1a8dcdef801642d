use std::sync::Arc;
use glam::{UVec2, Vec3};
use lie_octree::*;
use lie_geom::Ray;
use lie_scene::Camera;
use super::render::World;
#[derive(Clone, Copy, Debug, Default)]
pub struct ConstructSettings { pub lies: LieSettings }
#[derive(Clone, Debug, PartialEq)]
pub struct View { pub camera: Camera, pub size: UVec2 }
pub struct BatchReport { pub changed: Vec<CellKey>, pub samples: u64, pub version: u64, pub estimated_error: f32, pub converged: bool }
struct Floor;
impl Visibility for Floor {
    fn blocker(&self, ray: &Ray) -> Option<u32> { (ray.origin.y < 0.5).then_some(0) }
    fn blocks(&self, _t: u32, ray: &Ray) -> bool { ray.origin.y < 0.5 }
}
pub struct Builder { tree: LieTree, n: u32, world: Arc<World> }
impl Builder {
    pub fn new(world: Arc<World>, settings: ConstructSettings) -> Self { Self { tree: LieTree::new(world.scene.geometry.bounds(), settings.lies), n: 0, world } }
    pub fn batch(&mut self, _views: &[View]) -> BatchReport {
        std::thread::sleep(std::time::Duration::from_millis(5));
        let b = self.world.scene.geometry.bounds();
        for _ in 0..20 {
            self.n += 1;
            let f = |k: u32| (self.n.wrapping_mul(k) % 1000) as f32 / 1000.0;
            let p = b.min + b.size() * Vec3::new(f(7919), f(104729), f(1299709));
            let rays = [ShadowRay { light: 0, ray: Ray::segment(p, Vec3::Y * 9.0), weight: 1.0 }];
            let o = observe(&self.tree, p, &rays, &Floor);
            self.tree.record(&o);
        }
        let changed = self.tree.commit();
        BatchReport { changed, samples: self.tree.samples(), version: self.tree.version(), estimated_error: 1.0 / self.n as f32, converged: self.n > 2000 }
    }
    pub fn snapshot(&self) -> (LieTree, u64) { (self.tree.clone(), self.tree.version()) }
}
