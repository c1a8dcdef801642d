//! Round things.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::mesh::Mesh;
use crate::Vertex;

/// Cosine of the angle between neighbouring pieces of a profile below which their edge is sharp.
const SHARP: f32 = 0.75;

/// The surface that a profile of (radius, height) makes as it turns about the y axis. The
/// front is on the right of the profile's way: outside for one that rises.
pub(super) fn lathe(profile: &[Vec2], segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let along = |index: usize| (profile[index + 1] - profile[index]).normalize_or_zero();
    let pieces = profile.len().saturating_sub(1);
    for piece in 0..pieces {
        let own = along(piece);
        let smooth = |neighbour: Option<usize>| match neighbour.map(along) {
            Some(other) if other.dot(own) > SHARP => (own + other).normalize_or(own),
            _ => own,
        };
        let tangents = [
            smooth(piece.checked_sub(1)),
            smooth((piece + 1 < pieces).then_some(piece + 1)),
        ];
        let first = mesh.vertices.len() as u32;
        for segment in 0..=segments {
            let turn = segment as f32 / segments as f32;
            let (sin, cos) = (turn * TAU).sin_cos();
            for (end, tangent) in tangents.into_iter().enumerate() {
                let point = profile[piece + end];
                let outward = Vec2::new(tangent.y, -tangent.x);
                mesh.vertices.push(Vertex {
                    position: Vec3::new(point.x * cos, point.y, -point.x * sin),
                    normal: Vec3::new(outward.x * cos, outward.y, -outward.x * sin)
                        .normalize_or_zero(),
                    uv: Vec2::new(turn, point.y),
                });
            }
        }
        for segment in 0..segments {
            let a = first + 2 * segment;
            mesh.triangles.push([a, a + 2, a + 3]);
            mesh.triangles.push([a, a + 3, a + 1]);
        }
    }
    mesh
}

/// A surface over the unit square, `counts` cells wide and high, with smooth normals; the
/// front is along ∂u × ∂v.
pub(super) fn parametric(counts: [u32; 2], surface: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let step = 1.0e-3;
    for row in 0..=counts[1] {
        for column in 0..=counts[0] {
            let (u, v) = (
                column as f32 / counts[0] as f32,
                row as f32 / counts[1] as f32,
            );
            let du = surface(u + step, v) - surface(u - step, v);
            let dv = surface(u, v + step) - surface(u, v - step);
            mesh.vertices.push(Vertex {
                position: surface(u, v),
                normal: du.cross(dv).normalize_or_zero(),
                uv: Vec2::new(u, v),
            });
        }
    }
    for row in 0..counts[1] {
        for column in 0..counts[0] {
            let a = row * (counts[0] + 1) + column;
            let b = a + counts[0] + 1;
            mesh.triangles.push([a, a + 1, b + 1]);
            mesh.triangles.push([a, b + 1, b]);
        }
    }
    mesh
}

/// The solid that a closed, convex profile makes on its way through `place`, from 0 to 1. The
/// profile is counter-clockwise for one who looks along the way; its edges stay sharp, the
/// way is smooth, and both ends are closed.
pub(super) fn sweep(profile: &[Vec2], steps: u32, place: impl Fn(f32, Vec2) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let step = 1.0e-3;
    let mut push = |position: Vec3, normal: Vec3, uv: Vec2| {
        mesh.vertices.push(Vertex {
            position,
            normal,
            uv,
        });
    };
    for (index, &from) in profile.iter().enumerate() {
        let to = profile[(index + 1) % profile.len()];
        for t in (0..=steps).map(|index| index as f32 / steps as f32) {
            let along = place(t + step, from) - place(t - step, from);
            let normal = along
                .cross(place(t, to) - place(t, from))
                .normalize_or_zero();
            push(place(t, from), normal, Vec2::new(t, 0.0));
            push(place(t, to), normal, Vec2::new(t, 1.0));
        }
    }
    for t in [0.0, 1.0] {
        for &point in profile {
            push(place(t, point), Vec3::ZERO, point);
        }
    }
    let (edges, row) = (profile.len() as u32, 2 * (steps + 1));
    for a in (0..edges).flat_map(|edge| (0..steps).map(move |s| edge * row + 2 * s)) {
        mesh.triangles.push([a, a + 2, a + 3]);
        mesh.triangles.push([a, a + 3, a + 1]);
    }
    let (start, end) = (edges * row, edges * (row + 1));
    for point in 1..edges.saturating_sub(1) {
        mesh.triangles
            .push([start, start + point, start + point + 1]);
        mesh.triangles.push([end, end + point + 1, end + point]);
    }
    mesh
}

