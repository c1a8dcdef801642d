use glam::{Quat, Vec3};

use crate::Camera;

/// A camera's path through a scene, by key frames.
///
/// Between key frames the eye follows a cubic Hermite curve with Catmull-Rom tangents for
/// uneven times, and the orientation turns at constant speed between neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Walkthrough {
    /// Name to call it by.
    pub name: String,
    /// At least one, in strictly rising time.
    pub key_frames: Vec<KeyFrame>,
}

/// Where a walkthrough's camera is at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyFrame {
    /// Seconds from the start.
    pub time_s: f32,
    /// The pinhole, in world space.
    pub eye: Vec3,
    /// World from camera.
    pub orientation: Quat,
    /// Vertical field of view in radians.
    pub vertical_fov: f32,
}

impl KeyFrame {
    /// A key frame that looks from `eye` at `target`, with +y up.
    #[must_use]
    pub fn look_at(time_s: f32, eye: Vec3, target: Vec3, vertical_fov: f32) -> Self {
        let camera = Camera::look_at("", eye, target, Vec3::Y, vertical_fov);
        Self {
            time_s,
            eye,
            orientation: camera.orientation,
            vertical_fov,
        }
    }
}

impl Walkthrough {
    /// What is wrong with it, if anything; [`Self::camera_at`] is for one with which nothing is.
    #[must_use]
    pub fn problem(&self) -> Option<&'static str> {
        let keys = &self.key_frames;
        let is_possible = |key: &KeyFrame| {
            key.time_s.is_finite()
                && key.eye.is_finite()
                && key.orientation.is_normalized()
                && key.vertical_fov > 0.0
                && key.vertical_fov < std::f32::consts::PI
        };
        if keys.is_empty() {
            Some("has no key frames")
        } else if !keys.windows(2).all(|pair| pair[0].time_s < pair[1].time_s) {
            Some("has key frames whose times do not rise")
        } else if !keys.iter().all(is_possible) {
            Some("has an impossible key frame")
        } else {
            None
        }
    }

    /// Seconds from the first key frame to the last.
    #[must_use]
    pub fn duration_s(&self) -> f32 {
        match (self.key_frames.first(), self.key_frames.last()) {
            (Some(first), Some(last)) => last.time_s - first.time_s,
            _ => 0.0,
        }
    }

    /// The camera `time_s` seconds after the first key frame, held still before and after
    /// the path.
    ///
    /// # Panics
    /// If there is no key frame; [`crate::Scene::validate`] refuses such a walkthrough.
    #[must_use]
    pub fn camera_at(&self, time_s: f32) -> Camera {
        let keys = &self.key_frames;
        let time = keys[0].time_s + time_s.clamp(0.0, self.duration_s());
        let after = keys
            .partition_point(|key| key.time_s <= time)
            .clamp(1, keys.len().max(2) - 1);
        if keys.len() == 1 {
            return self.camera(keys[0].eye, keys[0].orientation, keys[0].vertical_fov);
        }
        let (from, to) = (keys[after - 1], keys[after]);
        let span = to.time_s - from.time_s;
        let s = ((time - from.time_s) / span).clamp(0.0, 1.0);
        let (m0, m1) = (self.velocity(after - 1) * span, self.velocity(after) * span);
        let (s2, s3) = (s * s, s * s * s);
        let eye = from.eye * (2.0 * s3 - 3.0 * s2 + 1.0)
            + m0 * (s3 - 2.0 * s2 + s)
            + to.eye * (3.0 * s2 - 2.0 * s3)
            + m1 * (s3 - s2);
        let fov = from.vertical_fov + s * (to.vertical_fov - from.vertical_fov);
        self.camera(
            eye,
            from.orientation.slerp(to.orientation, s).normalize(),
            fov,
        )
    }

    fn camera(&self, eye: Vec3, orientation: Quat, vertical_fov: f32) -> Camera {
        Camera {
            name: self.name.clone(),
            eye,
            orientation,
            vertical_fov,
        }
    }

    /// The eye's velocity at a key frame in m·s⁻¹: from its neighbours, and zero at the ends.
    fn velocity(&self, index: usize) -> Vec3 {
        let keys = &self.key_frames;
        if index == 0 || index + 1 == keys.len() {
            return Vec3::ZERO;
        }
        let (before, after) = (keys[index - 1], keys[index + 1]);
        (after.eye - before.eye) / (after.time_s - before.time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_goes_through_its_key_frames_and_holds_at_its_ends() {
        let walk = Walkthrough {
            name: "walk".into(),
            key_frames: vec![
                KeyFrame::look_at(1.0, Vec3::ZERO, Vec3::X, 1.0),
                KeyFrame::look_at(2.0, Vec3::X, Vec3::new(1.0, 0.0, 5.0), 0.8),
                KeyFrame::look_at(5.0, Vec3::Z, Vec3::ZERO, 1.0),
            ],
        };
        for key in &walk.key_frames {
            let camera = walk.camera_at(key.time_s - 1.0);
            assert!((camera.eye - key.eye).length() < 1.0e-6);
            assert!((camera.vertical_fov - key.vertical_fov).abs() < 1.0e-6);
        }
        assert_eq!(walk.camera_at(-3.0), walk.camera_at(0.0));
        assert_eq!(walk.camera_at(99.0), walk.camera_at(4.0));
        for step in 0..100 {
            assert!(walk.camera_at(step as f32 * 0.04).is_valid());
        }
        let still = Walkthrough {
            key_frames: walk.key_frames[..1].to_vec(),
            ..walk
        };
        assert_eq!(still.camera_at(3.0).eye, Vec3::ZERO);
    }
}
