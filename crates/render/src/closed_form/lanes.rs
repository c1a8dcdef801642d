//! The closed form for sixteen points at once. Each lane does what [`Outlines::irradiance`] does
//! for one point, operation by operation, so the results are the same bits; lanes where a
//! polygon crosses the horizon are done one by one.

use lie_accel::PACKET;
use multiversion::multiversion;

use super::{
    At, Outlines,
    edge::{Vector, dot, edge_term, larger, smaller, subtract},
    outline::Outline,
    side,
};
use crate::point_lanes::{Lanes, PointLanes};

type Wide = [f64; PACKET];

/// Lanes by bits.
struct Found {
    /// Where all of the polygon is above the horizon.
    whole: u32,
    /// Where some of it is.
    cut: u32,
}

impl Outlines {
    /// [`Self::irradiance`] for each lane.
    pub(crate) fn irradiances(&self, points: &PointLanes) -> Lanes {
        let mut sums = [0.0; PACKET];
        for outline in &self.outlines {
            let found = classify(points, outline, self.double_sided);
            if found.whole != 0 {
                add_whole(points, outline, self.double_sided, found.whole, &mut sums);
            }
            for (lane, sum) in sums.iter_mut().enumerate() {
                if found.cut >> lane & 1 == 1 {
                    *sum += self.cut(outline, &at(points, lane));
                }
            }
        }
        sums.map(|sum| sum as f32)
    }

    /// [`Self::is_far`]: bit `i` for lane `i`.
    pub(crate) fn far(&self, points: &PointLanes, samples: u32) -> u32 {
        self.frame.far(points, samples)
    }
}

#[inline(always)]
fn at(points: &PointLanes, lane: usize) -> At {
    let of = |axes: &[Lanes; 3]| -> Vector {
        [
            axes[0][lane].into(),
            axes[1][lane].into(),
            axes[2][lane].into(),
        ]
    };
    At {
        position: of(&points.position),
        normal: of(&points.normal),
        geometric_normal: of(&points.geometric_normal),
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn classify(points: &PointLanes, outline: &Outline, double_sided: bool) -> Found {
    let mut sides = [0.0; PACKET];
    let mut any = false;
    for lane in 0..PACKET {
        sides[lane] = side(outline, at(points, lane).position, double_sided);
        any |= sides[lane] != 0.0;
    }
    if !any {
        return Found { whole: 0, cut: 0 };
    }
    let mut lowest = [f64::INFINITY; PACKET];
    let mut highest = [f64::NEG_INFINITY; PACKET];
    let mut highest_flat = [f64::NEG_INFINITY; PACKET];
    for &corner in outline.loops.iter().flatten() {
        for lane in 0..PACKET {
            let at = at(points, lane);
            let corner = subtract(corner, at.position);
            let height = dot(at.normal, corner);
            let height_flat = dot(at.geometric_normal, corner);
            lowest[lane] = smaller(lowest[lane], smaller(height, height_flat));
            highest[lane] = larger(highest[lane], height);
            highest_flat[lane] = larger(highest_flat[lane], height_flat);
        }
    }
    let (mut whole, mut cut) = (0, 0);
    for lane in 0..PACKET {
        let is_lit = (sides[lane] != 0.0) & (highest[lane] > 0.0) & (highest_flat[lane] > 0.0);
        whole |= u32::from(is_lit & (lowest[lane] >= 0.0)) << lane;
        cut |= u32::from(is_lit & (lowest[lane] < 0.0)) << lane;
    }
    Found { whole, cut }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn add_whole(
    points: &PointLanes,
    outline: &Outline,
    double_sided: bool,
    lanes: u32,
    sums: &mut Wide,
) {
    let mut terms = [0.0; PACKET];
    for corners in &outline.loops {
        let (mut last, mut last_length) = ([[0.0; PACKET]; 3], [0.0; PACKET]);
        let start = corners[corners.len() - 1];
        for lane in 0..PACKET {
            let corner = subtract(start, at(points, lane).position);
            for axis in 0..3 {
                last[axis][lane] = corner[axis];
            }
            last_length[lane] = dot(corner, corner).sqrt();
        }
        for &corner in corners {
            for lane in 0..PACKET {
                let at = at(points, lane);
                let corner = subtract(corner, at.position);
                let length = dot(corner, corner).sqrt();
                let before = [last[0][lane], last[1][lane], last[2][lane]];
                let ends = ((before, last_length[lane]), (corner, length));
                terms[lane] += edge_term(at.normal, ends.0, ends.1);
                for axis in 0..3 {
                    last[axis][lane] = corner[axis];
                }
                last_length[lane] = length;
            }
        }
    }
    for lane in 0..PACKET {
        let side = side(outline, at(points, lane).position, double_sided);
        let irradiance = larger(side * terms[lane], 0.0);
        sums[lane] += if lanes & (1 << lane) != 0 {
            irradiance
        } else {
            0.0
        };
    }
}
