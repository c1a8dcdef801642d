use std::sync::Arc;
use lie_octree::*;
use super::render::{LieLookup, World};
pub struct Replica { inner: lie_octree::Replica<bool> }
#[derive(Debug, thiserror::Error)]
#[error("replica")]
pub struct ReplicaError;
pub struct PublishedLies { pub version: u64 }
impl LieLookup for PublishedLies { fn version(&self) -> u64 { self.version } }
impl Replica {
    pub fn new(world: Arc<World>) -> Self { Self { inner: lie_octree::Replica::new(Cube::around(world.scene.geometry.bounds()), false) } }
    pub fn apply(&mut self, states: impl IntoIterator<Item = CellState>, to_version: u64) -> Result<(), ReplicaError> {
        for state in states { self.inner.apply(&state, |l| l.trusted); }
        self.inner.reached(to_version);
        Ok(())
    }
    pub fn publish(&self) -> Arc<PublishedLies> { Arc::new(PublishedLies { version: self.inner.version() }) }
}
