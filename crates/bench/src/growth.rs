//! How the time of a frame grows with the number of lights, and with that of triangles.

mod show;

use std::{fs, sync::Arc, time::Instant};

use glam::UVec2;
use lie_render::AccelKind;
use lie_scene::{Mosque, Rooms, Scene};

pub use self::show::{HEADING, json, section, table};
use crate::{Contender, FrameRow, Stage, race::milliseconds};

/// Who renders.
pub const CONTENDERS: &[Contender] = &[Contender::Standard, Contender::Lie];

/// What grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Lights, in closed rooms of ten ([`lie_scene::rooms`]): there are more rooms, and a point
    /// sees as many lights as before.
    Lights,
    /// Triangles: a mosque ([`lie_scene::mosque`]), under a hundred lights, that is carved more
    /// finely.
    Triangles,
}

impl Axis {
    /// Its name in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lights => "lights",
            Self::Triangles => "triangles",
        }
    }
}

/// A step of the way: a view that is made, not loaded.
pub struct Step {
    axis: Axis,
    stage: Stage,
    build_ms: f64,
    resident_bytes: Option<u64>,
    peak_bytes: Option<u64>,
}

/// One frame of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthRow {
    /// What grows.
    pub axis: Axis,
    /// Lights of the scene.
    pub lights: usize,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Time in which the scene and its hierarchy were made, in milliseconds.
    pub build_ms: f64,
    /// The hierarchy's part of it.
    pub accel_build_ms: f64,
    /// Memory of the hierarchy.
    pub accel_bytes: u64,
    /// Memory of the whole process once the scene was there and its LIEs were not; `None` where
    /// the system does not say.
    pub resident_bytes: Option<u64>,
    /// The most that it had until then.
    pub peak_bytes: Option<u64>,
    /// What was measured.
    pub frame: FrameRow,
}

/// Why there is no such step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// Too few or too many lights.
    #[error("{0} lights are not 1 to {most}", most = Step::MOST_LIGHTS)]
    Lights(u64),
    /// More than the mosque can be divided into, or none.
    #[error("{0} triangles are not 1 to {most}", most = Step::MOST_TRIANGLES)]
    Triangles(u64),
}

impl Step {
    /// Most lights of a step.
    pub const MOST_LIGHTS: u64 = 1_000_000;
    /// Most triangles of a step. What comes out may have a few per cent less.
    pub const MOST_TRIANGLES: u64 = 16_000_000;
    /// Lights of a room.
    const LIGHTS_IN_ROOM: u64 = 10;

    /// Whether there is such a step.
    ///
    /// # Errors
    /// [`StepError`] if there is not.
    pub fn check(axis: Axis, count: u64) -> Result<(), StepError> {
        match axis {
            Axis::Lights if (1..=Self::MOST_LIGHTS).contains(&count) => Ok(()),
            Axis::Lights => Err(StepError::Lights(count)),
            Axis::Triangles if (1..=Self::MOST_TRIANGLES).contains(&count) => Ok(()),
            Axis::Triangles => Err(StepError::Triangles(count)),
        }
    }

    /// Makes a scene with about so many lights or triangles, and all that rays need of it.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn make(axis: Axis, count: u64, size: UVec2, accel: AccelKind) -> Result<Self, StepError> {
        Self::check(axis, count)?;
        let clock = Instant::now();
        let mut scene = scene(axis, count);
        let number = match axis {
            Axis::Lights => scene.lights.len(),
            Axis::Triangles => scene.geometry.len(),
        };
        scene.name = format!("{}, {number} {}", scene.name, axis.name());
        let camera = scene.cameras[0].clone();
        let path = format!("(made: {})", scene.name);
        let stage = Stage::new(path, Arc::new(scene), camera, size, accel);
        Ok(Self {
            axis,
            stage,
            build_ms: milliseconds(clock.elapsed()),
            resident_bytes: status_bytes("VmRSS:"),
            peak_bytes: status_bytes("VmHWM:"),
        })
    }

    /// The view.
    #[must_use]
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// What was measured of it.
    #[must_use]
    pub fn rows(&self, frames: Vec<FrameRow>) -> Vec<GrowthRow> {
        let scene = self.stage.world().scene();
        let row = |frame| GrowthRow {
            axis: self.axis,
            lights: scene.lights.len(),
            triangles: scene.geometry.len(),
            build_ms: self.build_ms,
            accel_build_ms: self.stage.build_ms(),
            accel_bytes: self.stage.world().accel().bytes() as u64,
            resident_bytes: self.resident_bytes,
            peak_bytes: self.peak_bytes,
            frame,
        };
        frames.into_iter().map(row).collect()
    }
}

