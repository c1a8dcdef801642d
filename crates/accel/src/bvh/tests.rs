use std::sync::Arc;

use glam::{Vec2, Vec3};
use lie_geom::{Hit, RandomKey, Ray};
use lie_scene::{Geometry, MeshPart, Vertex};

use crate::{Accel, Bvh, Cutout, PACKET, RayPacket, packet::vector::on_each_unit};

/// A soup of small random triangles, with some degenerate, some large and some twice.
pub(crate) fn soup(count: u32, seed: u64) -> Geometry {
    let key = RandomKey::new(seed);
    let vector = |n: u32| {
        let xy = key.uniform2(2 * n);
        Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 2.0 - Vec3::ONE
    };
    let mut corners = vec![];
    for i in 0..count {
        let at = 5.0 * vector(4 * i);
        let size = if i % 50 == 7 { 6.0 } else { 0.4 };
        let triangle = match i % 97 {
            3 => [at, at, at + Vec3::X],
            5 if i > 5 => [corners[3 * 4], corners[3 * 4 + 1], corners[3 * 4 + 2]],
            _ => [1, 2, 3].map(|k| at + size * vector(4 * i + k)),
        };
        corners.extend(triangle);
    }
    geometry(&corners)
}

pub(crate) fn geometry(corners: &[Vec3]) -> Geometry {
    let vertices = corners
        .iter()
        .map(|&position| Vertex {
            position,
            normal: Vec3::ZERO,
            uv: Vec2::ZERO,
        })
        .collect();
    let count = corners.len() as u32 / 3;
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let part = MeshPart {
        name: "soup".into(),
        triangles: 0..count,
        material: 0,
    };
    Geometry::new(vertices, triangles, vec![part]).unwrap()
}

pub(crate) fn rays(count: u32, seed: u64) -> Vec<Ray> {
    let key = RandomKey::new(seed);
    let vector = |n: u32| {
        let xy = key.uniform2(2 * n);
        Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 2.0 - Vec3::ONE
    };
    (0..count)
        .map(|i| {
            let mut direction = vector(2 * i + 1);
            // Some along an axis, where a slab's inverse is infinite.
            if i % 7 == 0 {
                direction.x = 0.0;
            }
            if i % 14 == 0 {
                direction.y = -0.0;
            }
            let t_max = if i % 3 == 0 { 4.0 } else { f32::INFINITY };
            Ray {
                t_max,
                ..Ray::new(7.0 * vector(2 * i), direction)
            }
        })
        .collect()
}

/// The oracle: every triangle, one after the other.
pub(crate) fn brute_force(
    geometry: &Geometry,
    ray: &Ray,
    cutout: Option<&dyn Cutout>,
) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for triangle in 0..geometry.len() as u32 {
        let Some(hit) = geometry.triangle(triangle).intersect(ray) else {
            continue;
        };
        let solid = cutout.is_none_or(|cutout| {
            !cutout.has_holes(triangle) || cutout.is_solid(triangle, hit.u, hit.v)
        });
        if solid && best.is_none_or(|best| hit.t < best.t) {
            best = Some(Hit {
                t: hit.t,
                u: hit.u,
                v: hit.v,
                triangle,
            });
        }
    }
    best
}

fn check(geometry: &Geometry, cutout: Option<Arc<dyn Cutout>>, rays: &[Ray]) {
    let bvh = Bvh::build(geometry, cutout.clone());
    on_each_unit(|| check_rays(&bvh, geometry, cutout.as_deref(), rays));
}

