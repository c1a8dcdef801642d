use lie_farm::{ConstructSettings, PublishedLies};
use lie_render::{Film, FrameSettings, LieLookup, RenderStats, render_frame};

use crate::Stage;

/// A way to render a frame, as a line of the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// A full shadow ray for every light and sample: the reference.
    Standard,
    /// Full shadow rays to the lights that give most; the rest is estimated.
    Ward,
    /// Local illumination environments.
    Lie,
    /// The same with masking, at the paper's 2 % (LIE §5).
    LieMasked,
}

impl Contender {
    /// All of them, in the order of the paper's Table 1.
    pub const ALL: &'static [Self] = &[Self::Standard, Self::Ward, Self::Lie, Self::LieMasked];

    /// Share of a point's light that Ward estimates: what `lie render` does by default.
    const WARD_THRESHOLD: f32 = 0.05;

    /// Share of a cell's least light that masked lights may give together (LIE §5).
    const MASKING: f32 = 0.02;

    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Ward => "ward",
            Self::Lie => "lie",
            Self::LieMasked => "lie-masked",
        }
    }

    /// Whether it asks LIEs.
    #[must_use]
    pub fn uses_lies(self) -> bool {
        matches!(self, Self::Lie | Self::LieMasked)
    }

    /// How its LIEs are constructed, if it asks any.
    pub(crate) fn construction(self, mut usual: ConstructSettings) -> Option<ConstructSettings> {
        match self {
            Self::Standard | Self::Ward => None,
            Self::Lie => Some(usual),
            Self::LieMasked => {
                usual.lie.masking = Self::MASKING;
                Some(usual)
            }
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
        let settings = FrameSettings {
            ward: (self == Self::Ward).then_some(Self::WARD_THRESHOLD),
            ..*stage.settings()
        };
        render_frame(world, lookup, camera, &settings, progress)
    }
}
