//! The shapes of area lights: from triangles, and moved.

use glam::{Mat3, Mat4, Vec3};

use crate::AreaShape;

/// The shape of an area light: two triangles that make a parallelogram become one, so that
/// it is sampled as one.
pub(crate) fn area_shape(triangles: Vec<[Vec3; 3]>) -> AreaShape {
    if let [first, second] = triangles[..]
        && let Some(rectangle) = parallelogram(first, second)
    {
        return rectangle;
    }
    AreaShape::Mesh { triangles }
}

/// The parallelogram that two triangles with a common edge make, with the front of `first`.
fn parallelogram(first: [Vec3; 3], second: [Vec3; 3]) -> Option<AreaShape> {
    let extent = (first[1] - first[0])
        .length()
        .max((first[2] - first[0]).length());
    let near = |p: Vec3, q: Vec3| (p - q).length() <= 1.0e-4 * extent;
    let shared = |p: &Vec3| second.iter().any(|&q| near(*p, q));
    let lone = first.iter().position(|p| !shared(p))?;
    let (corner, next, last) = (first[lone], first[(lone + 1) % 3], first[(lone + 2) % 3]);
    let far = second
        .into_iter()
        .find(|&q| !near(q, next) && !near(q, last))?;
    if !(shared(&next) && shared(&last) && near(corner + (next - corner) + (last - corner), far)) {
        return None;
    }
    let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).normalize_or_zero();
    (normal(first).dot(normal(second)) > 0.999).then_some(AreaShape::Rectangle {
        corner,
        edge_u: next - corner,
        edge_v: last - corner,
    })
}

/// A shape moved; one that mirrors keeps its front.
pub(crate) fn transform_shape(shape: &AreaShape, matrix: Mat4) -> AreaShape {
    let mirrored = Mat3::from_mat4(matrix).determinant() < 0.0;
    match shape {
        AreaShape::Rectangle {
            corner,
            edge_u,
            edge_v,
        } => {
            let (u, v) = (
                matrix.transform_vector3(*edge_u),
                matrix.transform_vector3(*edge_v),
            );
            let (edge_u, edge_v) = if mirrored { (v, u) } else { (u, v) };
            AreaShape::Rectangle {
                corner: matrix.transform_point3(*corner),
                edge_u,
                edge_v,
            }
        }
        AreaShape::Mesh { triangles } => AreaShape::Mesh {
            triangles: triangles
                .iter()
                .map(|corners| {
                    let [a, b, c] = corners.map(|p| matrix.transform_point3(p));
                    if mirrored { [a, c, b] } else { [a, b, c] }
                })
                .collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AreaLight;

    #[test]
    fn two_triangles_of_a_parallelogram_are_one_rectangle() {
        let (a, b, c, d) = (
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(1.5, 0.0, 2.0),
            Vec3::new(0.5, 0.0, 2.0),
        );
        for (first, second) in [
            ([a, b, c], [a, c, d]),
            ([c, d, b], [a, b, d]),
            ([d, a, b], [c, d, b]),
        ] {
            let light = AreaLight::new(area_shape(vec![first, second]), Vec3::ONE, false);
            let AreaShape::Rectangle { edge_u, edge_v, .. } = light.shape() else {
                panic!("{first:?} {second:?} is a parallelogram");
            };
            assert!((edge_u.cross(*edge_v).length() - 2.0).abs() < 1.0e-5);
            assert!(edge_u.cross(*edge_v).y < 0.0, "the winding's front");
            assert!((light.area() - 2.0).abs() < 1.0e-5);
        }
        let kite = area_shape(vec![[a, b, c], [a, c, d + 0.1 * Vec3::X]]);
        assert!(matches!(kite, AreaShape::Mesh { .. }));
        let back_to_back = area_shape(vec![[a, b, c], [a, d, c]]);
        assert!(matches!(back_to_back, AreaShape::Mesh { .. }));
    }
}
