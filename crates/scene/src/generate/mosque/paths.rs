//! Cameras and the walkthrough.

use glam::Vec3;

use super::Site;
use crate::{Camera, KeyFrame, Walkthrough};

/// Height of the visitor's eyes.
const EYE: f32 = 1.62;

impl Site {
    pub(super) fn add_paths(&mut self) {
        for (name, eye, target, degrees) in [
            ("forest", [-14.0, EYE, -1.3], [1.5, 3.1, -19.0], 62.0f32),
            ("nave", [0.85, EYE, -3.4], [-0.25, 3.0, -32.0], 60.0),
            ("capital", [-4.15, 2.35, -10.75], [-2.72, 3.32, -9.25], 60.0),
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

/// Down the nave, aside between the columns, along a dim aisle, and back before the mihrab.
fn tour() -> Walkthrough {
    // Time, x and z of the visitor, and what the visitor looks at.
    let stations: [(f32, [f32; 2], [f32; 3]); 15] = [
        (0.0, [0.4, -1.4], [0.0, 3.4, -32.0]),
        (2.0, [0.3, -3.0], [0.0, 3.4, -32.0]),
        (4.0, [0.0, -5.4], [-2.0, 3.4, -24.0]),
        (5.6, [-0.9, -7.2], [-9.0, 2.9, -16.0]),
        (7.0, [-2.4, -8.1], [-14.0, 2.7, -14.0]),
        (8.2, [-3.9, -8.6], [-18.0, 2.7, -14.5]),
        (9.6, [-5.2, -9.7], [-12.0, 2.8, -22.0]),
        (11.4, [-5.5, -11.9], [-7.0, 2.8, -28.0]),
        (13.4, [-5.3, -14.4], [-2.0, 3.0, -26.0]),
        (15.2, [-5.0, -16.6], [6.0, 3.2, -24.0]),
        (16.8, [-4.1, -17.5], [9.0, 3.2, -22.0]),
        (18.2, [-2.5, -17.7], [5.0, 3.3, -27.0]),
        (19.8, [-0.9, -18.9], [0.4, 3.4, -32.0]),
        (22.0, [-0.1, -21.6], [0.0, 3.5, -32.0]),
        (25.0, [0.0, -24.6], [0.0, 3.6, -32.0]),
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
