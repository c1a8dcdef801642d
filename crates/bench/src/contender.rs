use lie_farm::PublishedLies;
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

    /// Whether it asks the LIEs.
    #[must_use]
    pub fn uses_lies(self) -> bool {
        match self {
            Self::Standard => false,
            Self::Lie => true,
        }
    }

    /// Renders a frame on rayon's current threads.
    pub(crate) fn render(
        self,
        stage: &Stage,
        lies: &PublishedLies,
        progress: &mut (dyn FnMut(f32) + Send),
    ) -> (Film, RenderStats) {
        let lookup = self.uses_lies().then_some(lies as &dyn LieLookup);
        render_frame(
            stage.world(),
            lookup,
            stage.camera(),
            stage.settings(),
            progress,
        )
    }
}
