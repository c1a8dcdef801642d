use glam::Vec3;
use lie_geom::{RandomKey, Ray, Triangle};

use super::*;
use crate::{
    Accel, Bvh, MeshEdges,
    bvh::tests::{geometry, soup},
};

fn vector(key: RandomKey, n: u32) -> Vec3 {
    let xy = key.uniform2(2 * n);
    Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 2.0 - Vec3::ONE
}

/// A random box, flat along some axes now and then.
fn random_box(key: RandomKey, around: Vec3, size: f32) -> Aabb {
    let mut half = size * (vector(key, 0).abs() + 0.01);
    for axis in 0..3 {
        if key.uniform(100 + axis as u32) < 0.2 {
            half[axis] = 0.0;
        }
    }
    Aabb {
        min: around - half,
        max: around + half,
    }
}

/// A random place in a box, its corners and faces included.
fn place_in(bounds: Aabb, key: RandomKey, n: u32) -> Vec3 {
    let share = (1.4 * (0.5 * vector(key, n) + 0.5) - 0.2).clamp(Vec3::ZERO, Vec3::ONE);
    (bounds.min + share * (bounds.max - bounds.min)).clamp(bounds.min, bounds.max)
}

#[test]
fn whatever_blocks_a_segment_is_inside() {
    let geometry = soup(3000, 21);
    let bvh = Bvh::build(&geometry, None);
    let (mut blocking, mut listed) = (0, 0);
    for seed in 0..300 {
        let key = RandomKey::new(seed);
        let apex = 6.0 * vector(key.mix(1), 0);
        let ends = random_box(key.mix(2), 6.0 * vector(key.mix(1), 1), 0.5);
        let shaft = Shaft::new(apex, ends, bvh.bounds());
        let mut found = vec![];
        assert!(bvh.inside(&shaft, usize::MAX, &mut found));
        found.sort_unstable();
        assert!(found.is_sorted_by(|a, b| a < b), "one is named twice");
        listed += found.len();
        let may_hit = |&index: &u32| shaft.may_hit(&geometry.shapes()[index as usize]);
        assert!(found.iter().all(may_hit));
        for n in 0..40 {
            let ray = Ray::segment_from(apex, place_in(ends, key.mix(3), n));
            for (index, shape) in (0..).zip(geometry.shapes()) {
                if shape.intersect(&ray).is_some() {
                    blocking += 1;
                    assert!(found.binary_search(&index).is_ok(), "seed {seed}: {index}");
                }
            }
        }
        if found.len() > 1 {
            let mut some = vec![];
            assert!(!bvh.inside(&shaft, found.len() - 1, &mut some));
        }
    }
    assert!(blocking > 1000, "{blocking} blocked");
    // Of 900,000, it leaves out nearly all.
    assert!(listed < 40_000, "{listed} listed");
}

#[test]
fn whatever_blocks_a_segment_between_boxes_is_inside() {
    let geometry = soup(3000, 22);
    let bvh = Bvh::build(&geometry, None);
    let (mut blocking, mut listed) = (0, 0);
    for seed in 0..300 {
        let key = RandomKey::new(seed);
        let from = random_box(key.mix(1), 6.0 * vector(key.mix(2), 0), 0.6);
        let to = random_box(key.mix(3), 6.0 * vector(key.mix(2), 1), 0.4);
        let shaft = BoxShaft::new(from, to, bvh.bounds());
        let mut found = vec![];
        assert!(bvh.inside_boxes(&shaft, usize::MAX, &mut found));
        found.sort_unstable();
        assert!(found.is_sorted_by(|a, b| a < b), "one is named twice");
        listed += found.len();
        let may_hit = |&index: &u32| shaft.may_hit(&geometry.shapes()[index as usize]);
        assert!(found.iter().all(may_hit));
        for n in 0..40 {
            let target = place_in(to, key.mix(5), n);
            let ray = Ray::segment(place_in(from, key.mix(4), n), target);
            for (index, shape) in (0..).zip(geometry.shapes()) {
                if shape.intersect(&ray).is_some() {
                    blocking += 1;
                    assert!(found.binary_search(&index).is_ok(), "seed {seed}: {index}");
                }
            }
        }
        if found.len() > 1 {
            let mut some = vec![];
            assert!(!bvh.inside_boxes(&shaft, found.len() - 1, &mut some));
        }
    }
    assert!(blocking > 1000, "{blocking} blocked");
    assert!(listed < 90_000, "{listed} listed");
}

/// A bumpy wall in the plane `x = 0`, of two triangles to each of `n × n` squares.
fn wall(n: u32, key: RandomKey) -> Vec<Vec3> {
    let corner = |y: u32, z: u32| {
        let bump = 0.2 * key.uniform(y * (n + 1) + z);
        Vec3::new(bump, y as f32, z as f32) - Vec3::new(0.0, 0.5, 0.5) * n as f32
    };
    let squares = (0..n).flat_map(|y| (0..n).map(move |z| (y, z)));
    let triangles = squares.flat_map(|(y, z)| {
        let [a, b, c, d] = [
            corner(y, z),
            corner(y + 1, z),
            corner(y + 1, z + 1),
            corner(y, z + 1),
        ];
        [a, b, c, a, c, d]
    });
    triangles.collect()
}

