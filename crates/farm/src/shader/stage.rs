use std::sync::Arc;

use arc_swap::ArcSwap;
use lie_octree::LieSettings;
use lie_protocol::SceneHash;
use lie_render::World;

use super::ledger::Ledger;
use crate::{LieReplica, PublishedLies};

/// A scene that is ready to be rendered, with the newest LIEs.
pub(super) struct Stage {
    pub(super) scene: SceneHash,
    pub(super) world: Arc<World>,
    /// Replaced as a whole; whoever renders holds on to one version.
    pub(super) lies: ArcSwap<PublishedLies>,
    /// What is wrong with them, as far as was seen.
    pub(super) audits: Ledger,
}

impl Stage {
    /// A stage without knowledge.
    pub(super) fn new(scene: SceneHash, world: Arc<World>, settings: LieSettings) -> Self {
        let lies = LieReplica::new(world.clone(), settings).publish();
        Self {
            scene,
            world,
            lies: ArcSwap::from_pointee(lies),
            audits: Ledger::default(),
        }
    }
}
