use glam::{Mat3, Vec3};
use lie_accel::PACKET;
use lie_scene::AreaLight;
use multiversion::multiversion;

use crate::point_lanes::{PointLanes, dot, larger, subtract};

/// Solid angle in sr that one sample point of a light may stand for before it counts as near.
pub(crate) const NEAR: f32 = 0.1;

/// A box around a light, along its own axes: what is far from the box is far from the light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    /// The box's edges, unit length.
    axes: [[f32; 3]; 3],
    center: [f32; 3],
    half: [f32; 3],
    /// One side's area in m², and a little more.
    area: f32,
}

impl Frame {
    /// The box that lies on the largest triangle.
    pub(super) fn around(light: &AreaLight) -> Self {
        let by_area =
            |a: &&lie_geom::Triangle, b: &&lie_geom::Triangle| a.area().total_cmp(&b.area());
        let largest = light.triangles().iter().max_by(by_area);
        let axes = largest.map_or(Mat3::IDENTITY, |largest| {
            let along = (largest.b - largest.a).normalize_or(Vec3::X);
            let across = largest.normal.cross(along).normalize_or(Vec3::Y);
            Mat3::from_cols(along, across, largest.normal)
        });
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut coordinate: f32 = 0.0;
        for triangle in light.triangles() {
            for corner in [triangle.a, triangle.b, triangle.c] {
                let place = axes.transpose() * corner;
                (low, high) = (low.min(place), high.max(place));
                coordinate = coordinate.max(corner.abs().max_element());
            }
        }
        // Room for rounding.
        let half = 0.5 * (high - low) + Vec3::splat(4.0e-6 * coordinate);
        Self {
            axes: axes.to_cols_array_2d(),
            center: (axes * (0.5 * (low + high))).to_array(),
            half: half.to_array(),
            area: 1.001 * light.area(),
        }
    }

    /// Whether none of so many samples over the light's area stands for more than [`NEAR`].
    #[inline(always)]
    pub(super) fn is_far(&self, point: [f32; 3], samples: f32) -> bool {
        let offset = subtract(point, self.center);
        let mut squared = 0.0;
        for axis in 0..3 {
            let beyond = larger(dot(self.axes[axis], offset).abs() - self.half[axis], 0.0);
            squared += beyond * beyond;
        }
        samples * NEAR * squared > self.area
    }

    /// The lanes where it is.
    pub(super) fn far(&self, points: &PointLanes, samples: u32) -> u32 {
        far(points, self, samples as f32)
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn far(points: &PointLanes, frame: &Frame, samples: f32) -> u32 {
    let mut is_far = [false; PACKET];
    for lane in 0..PACKET {
        let position = &points.position;
        let point = [position[0][lane], position[1][lane], position[2][lane]];
        is_far[lane] = frame.is_far(point, samples);
    }
    let mut lanes = 0;
    for lane in 0..PACKET {
        lanes |= u32::from(is_far[lane]) << lane;
    }
    lanes
}