fn scene(axis: Axis, count: u64) -> Scene {
    match axis {
        Axis::Lights => {
            let in_each = Step::LIGHTS_IN_ROOM.min(count);
            lie_scene::rooms(&Rooms {
                rooms: (count / in_each) as u32,
                lights_in_each: in_each as u32,
            })
        }
        Axis::Triangles => mosque_of(count),
    }
}

/// The mosque with about so many triangles. Columns have whole numbers of sides, so that few
/// triangles come in steps: what is far off is made again.
fn mosque_of(triangles: u64) -> Scene {
    const TRIES: usize = 4;
    let make = |detail| {
        lie_scene::mosque(&Mosque {
            detail,
            ..Mosque::default()
        })
    };
    let mut detail = mosque_detail(triangles as f32 * 1.0e-6);
    for _ in 1..TRIES {
        let scene = make(detail);
        let share = triangles as f32 / scene.geometry.len() as f32;
        if (share - 1.0).abs() < 0.05 {
            return scene;
        }
        // It is gone before the next is made: there may be memory for one alone.
        detail *= share.sqrt();
    }
    make(detail)
}

/// The mosque's detail for so many million triangles: what solves the polynomial that gives their
/// number ([`Mosque::detail`]).
fn mosque_detail(millions: f32) -> f32 {
    let (square, linear, constant) = (0.488, 0.314, 0.180);
    let rest = (millions - constant).max(0.0);
    let root = (linear * linear + 4.0 * square * rest).sqrt();
    (root - linear) / (2.0 * square)
}

/// Memory of this process that is not on disk, now (`VmRSS:`) or at its most (`VmHWM:`), where
/// Linux says so.
fn status_bytes(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(key))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_have_about_what_was_asked_for() {
        for (lights, expected) in [(3, 3), (10, 10), (100, 100), (128, 120)] {
            assert_eq!(scene(Axis::Lights, lights).lights.len(), expected);
        }
        for wanted in [300_000, 1_000_000, 2_500_000] {
            let triangles = scene(Axis::Triangles, wanted).geometry.len();
            let most = wanted as usize / 10;
            assert!(
                triangles.abs_diff(wanted as usize) < most,
                "{triangles} for {wanted}"
            );
        }
    }

    #[test]
    fn steps_that_nobody_can_make_are_refused() {
        for (axis, count) in [
            (Axis::Lights, 0),
            (Axis::Lights, 1_000_001),
            (Axis::Triangles, 0),
            (Axis::Triangles, 16_000_001),
        ] {
            let error = Step::check(axis, count).unwrap_err().to_string();
            assert!(error.contains(&count.to_string()), "{error}");
        }
        assert_eq!(Step::check(Axis::Lights, 10_000), Ok(()));
    }

    #[test]
    fn a_step_knows_its_size() {
        let size = UVec2::splat(32);
        let step = Step::make(Axis::Lights, 20, size, AccelKind::default()).unwrap();
        assert_eq!(step.stage().name(), "rooms, 20 lights");
        assert_eq!(step.stage().settings().size, size);
        let rows = step.rows(crate::table1::tests::rows());
        assert!(
            rows.iter()
                .all(|row| row.lights == 20 && row.build_ms > row.accel_build_ms)
        );
        assert!(rows.iter().all(|row| row.accel_bytes > 0));
        assert!(rows.iter().all(|row| row.peak_bytes >= row.resident_bytes));
    }
}