/// Whether the triangle that blocks the middle is the start of a surface that covers all.
fn is_covered(shapes: &[Triangle], shaft: &Shaft, apex: Vec3, ends: Aabb) -> bool {
    let middle = Ray::segment_from(apex, ends.center());
    let start = shapes
        .iter()
        .position(|shape| shape.intersect(&middle).is_some());
    let edges = MeshEdges::new(shapes);
    start.is_some_and(|start| shaft.is_covered(start as u32, shapes, &edges, |_| true, 64))
}

#[test]
fn what_is_covered_lets_no_segment_through() {
    let (mut covered, mut open) = (0, 0);
    for seed in 0..600 {
        let key = RandomKey::new(seed);
        let mut corners = wall(8, key.mix(1));
        // Holes here and there.
        if seed % 3 == 0 {
            let hole = (key.uniform(5) * 128.0) as usize % 128;
            corners.drain(3 * hole..3 * hole + 3);
        }
        let shapes = geometry(&corners).shapes().to_vec();
        let apex = Vec3::new(-2.0, 0.0, 0.0) + Vec3::new(1.5, 3.0, 3.0) * vector(key.mix(2), 0);
        let around = Vec3::new(1.2, 0.0, 0.0) + Vec3::new(1.4, 3.5, 3.5) * vector(key.mix(2), 1);
        let ends = random_box(key.mix(3), around, 0.8);
        let shaft = Shaft::new(apex, ends, Aabb::around(corners.iter().copied()));
        let is_blocked = |n: u32| {
            let ray = Ray::segment_from(apex, place_in(ends, key.mix(4), n));
            shapes.iter().any(|shape| shape.intersect(&ray).is_some())
        };
        let all_blocked = (0..300).all(is_blocked);
        if is_covered(&shapes, &shaft, apex, ends) {
            covered += 1;
            assert!(all_blocked, "seed {seed}");
        } else {
            open += usize::from(!all_blocked);
        }
    }
    assert!(
        covered > 100 && open > 100,
        "{covered} covered, {open} open"
    );
}

/// From far away distances are coarse: a wall just before the ends may be met behind them.
#[test]
fn what_is_covered_is_so_for_rays_from_far_away() {
    let bumpy = wall(8, RandomKey::new(3));
    let corners: Vec<Vec3> = bumpy.iter().map(|at| at.with_x(0.0)).collect();
    let shapes = geometry(&corners).shapes().to_vec();
    let bounds = Aabb::around(corners.iter().copied());
    let (mut covered, mut missed) = (0, 0);
    for seed in 0..600 {
        let key = RandomKey::new(seed);
        let distance = 10f32.powf(2.0 + 4.0 * key.uniform(0));
        let apex = distance * Vec3::new(-1.0, 0.3, 0.2) * (1.0 + 0.1 * vector(key, 1));
        let height = 10f32.powf(-4.0 * key.uniform(9));
        let ends = random_box(key.mix(3), Vec3::X * height, 0.4 * height);
        let shaft = Shaft::new(apex, ends, bounds);
        let is_blocked = |n: u32| {
            let ray = Ray::segment_from(apex, place_in(ends, key.mix(4), n));
            shapes.iter().any(|shape| shape.intersect(&ray).is_some())
        };
        let all_blocked = (0..100).all(is_blocked);
        missed += usize::from(!all_blocked);
        if is_covered(&shapes, &shaft, apex, ends) {
            covered += 1;
            assert!(
                all_blocked,
                "seed {seed}: {distance} m away, {height} m behind"
            );
        }
    }
    assert!(
        covered > 100 && missed > 10,
        "{covered} covered, {missed} not blocked as the test rounds"
    );
}

#[test]
fn what_has_holes_or_touches_the_ends_proves_nothing() {
    let corners = wall(4, RandomKey::new(1));
    let shapes = geometry(&corners).shapes().to_vec();
    let edges = MeshEdges::new(&shapes);
    let apex = Vec3::new(-3.0, 0.1, 0.1);
    let bounds = Aabb::around(corners.iter().copied());
    let ends = |x: f32| Aabb {
        min: Vec3::new(x, -0.7, -0.7),
        max: Vec3::new(x + 1.0, 0.7, 0.7),
    };
    let proves = |ends: Aabb, is_solid: bool, limit: usize| {
        let middle = Ray::segment_from(apex, ends.center());
        let start = shapes
            .iter()
            .position(|shape| shape.intersect(&middle).is_some());
        let shaft = Shaft::new(apex, ends, bounds);
        shaft.is_covered(start.unwrap() as u32, &shapes, &edges, |_| is_solid, limit)
    };
    assert!(proves(ends(0.5), true, 64));
    assert!(!proves(ends(0.5), false, 64), "it may have holes");
    assert!(!proves(ends(0.5), true, 1), "it takes more than one");
    assert!(!proves(ends(-0.2), true, 64), "it runs through the ends");
}
