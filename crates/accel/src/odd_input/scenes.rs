use glam::Vec3;
use lie_scene::Geometry;

use crate::bvh::tests::{geometry, soup};

/// Scenes of every awkward kind, with a name for each.
pub(super) fn odd_scenes() -> Vec<(&'static str, Geometry)> {
    let flat = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X];
    let sail = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let some = corners(&soup(120, 61));
    let times = |scale: f32| geometry(&some.iter().map(|&at| scale * at).collect::<Vec<_>>());
    // Among usual triangles some that are as small as numbers allow, or nearly as large: rays along an
    // axis lose what is further than 1e29 times their direction (`LARGEST_INVERSE`).
    let enormous = [1.0e15, 1.0e18, 1.0e25].map(|size| sail.map(|at| size * (at - 0.25)));
    let tiny = [1.0e-18, 1.0e-38, 1.0e-42].map(|size| sail.map(|at| size * at));
    let among = |others: &[[Vec3; 3]]| {
        let others = others.iter().flatten().copied();
        geometry(&some.iter().copied().chain(others).collect::<Vec<_>>())
    };
    vec![
        ("nothing", geometry(&[])),
        ("one without area", geometry(&flat)),
        (
            "many without area",
            geometry(&[flat, [Vec3::ONE; 3], flat].concat()),
        ),
        ("one", geometry(&sail)),
        ("one, twenty times", geometry(&[sail; 20].concat())),
        ("walls along the axes", geometry(&walls())),
        ("some", geometry(&some)),
        ("denormal", times(1.0e-40)),
        ("tiny", times(1.0e-12)),
        ("large", times(1.0e9)),
        ("enormous", times(1.0e37)),
        ("enormous ones among others", among(&enormous)),
        ("tiny ones among others", among(&tiny)),
        (
            "slivers among others",
            among(&[
                [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1.0e-7, 0.0)],
                [Vec3::ZERO, 1.0e6 * Vec3::X, Vec3::new(5.0e5, 1.0e-3, 0.0)],
            ]),
        ),
    ]
}

fn corners(geometry: &Geometry) -> Vec<Vec3> {
    let shapes = geometry.shapes().iter();
    shapes
        .flat_map(|shape| [shape.a, shape.b, shape.c])
        .collect()
}

/// The six sides of a cube, two triangles each.
fn walls() -> Vec<Vec3> {
    let mut corners = vec![];
    for axis in 0..3 {
        for side in [-2.0, 2.0] {
            let corner = |u: f32, v: f32| {
                let mut point = Vec3::splat(side);
                point[(axis + 1) % 3] = u;
                point[(axis + 2) % 3] = v;
                point
            };
            let [a, b, c, d] =
                [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(u, v)| corner(u, v));
            corners.extend([a, b, c, a, c, d]);
        }
    }
    corners
}
