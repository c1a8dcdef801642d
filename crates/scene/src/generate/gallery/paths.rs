//! Cameras and the walkthrough.

use glam::Vec3;

use super::Site;
use crate::{Camera, KeyFrame, Walkthrough};

/// Height of the visitor's eyes.
const EYE: f32 = 1.62;

impl Site {
    pub(super) fn add_paths(&mut self) {
        for (name, eye, target, degrees) in [
            ("court", [-5.3, EYE, -8.8], [-1.1, 2.0, -13.3], 62.0f32),
            ("hall", [1.25, EYE, 6.55], [-0.75, 1.85, 0.0], 62.0),
            ("west gallery", [-2.6, EYE, -1.7], [-7.2, 1.55, -5.6], 60.0),
            ("east gallery", [2.7, EYE, -7.3], [7.4, 1.35, -2.9], 60.0),
            ("corridor", [0.55, EYE, -0.9], [-0.25, 1.45, -8.0], 58.0),
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

/// In at the entrance, down the corridor, through the west gallery and round the court to
/// the east gallery's door and in.
fn tour() -> Walkthrough {
    // Time, x and z of the visitor, and what the visitor looks at.
    let stations: [(f32, [f32; 2], [f32; 3]); 18] = [
        (0.0, [0.5, 6.3], [-0.4, 1.9, 0.0]),
        (1.6, [0.4, 4.2], [-0.6, 2.0, -1.0]),
        (3.2, [0.1, 1.6], [0.0, 1.7, -4.0]),
        (4.4, [0.0, -0.6], [-0.2, 1.5, -6.0]),
        (5.6, [0.0, -2.9], [-1.6, 1.4, -6.4]),
        (6.5, [-0.35, -4.3], [-4.5, 1.5, -5.2]),
        (7.4, [-1.75, -4.5], [-9.0, 1.6, -4.8]),
        (8.5, [-3.7, -4.4], [-9.0, 1.6, -3.6]),
        (9.6, [-4.9, -5.5], [-9.0, 1.6, -6.6]),
        (10.6, [-5.2, -7.0], [-4.2, 1.5, -12.5]),
        (11.3, [-5.2, -8.2], [-2.0, 1.7, -13.0]),
        (12.4, [-4.1, -9.9], [0.0, 1.8, -12.8]),
        (13.8, [-1.5, -10.4], [0.4, 1.8, -13.4]),
        (15.2, [1.5, -10.4], [1.2, 1.7, -13.6]),
        (16.6, [4.1, -9.9], [5.6, 1.5, -12.0]),
        (17.7, [5.2, -8.6], [5.6, 1.55, -4.0]),
        (18.7, [5.2, -7.2], [7.4, 1.5, -2.6]),
        (20.5, [4.3, -5.9], [7.6, 1.5, -1.6]),
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
