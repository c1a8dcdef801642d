//! Shapes that follow smooth curves: turned and bent things.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::{mesh::Mesh, shapes::lathe};
use crate::Vertex;

/// How far, in metres and at one step to a piece, a point may lie beside the straight line
/// between its neighbours and yet be left out.
const TOLERANCE: f32 = 0.0006;

/// Points along the smooth curve through all `knots` (Catmull-Rom), with at most `steps`
/// pieces from knot to knot; where it is nearly straight, fewer. A knot that stands twice
/// makes a corner.
pub(super) fn smooth(knots: &[Vec3], steps: u32) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = knots.first().copied().into_iter().collect();
    for piece in 1..knots.len() {
        let (from, to) = (knots[piece - 1], knots[piece]);
        if from == to {
            continue;
        }
        let leave = 0.5 * (to - knots[piece.saturating_sub(2)]);
        let arrive = 0.5 * (knots[(piece + 1).min(knots.len() - 1)] - from);
        for step in 1..=steps {
            let s = step as f32 / steps as f32;
            let (s2, s3) = (s * s, s * s * s);
            points.push(
                (2.0 * s3 - 3.0 * s2 + 1.0) * from
                    + (s3 - 2.0 * s2 + s) * leave
                    + (3.0 * s2 - 2.0 * s3) * to
                    + (s3 - s2) * arrive,
            );
        }
    }
    without_straight(&points, TOLERANCE / steps as f32)
}

/// Leaves out points that lie within `tolerance` of the line between their neighbours.
fn without_straight(points: &[Vec3], tolerance: f32) -> Vec<Vec3> {
    let mut kept: Vec<Vec3> = Vec::with_capacity(points.len());
    for (index, &point) in points.iter().enumerate() {
        if let (Some(&before), Some(&after)) = (kept.last(), points.get(index + 1)) {
            let line = (after - before).normalize_or_zero();
            if (point - before).reject_from_normalized(line).length() < tolerance {
                continue;
            }
        }
        kept.push(point);
    }
    kept
}

/// A smooth profile of (radius, height).
pub(super) fn profile(knots: &[[f32; 2]], steps: u32) -> Vec<Vec2> {
    let knots: Vec<Vec3> = knots.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
    smooth(&knots, steps)
        .into_iter()
        .map(|point| Vec2::new(point.x.max(0.0), point.y))
        .collect()
}

/// What a smooth profile makes as it turns about the y axis; see [`lathe`].
pub(super) fn turned(knots: &[[f32; 2]], steps: u32, segments: u32) -> Mesh {
    lathe(&profile(knots, steps), segments)
}

/// A round bar along a path, closed at both ends.
pub(super) fn tube(path: &[Vec3], radius: f32, segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let along = |index: usize| {
        let (before, after) = (index.saturating_sub(1), (index + 1).min(path.len() - 1));
        (path[after] - path[before]).normalize_or(Vec3::Y)
    };
    // The frame is carried along with the least turn, so that the bar does not twist.
    let mut side = along(0).any_orthonormal_vector();
    for index in 0..path.len() {
        let tangent = along(index);
        side = Quat::from_rotation_arc(along(index.saturating_sub(1)), tangent) * side;
        side = (side - side.dot(tangent) * tangent)
            .try_normalize()
            .unwrap_or_else(|| tangent.any_orthonormal_vector());
        for segment in 0..=segments {
            let turn = segment as f32 / segments as f32;
            let (sin, cos) = (turn * TAU).sin_cos();
            let normal = cos * side + sin * tangent.cross(side);
            mesh.vertices.push(Vertex {
                position: path[index] + radius * normal,
                normal,
                uv: Vec2::new(turn, index as f32),
            });
        }
    }
    for index in 1..path.len() as u32 {
        for segment in 0..segments {
            let a = (index - 1) * (segments + 1) + segment;
            let b = a + segments + 1;
            mesh.triangles.push([a, a + 1, b + 1]);
            mesh.triangles.push([a, b + 1, b]);
        }
    }
    for (index, outward) in [(0, -along(0)), (path.len() - 1, along(path.len() - 1))] {
        add_cap(&mut mesh, path[index], outward, index as u32, segments);
    }
    mesh
}

fn add_cap(mesh: &mut Mesh, center: Vec3, outward: Vec3, ring: u32, segments: u32) {
    let first = mesh.vertices.len() as u32;
    let begin = (ring * (segments + 1)) as usize;
    let flat = |position| Vertex {
        position,
        normal: outward,
        uv: Vec2::ZERO,
    };
    mesh.vertices.push(flat(center));
    for segment in 0..=segments as usize {
        let rim = mesh.vertices[begin + segment].position;
        mesh.vertices.push(flat(rim));
    }
    for segment in 1..=segments {
        let fan = [first, first + segment, first + segment + 1];
        mesh.triangles.push(if ring == 0 {
            [fan[0], fan[2], fan[1]]
        } else {
            fan
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_its_knots_keeps_its_corners_and_spares_straight_lines() {
        let knots = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::X,
            Vec3::ONE,
            Vec3::new(0.0, 3.0, 1.0),
        ];
        let points = smooth(&knots, 4);
        assert_eq!(points[..2], knots[..2]);
        assert_eq!((points[5], points[9]), (knots[3], knots[4]));
        assert_eq!(points.len(), 10);
    }

    #[test]
    fn a_tube_is_closed_and_faces_outwards() {
        let path = smooth(
            &[
                Vec3::ZERO,
                Vec3::Y,
                Vec3::new(1.0, 2.0, 0.0),
                Vec3::new(2.0, 2.0, 1.0),
            ],
            16,
        );
        let length: f32 = path.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let mesh = tube(&path, 0.1, 48);
        let corner = |index: u32| mesh.vertices[index as usize].position;
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0)
            .sum();
        let expected = std::f32::consts::PI * 0.01 * length;
        assert!(
            (volume / expected - 1.0).abs() < 0.03,
            "{volume} of {expected}"
        );
    }
}