/// A tube of a given radius about a closed curve over [0, 1].
pub(super) fn closed_tube(counts: [u32; 2], radius: f32, curve: impl Fn(f32) -> Vec3) -> Mesh {
    parametric(counts, |u, v| {
        let step = 1.0e-3;
        let tangent = (curve(u + step) - curve(u - step)).normalize_or(Vec3::X);
        // A frame that depends on the place alone, so that the tube closes.
        let outward = curve(u);
        let side = (outward - outward.dot(tangent) * tangent)
            .try_normalize()
            .unwrap_or_else(|| tangent.any_orthonormal_vector());
        let (sin, cos) = (v * TAU).sin_cos();
        curve(u) + radius * (cos * side + sin * side.cross(tangent))
    })
}

/// A knot that winds `p` times round a torus and `q` times through it, about the origin.
pub(super) fn torus_knot(p: f32, q: f32, size: f32, radius: f32, counts: [u32; 2]) -> Mesh {
    closed_tube(counts, radius, |t| {
        let around = t * TAU;
        let ring = 1.0 + 0.42 * (q * around).cos();
        size * Vec3::new(
            ring * (p * around).cos(),
            0.42 * (q * around).sin(),
            ring * (p * around).sin(),
        )
    })
}

/// A horizontal ring about the origin.
pub(super) fn torus(ring: f32, tube: f32, counts: [u32; 2]) -> Mesh {
    parametric(counts, |u, v| {
        let (sin_u, cos_u) = (u * TAU).sin_cos();
        let (sin_v, cos_v) = (v * TAU).sin_cos();
        let reach = ring + tube * cos_v;
        Vec3::new(reach * cos_u, tube * sin_v, -reach * sin_u)
    })
}

/// A ball about the origin.
pub(super) fn sphere(radius: f32, segments: u32) -> Mesh {
    let rings = (segments / 2).max(2);
    let profile: Vec<Vec2> = (0..=rings)
        .map(|ring| {
            let angle = (ring as f32 / rings as f32 - 0.5) * std::f32::consts::PI;
            radius * Vec2::new(angle.cos().max(0.0), angle.sin())
        })
        .collect();
    lathe(&profile, segments)
}

/// A closed cylinder from one point to another.
pub(super) fn rod(from: Vec3, to: Vec3, radius: f32, segments: u32) -> Mesh {
    let length = (to - from).length();
    let profile = [
        Vec2::ZERO,
        Vec2::new(radius, 0.0),
        Vec2::new(radius, length),
        Vec2::new(0.0, length),
    ];
    let upright = lathe(&profile, segments);
    let turn = Quat::from_rotation_arc(Vec3::Y, (to - from).normalize_or(Vec3::Y));
    let mut mesh = Mesh::default();
    mesh.add(&upright, turn, from);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem: positive if closed and facing outwards.
    fn volume(mesh: &Mesh) -> f32 {
        let corner = |index: u32| mesh.vertices[index as usize].position;
        let of = |t: &[u32; 3]| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0;
        mesh.triangles.iter().map(of).sum()
    }

    fn check(mesh: &Mesh, expected: f32) {
        assert!(
            (volume(mesh) / expected - 1.0).abs() < 0.02,
            "{} of {expected}",
            volume(mesh)
        );
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|index| mesh.vertices[index as usize]);
            let face = (b.position - a.position).cross(c.position - a.position);
            let mean = a.normal + b.normal + c.normal;
            assert!(
                face.length() < 1.0e-6 || face.dot(mean) > 0.0,
                "a normal looks inwards"
            );
        }
    }

    #[test]
    fn round_things_are_closed_and_face_outwards() {
        use std::f32::consts::PI;
        check(&sphere(2.0, 96), 4.0 / 3.0 * PI * 8.0);
        check(
            &rod(Vec3::ONE, Vec3::new(1.0, 2.0, 4.0), 0.5, 96),
            PI * 0.25 * 10f32.sqrt(),
        );
        check(&torus(2.0, 0.5, [96, 48]), 2.0 * PI * PI * 2.0 * 0.25);
        // A half ring of square section, from +x over +y to −x.
        let square = [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]].map(Vec2::from);
        let half_ring = sweep(&square, 48, |t, p| {
            let (sin, cos) = (PI * t).sin_cos();
            Vec3::new((2.0 + p.y) * cos, (2.0 + p.y) * sin, p.x)
        });
        assert!((volume(&half_ring) / (2.0 * PI) - 1.0).abs() < 0.02);
        let ring = closed_tube([96, 48], 0.5, |t| {
            2.0 * Vec3::new((t * TAU).cos(), 0.0, (t * TAU).sin())
        });
        check(&ring, 2.0 * PI * PI * 2.0 * 0.25);
        assert!(volume(&torus_knot(2.0, 3.0, 1.0, 0.1, [128, 16])) > 0.0);
    }
}
