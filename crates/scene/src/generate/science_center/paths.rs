//! Cameras and the walkthrough.

use glam::Vec3;

use super::{BALCONY, GALLERY, Site};
use crate::{Camera, KeyFrame, Walkthrough};

/// Height of the visitor's eyes.
const EYE: f32 = 1.62;

impl Site {
    pub(super) fn add_paths(&mut self) {
        for (name, eye, target, degrees) in [
            ("atrium", [3.9, EYE + 0.1, 12.2], [-1.4, 3.6, -5.0], 66.0f32),
            (
                "gallery",
                [7.85, GALLERY + EYE + 0.15, 4.4],
                [-3.4, 2.8, -3.6],
                62.0,
            ),
            ("cafe", [2.0, EYE, 11.0], [5.6, 1.6, 0.4], 56.0),
            (
                "balcony",
                [-6.75, BALCONY + EYE + 0.1, 8.6],
                [3.4, 2.6, -5.6],
                62.0,
            ),
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

/// From the glass front through the atrium, up the wide stairs, and along the balcony.
fn tour() -> Walkthrough {
    // Time, the floor under the visitor, and what the visitor looks at.
    let stations: [(f32, [f32; 3], [f32; 3]); 15] = [
        (0.0, [2.4, 0.0, 11.2], [-1.0, 4.4, -6.0]),
        (2.4, [1.6, 0.0, 9.9], [-0.6, 5.0, -6.0]),
        (5.0, [0.9, 0.0, 6.9], [-2.2, 3.4, -6.0]),
        (7.6, [0.2, 0.0, 4.0], [-1.0, 4.4, -9.0]),
        (9.8, [0.0, 0.0, 1.4], [0.0, 4.2, -9.5]),
        (11.2, [0.0, 0.15, 0.1], [0.0, 4.4, -9.5]),
        (15.0, [0.0, 2.1, -4.1], [0.0, 5.4, -12.0]),
        (16.2, [0.0, 2.1, -5.2], [0.2, 5.8, -12.0]),
        (19.8, [0.0, 4.15, -9.2], [1.6, 6.0, -14.0]),
        (21.4, [0.5, 4.2, -10.5], [5.6, 6.0, -9.0]),
        (23.4, [2.4, 4.2, -11.0], [7.0, 6.3, -3.0]),
        (26.0, [5.2, 4.2, -10.7], [4.0, 6.6, 3.0]),
        (28.2, [6.9, 4.2, -9.9], [0.0, 7.6, 3.0]),
        (30.4, [7.05, 4.2, -7.6], [-1.0, 8.0, 4.0]),
        (33.4, [7.0, 4.2, -4.6], [-1.0, 7.6, 6.0]),
    ];
    Walkthrough {
        name: "tour".into(),
        key_frames: stations
            .into_iter()
            .map(|(time_s, floor, target)| {
                let eye = Vec3::from(floor) + EYE * Vec3::Y;
                KeyFrame::look_at(time_s, eye, Vec3::from(target), 62f32.to_radians())
            })
            .collect(),
    }
}
