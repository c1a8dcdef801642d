//! Picture frames.

use glam::{Vec2, Vec3};

use super::mesh::Mesh;

/// Four mitred bars with a bevel. `axes` are right, up and out of the wall.
pub(super) fn frame(center: Vec3, axes: [Vec3; 3], half: Vec2) -> Mesh {
    // Distance outwards from the canvas's edge, and height over the wall.
    const PROFILE: [[f32; 2]; 6] = [
        [-0.005, 0.03],
        [0.0, 0.05],
        [0.035, 0.045],
        [0.06, 0.075],
        [0.085, 0.07],
        [0.09, 0.0],
    ];
    let [right, up, out] = axes;
    let corner = |index: usize, point: [f32; 2]| {
        let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][index % 4];
        center + x * (half.x + point[0]) * right + y * (half.y + point[0]) * up + point[1] * out
    };
    let mut mesh = Mesh::default();
    for bar in 0..4 {
        for pair in PROFILE.windows(2) {
            mesh.quadrangle([
                corner(bar, pair[1]),
                corner(bar + 1, pair[1]),
                corner(bar + 1, pair[0]),
                corner(bar, pair[0]),
            ]);
        }
    }
    mesh
}
