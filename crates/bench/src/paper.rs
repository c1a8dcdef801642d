//! What the paper measured: LIE §6, Tables 1 and 2.
//!
//! In Java on ten dual-processor Pentium 4 at 1.7 GHz, 512 × 512 pixels, LIEs mostly
//! converged. Its models are not ours, which are made by rule after them: ratios may be
//! compared, seconds may not.

use crate::Contender;

/// A scene of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperScene {
    /// The scene of ours that is made after it.
    pub ours: &'static str,
    /// Its name in the paper.
    pub title: &'static str,
    /// Lines of Table 1, by [`Contender::name`].
    pub table1: [(&'static str, PaperTime); 4],
    /// Its column of Table 2.
    pub table2: PaperStages,
}

/// An entry of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperTime {
    /// Seconds for a frame.
    pub frame_s: f64,
    /// How many times as fast as the standard.
    pub speedup: f64,
}

/// A column of Table 2, without masking, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperStages {
    /// Primary visibility.
    pub visibility_s: f64,
    /// Unoccluded lights.
    pub unoccluded_s: f64,
    /// Partially occluded lights.
    pub partial_s: f64,
    /// The whole frame.
    pub total_s: f64,
}

/// Memory of the mosque's LIEs in megabytes (LIE §6); the paper gives no other.
pub const MOSQUE_LIE_MEGABYTES: f64 = 50.0;

/// The paper's three scenes.
pub const SCENES: [PaperScene; 3] = [
    PaperScene {
        ours: "science-center",
        title: "Science Center",
        table1: table1([(15.0, 1.0), (15.0, 1.0), (1.30, 11.5), (1.30, 11.5)]),
        table2: table2([0.35, 0.05, 0.90, 1.30]),
    },
    PaperScene {
        ours: "bar",
        title: "Bar Carta Blanca",
        table1: table1([(10.1, 1.0), (10.1, 1.0), (0.69, 14.6), (0.69, 14.6)]),
        table2: table2([0.48, 0.14, 0.07, 0.69]),
    },
    PaperScene {
        ours: "mosque",
        title: "Mosque de Cordoba",
        table1: table1([(35.0, 1.0), (11.5, 3.0), (1.45, 24.1), (1.20, 29.2)]),
        table2: table2([0.59, 0.34, 0.52, 1.45]),
    },
];

/// The paper's scene that one of ours is made after.
#[must_use]
pub fn scene(ours: &str) -> Option<&'static PaperScene> {
    SCENES.iter().find(|scene| scene.ours == ours)
}

/// The paper's time for a contender.
#[must_use]
pub fn time(ours: &str, contender: Contender) -> Option<PaperTime> {
    let lines = scene(ours)?.table1;
    let line = lines.iter().find(|(name, _)| *name == contender.name());
    line.map(|&(_, time)| time)
}

/// In the order of the paper's lines: seconds and speed-up.
const fn table1(lines: [(f64, f64); 4]) -> [(&'static str, PaperTime); 4] {
    const NAMES: [&str; 4] = ["standard", "ward", "lie", "lie-masked"];
    let mut named = [(
        "",
        PaperTime {
            frame_s: 0.0,
            speedup: 0.0,
        },
    ); 4];
    let mut line = 0;
    while line < 4 {
        let (frame_s, speedup) = lines[line];
        named[line] = (NAMES[line], PaperTime { frame_s, speedup });
        line += 1;
    }
    named
}

/// In the order of the paper's lines, in seconds.
const fn table2([visibility_s, unoccluded_s, partial_s, total_s]: [f64; 4]) -> PaperStages {
    PaperStages {
        visibility_s,
        unoccluded_s,
        partial_s,
        total_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_tables_agree_with_themselves_and_each_other() {
        for scene in SCENES {
            let standard = scene.table1[0].1.frame_s;
            for (name, time) in scene.table1 {
                let ratio = standard / time.frame_s;
                assert!(
                    (ratio / time.speedup - 1.0).abs() < 0.02,
                    "{} {name}",
                    scene.title
                );
            }
            let parts = scene.table2;
            let sum = parts.visibility_s + parts.unoccluded_s + parts.partial_s;
            assert!((sum - parts.total_s).abs() < 1.0e-9, "{}", scene.title);
            let lie = time(scene.ours, Contender::Lie).unwrap();
            assert_eq!(lie.frame_s, parts.total_s);
        }
        assert_eq!(time("cornell", Contender::Lie), None);
    }
}
