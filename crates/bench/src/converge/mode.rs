use lie_farm::{ConstructSettings, Order};
use lie_octree::LieSettings;

/// How LIEs are constructed, and what is relied on before it is known well.
///
/// All but the first two are mode *trust* with one piece of it switched off: what that makes
/// worse is what the piece is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Everything is relied on: what is not known to be lit is dark (LIE §4.2).
    Paper,
    /// What enough samples agree on is relied on; the rest is traced.
    Trust,
    /// Nothing is settled by geometry: samples alone tell.
    NoProofs,
    /// The parts of a cell that splits start from nothing.
    FromScratch,
    /// Lists of occluders may have any length.
    NoCrowd,
    /// Every point is sampled, in the order of space, however well its light is known.
    InOrder,
}

impl Mode {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Paper,
        Self::Trust,
        Self::NoProofs,
        Self::FromScratch,
        Self::NoCrowd,
        Self::InOrder,
    ];

    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Trust => "trust",
            Self::NoProofs => "no-proofs",
            Self::FromScratch => "from-scratch",
            Self::NoCrowd => "no-crowd",
            Self::InOrder => "in-order",
        }
    }

    /// What a reader of its figures has to know of it.
    pub(super) fn about(self) -> &'static str {
        match self {
            Self::Paper => "*paper* relies on what little is known",
            Self::Trust => "*trust* traces what is in doubt",
            Self::NoProofs => "*no-proofs* is *trust* where samples alone tell, not geometry",
            Self::FromScratch => {
                "*from-scratch* is *trust* where the parts of a cell that splits start from nothing"
            }
            Self::NoCrowd => "*no-crowd* is *trust* where lists of occluders may have any length",
            Self::InOrder => {
                "*in-order* is *trust* where every pixel is sampled, in the order of space, \
                 and not where most is in doubt"
            }
        }
    }

    /// Construction in this mode, otherwise as these settings have it. Where they trust
    /// everything, all modes but the paper's have the usual trust.
    pub(super) fn settings(self, mut settings: ConstructSettings) -> ConstructSettings {
        let lie = &mut settings.lie;
        lie.trust = match (self, lie.trust) {
            (Self::Paper, _) => 0,
            (_, 0) => LieSettings::default().trust,
            (_, trust) => trust,
        };
        match self {
            Self::Paper | Self::Trust => {}
            Self::NoProofs => settings.proofs = false,
            Self::FromScratch => lie.inherit = false,
            Self::NoCrowd => lie.crowd = u32::MAX,
            Self::InOrder => settings.order = Order::Space,
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mode_differs_from_trust_in_one_piece() {
        let usual = ConstructSettings::new(&lie_scene::cornell_box());
        assert_eq!(Mode::Trust.settings(usual), usual);
        for mode in Mode::ALL {
            let settings = mode.settings(usual);
            let pieces = [
                settings.lie.trust == usual.lie.trust,
                settings.proofs,
                settings.lie.inherit,
                settings.lie.crowd == usual.lie.crowd,
                settings.order == usual.order,
            ];
            let off = pieces.iter().filter(|&&is_on| !is_on).count();
            assert_eq!(off, usize::from(mode != Mode::Trust), "{mode:?}");
        }
    }

    #[test]
    fn only_the_paper_trusts_everything() {
        let mut usual = ConstructSettings::new(&lie_scene::cornell_box());
        for given in [0, 7] {
            usual.lie.trust = given;
            for mode in Mode::ALL {
                let trust = mode.settings(usual).lie.trust;
                assert_eq!(trust == 0, mode == Mode::Paper, "{mode:?}");
                assert!(given == 0 || trust == 0 || trust == 7, "{mode:?}");
            }
        }
    }
}
