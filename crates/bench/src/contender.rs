use lie_farm::{ConstructSettings, PublishedLies};
use lie_render::{Film, LieLookup, RenderStats, render_frame};

use crate::Stage;

/// A way to render a frame, as a line of the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// A full shadow ray for every light and sample: the reference.
    Standard,
    /// Local illumination environments.
    Lie,
}

impl Contender {
    /// All of them, in the order of the paper's Table 1.
    pub const ALL: &'static [Self] = &[Self::Standard, Self::Lie];

    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Lie => "lie",
        }
    }

    /// Whether it asks LIEs.
    #[must_use]
    pub fn uses_lies(self) -> bool {
        self != Self::Standard
    }

    /// How its LIEs are constructed, if it asks any. Contenders whose settings are equal
    /// share them.
    pub(crate) fn construction(self, usual: ConstructSettings) -> Option<ConstructSettings> {
        match self {
            Self::Standard => None,
            Self::Lie => Some(usual),
        }
    }

    /// Renders a frame on rayon's current threads, asking these LIEs.
    pub(crate) fn render(
        self,
        stage: &Stage,
        lies: Option<&PublishedLies>,
        progress: &mut (dyn FnMut(f32) + Send),
    ) -> (Film, RenderStats) {
        let lookup = lies.map(|lies| lies as &dyn LieLookup);
        let (world, camera) = (stage.world(), stage.camera());
        render_frame(world, lookup, camera, stage.settings(), progress)
    }
}