fn check_rays(bvh: &Bvh, geometry: &Geometry, cutout: Option<&dyn Cutout>, rays: &[Ray]) {
    let mut hits = 0;
    for packet in rays.chunks(PACKET) {
        let together = RayPacket::new(packet);
        let closest = bvh.closest_packet(&together);
        let blocked = bvh.blocked_packet(&together);
        let blockers = bvh.blocker_packet(&together);
        for (lane, ray) in packet.iter().enumerate() {
            let expected = brute_force(geometry, ray, cutout);
            assert_eq!(bvh.closest(ray), expected, "{ray:?}");
            assert_eq!(closest[lane], expected, "packet lane {lane}: {ray:?}");
            assert_eq!(blocked >> lane & 1 == 1, expected.is_some());
            for blocker in [bvh.blocker(ray), blockers[lane]] {
                assert_eq!(blocker.is_some(), expected.is_some());
                if let Some(blocker) = blocker {
                    let triangle = geometry.triangle(blocker);
                    assert!(triangle.intersect(ray).is_some());
                    assert_eq!(together.blocked_by(triangle) >> lane & 1, 1);
                }
            }
            hits += usize::from(expected.is_some());
        }
    }
    assert!(
        geometry.is_empty() || hits > rays.len() / 10,
        "the test must hit something: {hits}"
    );
}

#[test]
fn every_kernel_agrees_with_brute_force() {
    for (count, seed) in [(0, 1), (1, 2), (2, 3), (9, 4), (300, 5), (3000, 6)] {
        let geometry = soup(count, seed);
        let rays = rays(if count < 100 { 4 } else { 500 }, seed + 100);
        if count < 100 {
            // Aimed, since random rays would miss.
            let aimed: Vec<Ray> = (0..count)
                .map(|i| geometry.triangle(i))
                .map(|triangle| (triangle.a + triangle.b + triangle.c) / 3.0)
                .zip(rays.iter().cycle())
                .map(|(target, ray)| Ray::new(ray.origin, target - ray.origin))
                .collect();
            check(&geometry, None, &aimed);
        } else {
            check(&geometry, None, &rays);
        }
    }
}

pub(crate) struct Half;

impl Cutout for Half {
    fn has_holes(&self, triangle: u32) -> bool {
        triangle.is_multiple_of(2)
    }
    fn is_solid(&self, _: u32, u: f32, _: f32) -> bool {
        u > 0.4
    }
}

#[test]
fn holes_let_rays_through_in_every_kernel() {
    check(&soup(2000, 8), Some(Arc::new(Half)), &rays(400, 9));
}

#[test]
fn of_coincident_triangles_the_first_is_hit() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let many: Vec<Vec3> = (0..40).flat_map(|_| corners).collect();
    let bvh = Bvh::build(&geometry(&many), None);
    let ray = Ray::new(Vec3::new(0.3, 0.3, 1.0), Vec3::NEG_Z);
    assert_eq!(bvh.closest(&ray).unwrap().triangle, 0);
    assert_eq!(
        bvh.closest_packet(&RayPacket::new(&[ray; 3]))[2]
            .unwrap()
            .triangle,
        0
    );
}

#[test]
fn rays_that_are_not_rays_hit_nothing() {
    let bvh = Bvh::build(&soup(500, 11), None);
    let nan = Vec3::splat(f32::NAN);
    for (origin, direction) in [(nan, Vec3::X), (Vec3::ZERO, nan), (Vec3::ZERO, Vec3::ZERO)] {
        let ray = Ray::new(origin, direction);
        assert_eq!(bvh.closest(&ray), None);
        assert_eq!(bvh.blocker(&ray), None);
        assert_eq!(bvh.closest_packet(&RayPacket::new(&[ray])), [None; PACKET]);
        assert_eq!(bvh.blocked_packet(&RayPacket::new(&[ray])), 0);
    }
}

#[test]
fn two_builds_give_the_same_blockers() {
    let geometry = soup(20_000, 12);
    let (one, two) = (Bvh::build(&geometry, None), Bvh::build(&geometry, None));
    for ray in rays(2000, 13) {
        assert_eq!(one.blocker(&ray), two.blocker(&ray));
    }
}

#[test]
fn a_packet_asks_one_triangle_as_its_rays_would() {
    let geometry = soup(40, 8);
    let rays = rays(64, 9);
    for packet in rays.chunks(PACKET - 3) {
        let together = RayPacket::new(packet);
        for triangle in (0..40).map(|index| geometry.triangle(index)) {
            let mut expected = 0;
            for (lane, ray) in packet.iter().enumerate() {
                expected |= u32::from(triangle.intersect(ray).is_some()) << lane;
            }
            assert_eq!(together.blocked_by(triangle), expected);
        }
    }
}

