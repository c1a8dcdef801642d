//! Which parts of space a light cannot shine into, whatever is or is not in between.

use glam::Vec3;
use lie_geom::Aabb;

use crate::{AreaLight, Light, LightKind};

/// Share of all lengths involved by which rounding may move a point.
const SLACK: f32 = 1.0e-4;

/// How often a box is halved along each axis before a cone that meets its sphere is taken
/// to meet the box.
const HALVINGS: u32 = 2;

/// Triangles above which an area light is taken to shine everywhere.
const MAX_TRIANGLES: usize = 256;

impl Light {
    /// Whether the light may give any point in a box anything. If not, then
    /// [`Self::sample`] is `None` for every point there: all of it lies outside the cone, or
    /// behind a one-sided light. It errs towards `true`.
    #[must_use]
    pub fn may_reach(&self, bounds: Aabb) -> bool {
        match &self.kind {
            LightKind::Point { .. } | LightKind::Directional { .. } => true,
            LightKind::Spot {
                position,
                direction,
                cos_outer,
                ..
            } => {
                let cone = Cone {
                    apex: *position,
                    axis: *direction,
                    angle: cos_outer.clamp(-1.0, 1.0).acos(),
                };
                cone.may_meet(bounds, HALVINGS)
            }
            LightKind::Area(area) => may_face(area, bounds),
        }
    }
}

/// Whether any part of a box may lie in front of any triangle of the light.
fn may_face(area: &AreaLight, bounds: Aabb) -> bool {
    if area.double_sided || area.triangles().len() > MAX_TRIANGLES {
        return true;
    }
    let (center, half) = (bounds.center(), 0.5 * bounds.size());
    area.triangles().iter().any(|triangle| {
        let to_center = center - triangle.a;
        let reach = half.dot(triangle.normal.abs());
        let slack = SLACK * (to_center.length() + half.length() + triangle.extent());
        to_center.dot(triangle.normal) + reach + slack > 0.0
    })
}

struct Cone {
    apex: Vec3,
    axis: Vec3,
    /// Half the opening, in `[0, π]`.
    angle: f32,
}

impl Cone {
    /// By the sphere around the box, and around its parts where that does not tell.
    fn may_meet(&self, bounds: Aabb, halvings: u32) -> bool {
        if !self.may_meet_sphere(bounds.center(), 0.5 * bounds.size().length()) {
            return false;
        }
        if halvings == 0 {
            return true;
        }
        let (center, quarter) = (bounds.center(), 0.25 * bounds.size());
        (0..8).any(|octant| {
            let side = |axis: i32| if octant >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let middle = center + quarter * Vec3::new(side(0), side(1), side(2));
            let part = Aabb {
                min: middle - quarter,
                max: middle + quarter,
            };
            self.may_meet(part, halvings - 1)
        })
    }

    fn may_meet_sphere(&self, center: Vec3, radius: f32) -> bool {
        let to_center = center - self.apex;
        let distance = to_center.length();
        let radius = radius + SLACK * (radius + distance);
        if distance <= radius || !distance.is_finite() {
            return true;
        }
        let cosine = (to_center.dot(self.axis) / distance).clamp(-1.0, 1.0);
        let sphere = (radius / distance).asin();
        cosine.acos() - sphere <= self.angle + SLACK
    }
}

#[cfg(test)]
mod tests {
    use lie_geom::RandomKey;

    use super::*;
    use crate::AreaShape;

    fn vector(key: RandomKey, index: u32) -> Vec3 {
        let uniform = |axis: u64| key.mix(axis).uniform(index) - 0.5;
        Vec3::new(uniform(0), uniform(1), uniform(2))
    }

    fn some_light(key: RandomKey) -> Light {
        let position = 4.0 * vector(key, 0);
        let cos_outer = 2.0 * key.uniform(9) - 1.0;
        let kind = if key.uniform(8) < 0.5 {
            LightKind::Spot {
                position,
                direction: vector(key, 1).normalize_or(Vec3::X),
                radiant_intensity: Vec3::ONE,
                cos_inner: 0.5 + 0.5 * cos_outer,
                cos_outer,
            }
        } else {
            let corners =
                |index: u32| [0, 1, 2].map(|corner| position + vector(key, index + corner));
            let triangles = vec![corners(1), corners(4)];
            LightKind::Area(AreaLight::new(
                AreaShape::Mesh { triangles },
                Vec3::ONE,
                false,
            ))
        };
        Light {
            name: String::new(),
            kind,
        }
    }

    /// Whatever a light gives anything is in no box that it cannot reach.
    #[test]
    fn no_point_of_a_box_out_of_reach_is_lit() {
        let mut beyond = 0;
        for seed in 0..4000 {
            let key = RandomKey::new(seed);
            let light = some_light(key);
            let (center, half) = (4.0 * vector(key, 20), (2.0 * vector(key, 21)).abs());
            let bounds = Aabb {
                min: center - half,
                max: center + half,
            };
            if light.may_reach(bounds) {
                continue;
            }
            beyond += 1;
            for index in 0..200 {
                let point = center + 2.0 * half * vector(key.mix(3), index);
                let square = key.mix(4).uniform2(index);
                assert_eq!(light.sample(point, square, 100.0), None, "seed {seed}");
            }
        }
        assert!(beyond > 500, "{beyond} boxes are out of reach");
    }

    /// It does tell: a box well outside a cone, and one behind a lamp.
    #[test]
    fn what_is_plainly_out_of_reach_is_told() {
        let spot = Light {
            name: String::new(),
            kind: LightKind::Spot {
                position: Vec3::ZERO,
                direction: Vec3::NEG_Y,
                radiant_intensity: Vec3::ONE,
                cos_inner: 0.9,
                cos_outer: 0.8,
            },
        };
        let at = |x: f32, y: f32| {
            let center = Vec3::new(x, y, 0.0);
            spot.may_reach(Aabb {
                min: center - Vec3::splat(0.2),
                max: center + Vec3::splat(0.2),
            })
        };
        assert!(at(0.0, -1.0) && at(0.7, -1.0) && at(0.0, 0.0));
        assert!(!at(0.0, 1.0) && !at(1.5, -1.0) && !at(-2.0, 0.0));
    }
}
