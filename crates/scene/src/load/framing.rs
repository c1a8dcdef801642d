//! What a file without a camera or a light gets.

use glam::Vec3;
use lie_geom::Aabb;

use crate::{Camera, Light, LightKind, draft::Draft};

const VERTICAL_FOV: f32 = 0.8;

/// Adds a camera named `framed` where there is none, and a light named `default` where
/// nothing shines.
pub(super) fn add_missing(draft: &mut Draft) {
    let bounds = draft.bounds();
    if bounds.is_empty() {
        draft.warnings.push("there is no triangle in it".into());
    }
    if draft.cameras.is_empty() {
        draft.cameras.push(framed(bounds));
    }
    if !draft.has_lights() {
        let eye = draft.cameras[0].eye;
        draft.lights.push(default_light(bounds, eye));
        draft.warnings.push(
            "there is no light in it: a white point light beside the first camera stands in; \
             add lights in a scene.toml that names this file as its geometry"
                .into(),
        );
    }
}

/// A three-quarter view of the whole from outside, slightly from above.
pub(crate) fn framed(bounds: Aabb) -> Camera {
    let center = bounds.center();
    let radius = (0.5 * bounds.size().length()).max(1.0e-3);
    let distance = radius / (0.5 * VERTICAL_FOV).sin();
    let eye = center + distance * Vec3::new(0.55, 0.45, 0.85).normalize();
    Camera::look_at("framed", eye, center, Vec3::Y, VERTICAL_FOV)
}

/// A point light above the eye, bright enough to give the middle of the scene an
/// irradiance of π: a white surface there has radiance 1.
fn default_light(bounds: Aabb, eye: Vec3) -> Light {
    let radius = (0.5 * bounds.size().length()).max(1.0e-3);
    let position = eye + 0.1 * radius * Vec3::Y;
    let distance = (bounds.center() - position).length().max(0.25 * radius);
    Light {
        name: "default".into(),
        kind: LightKind::Point {
            position,
            radiant_intensity: Vec3::splat(std::f32::consts::PI * distance * distance),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec2};

    #[test]
    fn the_framed_view_holds_all_corners() {
        let bounds = Aabb {
            min: Vec3::new(-1.0, 0.0, 3.0),
            max: Vec3::new(5.0, 2.0, 4.0),
        };
        let camera = framed(bounds);
        let size = UVec2::splat(100);
        let edge = camera.ray(Vec2::new(50.0, 0.0), size).direction;
        let widest = edge.dot(camera.forward());
        for corner in 0..8 {
            let pick = |bit: u32, axis: usize| {
                if corner & bit == 0 {
                    bounds.min[axis]
                } else {
                    bounds.max[axis]
                }
            };
            let to_corner =
                (Vec3::new(pick(1, 0), pick(2, 1), pick(4, 2)) - camera.eye).normalize();
            assert!(to_corner.dot(camera.forward()) >= widest);
        }
        assert!(framed(Aabb::EMPTY).is_valid());
    }
}