#[test]
fn a_ray_within_a_face_of_the_bounds_misses_nothing() {
    // A room's walls lie in the faces of its bounds, and so do rays along them.
    let side = |axis: usize, at: f32| {
        let corner = |u: f32, v: f32| {
            let mut point = Vec3::splat(at);
            point[(axis + 1) % 3] = u;
            point[(axis + 2) % 3] = v;
            point
        };
        let quad = [
            corner(0.0, 0.0),
            corner(2.75, 0.0),
            corner(2.75, 2.75),
            corner(0.0, 2.75),
        ];
        [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    };
    let walls = (0..3).flat_map(|axis| [0.0, 2.75].map(|at| side(axis, at)));
    let geometry = geometry(&walls.flatten().flatten().collect::<Vec<_>>());
    let bvh = Bvh::build(&geometry, None);
    for axis in 0..3 {
        for (a, b) in [
            (0.0, 1.0),
            (2.75, 1.0),
            (1.0, 0.0),
            (1.0, 2.75),
            (0.0, 2.75),
        ] {
            let mut origin = Vec3::splat(1.1);
            origin[(axis + 1) % 3] = a;
            origin[(axis + 2) % 3] = b;
            for direction in [Vec3::AXES[axis], -Vec3::AXES[axis]] {
                let ray = Ray::new(origin, direction);
                let expected = brute_force(&geometry, &ray, None);
                assert!(expected.is_some());
                assert_eq!(bvh.closest(&ray), expected, "{ray:?}");
                let packet = RayPacket::new(&[ray]);
                assert_eq!(bvh.closest_packet(&packet)[0], expected, "{ray:?}");
                assert_eq!(bvh.blocked_packet(&packet), 1, "{ray:?}");
            }
        }
    }
}

#[test]
fn fans_of_rays_agree_with_brute_force() {
    let geometry = soup(2000, 21);
    let bvh = Bvh::build(&geometry, None);
    let key = RandomKey::new(22);
    let vector = |n: u32| {
        let xy = key.uniform2(2 * n);
        Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 2.0 - Vec3::ONE
    };
    on_each_unit(|| {
        let mut blocked = 0;
        for fan in 0..150 {
            let apex = 7.0 * vector(40 * fan);
            // Close together, or all around: then they do not go one way.
            let spread = if fan % 2 == 0 { 0.3 } else { 9.0 };
            let target = 5.0 * vector(40 * fan + 1);
            let end = |lane: u32| target + spread * vector(40 * fan + 2 + lane);
            let mut ends = [[0.0; PACKET]; 3];
            for lane in 0..PACKET {
                for axis in 0..3 {
                    ends[axis][lane] = end(lane as u32)[axis];
                }
            }
            let lanes = 0xffff >> (fan % 5);
            let packet = RayPacket::fan(apex.to_array(), &ends, lanes);
            let hits = bvh.closest_packet(&packet);
            let expected: [Option<Hit>; PACKET] = std::array::from_fn(|lane| {
                let ray = Ray::segment_from(apex, end(lane as u32));
                let is_active = lanes >> lane & 1 == 1;
                brute_force(&geometry, &ray, None).filter(|_| is_active)
            });
            assert_eq!(hits, expected, "fan {fan}");
            for (lane, hit) in hits.iter().enumerate() {
                assert_eq!(bvh.blocked_packet(&packet) >> lane & 1 == 1, hit.is_some());
                blocked += u32::from(hit.is_some());
            }
        }
        assert!(blocked > 100, "{blocked}");
    });
}

#[test]
fn enormous_and_tiny_triangles_are_hit_as_brute_force_hits_them() {
    for scale in [1.0e-39, 1.0e-20, 1.0e9, 1.0e18, 3.0e37] {
        let small = soup(400, 31);
        let corners: Vec<Vec3> = small
            .shapes()
            .iter()
            .flat_map(|shape| [shape.a, shape.b, shape.c])
            .map(|corner| corner * scale)
            .collect();
        let geometry = geometry(&corners);
        let bvh = Bvh::build(&geometry, None);
        let scaled = |ray: &Ray| Ray {
            origin: ray.origin * scale,
            ..*ray
        };
        let rays: Vec<Ray> = rays(150, 32).iter().map(scaled).collect();
        on_each_unit(|| {
            for packet in rays.chunks(PACKET) {
                let closest = bvh.closest_packet(&RayPacket::new(packet));
                for (lane, ray) in packet.iter().enumerate() {
                    let expected = brute_force(&geometry, ray, None);
                    assert_eq!(bvh.closest(ray), expected, "times {scale}: {ray:?}");
                    assert_eq!(closest[lane], expected, "times {scale}: {ray:?}");
                }
            }
        });
    }
}

#[test]
fn rays_through_vertices_and_along_edges_are_the_scalar_tests() {
    let geometry = soup(300, 41);
    let bvh = Bvh::build(&geometry, None);
    let mut rays = vec![];
    for shape in geometry.shapes().iter().take(60) {
        rays.push(Ray::new(shape.a + Vec3::Z, Vec3::NEG_Z));
        rays.push(Ray::new(shape.b - Vec3::X * 3.0, Vec3::X));
        rays.push(Ray::new(shape.a - (shape.b - shape.a), shape.b - shape.a));
        rays.push(Ray::new(shape.c, shape.a - shape.c));
    }
    on_each_unit(|| {
        for packet in rays.chunks(PACKET) {
            let closest = bvh.closest_packet(&RayPacket::new(packet));
            for (lane, ray) in packet.iter().enumerate() {
                let expected = brute_force(&geometry, ray, None);
                assert_eq!((bvh.closest(ray), closest[lane]), (expected, expected));
            }
        }
    });
}

/// Long triangles among many small ones: what obvhs cuts to pieces.
fn slivers() -> Geometry {
    let small = soup(2000, 41);
    let mut corners: Vec<Vec3> = small
        .shapes()
        .iter()
        .filter(|shape| (shape.b - shape.a).length() < 2.0)
        .flat_map(|shape| [shape.a, shape.b, shape.c])
        .collect();
    let key = RandomKey::new(43);
    for i in 0..20 {
        let at = |n: u32| 6.0 * (2.0 * key.uniform(8 * i + n) - 1.0);
        let (from, along) = (Vec3::new(-6.0, at(0), at(1)), Vec3::new(12.0, at(2), at(3)));
        corners.extend([from, from + along, from + 0.5 * along + 0.3 * Vec3::Y]);
    }
    geometry(&corners)
}

#[test]
fn no_ray_runs_between_the_pieces_of_a_triangle() {
    /// obvhs cuts at twelfths of a box, and pieces again.
    const CUTS: u32 = 144;
    let geometry = slivers();
    let bvh = Bvh::build(&geometry, None);
    let stats = bvh.stats();
    assert!(stats.triangles > geometry.len() + 40, "{stats:?}");
    let long = geometry.shapes().iter().rev().take(20);
    let mut rays = vec![];
    for (shape, i) in long.zip(0..) {
        for cut in 1..CUTS {
            // A place on the triangle, and a way there within the plane of a cut.
            let key = RandomKey::new(100 + i).mix(u64::from(cut));
            let x = -6.0 + 12.0 * cut as f32 / CUTS as f32;
            let along = (x - shape.a.x) / (shape.b.x - shape.a.x);
            let inside = 0.2 * key.uniform(0) * Vec3::Y * along.min(1.0 - along);
            let place = (shape.a + along * (shape.b - shape.a) + inside).with_x(x);
            let way = Vec3::new(0.0, key.uniform(1) - 0.5, key.uniform(2) - 0.5);
            rays.push(Ray::new(place - 20.0 * way, way));
            rays.push(Ray::new(place - 20.0 * way, way + 1.0e-7 * Vec3::X));
        }
    }
    on_each_unit(|| check_rays(&bvh, &geometry, None, &rays));
}
