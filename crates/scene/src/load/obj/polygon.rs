use glam::{DVec2, DVec3, Vec3};

/// Most corners of a polygon that ears are cut off; larger ones are cut as a fan, since
/// the time grows with the square.
const MAX_EARS: usize = 2048;

/// Cuts a polygon into triangles of corner numbers by cutting off ears, and says whether
/// that worked: a polygon that crosses itself (or has no area) is cut as a fan.
pub(super) fn triangulate(corners: &[Vec3]) -> (Vec<[usize; 3]>, bool) {
    let count = corners.len();
    let fan = || (2..count).map(|last| [0, last - 1, last]).collect();
    if count <= 3 {
        return (fan(), true);
    }
    if count > MAX_EARS {
        return (fan(), false);
    }
    let flat = flatten(corners);
    if is_convex(&flat) {
        return (fan(), true);
    }
    match cut_ears(&flat) {
        Some(triangles) => (triangles, true),
        None => (fan(), false),
    }
}

/// The corners in the plane across the polygon's normal (Newell's), counter-clockwise.
fn flatten(corners: &[Vec3]) -> Vec<DVec2> {
    let origin = corners[0].as_dvec3();
    let local: Vec<DVec3> = corners
        .iter()
        .map(|corner| corner.as_dvec3() - origin)
        .collect();
    let next = local.iter().cycle().skip(1);
    let normal: DVec3 = local.iter().zip(next).map(|(a, b)| a.cross(*b)).sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = normal.any_orthonormal_pair();
    local
        .iter()
        .map(|p| DVec2::new(p.dot(u), p.dot(v)))
        .collect()
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    let at = |index: usize| flat[index % count];
    // Seen from the first corner too: a star turns left everywhere, yet winds twice.
    (0..count).all(|i| turn(at(i), at(i + 1), at(i + 2)) >= 0.0)
        && (1..count - 1).all(|i| turn(flat[0], flat[i], flat[i + 1]) >= 0.0)
}

fn cut_ears(flat: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let mut ring: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    while ring.len() > 3 {
        let count = ring.len();
        let around = |i: usize| {
            [
                ring[(i + count - 1) % count],
                ring[i],
                ring[(i + 1) % count],
            ]
        };
        let ear = (0..count)
            .find(|&i| is_ear(flat, &ring, around(i), 0.0))
            // Corners in a line make no ear, yet have to go.
            .or_else(|| (0..count).find(|&i| is_flat(flat, around(i))))?;
        let triangle = around(ear);
        if !is_flat(flat, triangle) {
            triangles.push(triangle);
        }
        ring.remove(ear);
    }
    if turn(flat[ring[0]], flat[ring[1]], flat[ring[2]]) < 0.0 {
        return None;
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    Some(triangles)
}

fn is_flat(flat: &[DVec2], [a, b, c]: [usize; 3]) -> bool {
    turn(flat[a], flat[b], flat[c]) == 0.0
}

/// Whether the triangle turns left and holds no other corner of the ring.
fn is_ear(flat: &[DVec2], ring: &[usize], [a, b, c]: [usize; 3], least: f64) -> bool {
    let (pa, pb, pc) = (flat[a], flat[b], flat[c]);
    turn(pa, pb, pc) > least
        && ring.iter().all(|&other| {
            let p = flat[other];
            // Holes are joined by a bridge, whose corners come twice at the same place.
            p == pa
                || p == pb
                || p == pc
                || turn(pa, pb, p) < 0.0
                || turn(pb, pc, p) < 0.0
                || turn(pc, pa, p) < 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> f32 {
        let of = |&[a, b, c]: &[usize; 3]| {
            0.5 * (corners[b] - corners[a]).cross(corners[c] - corners[a]).z
        };
        // Every triangle has to face the polygon's way.
        assert!(triangles.iter().all(|triangle| of(triangle) >= 0.0));
        triangles.iter().map(of).sum()
    }

    fn polygon(points: &[(f32, f32)]) -> Vec<Vec3> {
        points.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        let arrow = polygon(&[(0.0, 0.0), (2.0, -2.0), (1.0, 0.0), (2.0, 2.0)]);
        let comb = polygon(&[
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 3.0),
            (4.0, 3.0),
            (4.0, 1.0),
            (3.0, 1.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ]);
        let ring = polygon(&[
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (3.0, 3.0),
            (3.0, 1.0),
            (1.0, 1.0),
        ]);
        for (corners, expected) in [(arrow, 2.0), (comb, 11.0), (ring, 12.0)] {
            for first in 0..corners.len() {
                let mut turned = corners.clone();
                turned.rotate_left(first);
                let (triangles, is_simple) = triangulate(&turned);
                assert!(is_simple);
                assert!((area(&turned, &triangles) - expected).abs() < 1.0e-4);
            }
        }
    }

    #[test]
    fn hopeless_polygons_end_as_a_fan() {
        let bow = polygon(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        assert_eq!(triangulate(&bow).0.len(), 2);
        let point = vec![Vec3::ONE; 5];
        assert_eq!(triangulate(&point).0.len(), 3);
        assert_eq!(
            triangulate(&vec![Vec3::X; MAX_EARS + 1]).0.len(),
            MAX_EARS - 1
        );
        assert!(triangulate(&[]).0.is_empty());
    }
}
