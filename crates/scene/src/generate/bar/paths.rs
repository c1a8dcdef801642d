//! Cameras and the walkthrough.

use glam::Vec3;

use super::Site;
use crate::{Camera, KeyFrame, Walkthrough};

/// Height of the guest's eyes.
const EYE: f32 = 1.62;

impl Site {
    pub(super) fn add_paths(&mut self) {
        for (name, eye, target, degrees) in [
            ("room", [6.1, 1.72, 2.15], [-1.6, 1.18, -1.6], 58.0f32),
            ("counter", [2.75, 1.5, -1.72], [-4.4, 1.28, -3.2], 50.0),
            ("table", [-0.35, 1.22, 1.95], [-1.62, 0.80, 0.62], 46.0),
        ] {
            self.draft.cameras.push(Camera::look_at(
                name,
                Vec3::from(eye),
                Vec3::from(target),
                Vec3::Y,
                degrees.to_radians(),
            ));
        }
        self.draft.walkthroughs.push(tour());
    }
}

/// In at the door, along the counter to the casks, round by the piano and back before the
/// bench to the armchairs.
fn tour() -> Walkthrough {
    // Time, x and z of the guest, and what the guest looks at.
    let stations: [(f32, [f32; 2], [f32; 3]); 13] = [
        (0.0, [6.1, 1.6], [0.0, 1.3, -1.2]),
        (1.6, [5.3, 0.75], [-0.5, 1.3, -2.2]),
        (3.4, [4.2, -0.55], [-1.0, 1.4, -3.2]),
        (5.4, [2.3, -0.85], [-1.6, 1.4, -4.0]),
        (7.6, [0.0, -0.85], [-2.6, 1.4, -4.3]),
        (9.8, [-2.3, -0.85], [-4.6, 1.4, -4.3]),
        (11.9, [-4.4, -0.8], [-7.0, 1.25, -3.2]),
        (13.4, [-5.1, -0.1], [-7.0, 1.2, 0.4]),
        (14.9, [-5.2, 1.2], [-4.6, 1.2, 4.4]),
        (16.6, [-4.3, 2.15], [-0.6, 1.3, 4.0]),
        (18.9, [-2.0, 2.2], [1.6, 1.1, 2.2]),
        (21.4, [0.7, 2.2], [4.6, 1.0, 1.2]),
        (24.4, [3.3, 2.1], [3.6, 1.2, -4.0]),
    ];
    Walkthrough {
        name: "tour".into(),
        key_frames: stations
            .into_iter()
            .map(|(time_s, [x, z], target)| {
                let eye = Vec3::new(x, EYE, z);
                KeyFrame::look_at(time_s, eye, Vec3::from(target), 60f32.to_radians())
            })
            .collect(),
    }
}
