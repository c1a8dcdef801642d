use glam::{Vec2, Vec3};
use lie_geom::{RandomKey, Triangle};
use proptest::prelude::*;

use super::*;
use crate::{
    Bvh,
    bvh::tests::{Half, brute_force, geometry, rays, soup},
};

/// All of a hit, with weights' bits.
fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| {
        [
            hit.triangle,
            hit.t.to_bits(),
            hit.u.to_bits(),
            hit.v.to_bits(),
        ]
    })
}

/// Whether a hit is on a triangle that the ray lies in the plane of, but for rounding: its
/// distance and weights then mean nothing, and it need not even be near the ray.
fn is_in_plane(geometry: &Geometry, ray: &Ray, hit: Option<Hit>) -> bool {
    hit.is_some_and(|hit| {
        let normal = geometry.triangle(hit.triangle).normal;
        normal.dot(ray.direction.normalize()).abs() < 1.0e-5
    })
}

/// Every answer of the grid for these rays, against the hierarchy's. The hierarchy loses a
/// hit where its boxes' arithmetic rounds the wrong way: a ray in the plane of a box's face,
/// a tie in a flat box. Where the two differ, brute force has the last word.
fn check(geometry: &Geometry, cutout: Option<Arc<dyn Cutout>>, rays: &[Ray]) -> usize {
    let bvh = Bvh::build(geometry, cutout.clone());
    let grid = TwoLevelGrid::build(geometry, cutout.clone());
    grid.check_invariants();
    let (mut hits, mut overruled) = (0, 0);
    for packet in rays.chunks(PACKET) {
        let together = RayPacket::new(packet);
        let (closest, blocked) = (
            grid.closest_packet(&together),
            grid.blocked_packet(&together),
        );
        for (lane, ray) in packet.iter().enumerate() {
            let found = grid.closest(ray);
            let mut expected = bvh.closest(ray);
            if bits(found) != bits(expected) {
                let judge = brute_force(geometry, ray, cutout.as_deref());
                if [found, expected, judge]
                    .into_iter()
                    .any(|hit| is_in_plane(geometry, ray, hit))
                {
                    continue;
                }
                expected = judge;
                overruled += 1;
            }
            assert_eq!(bits(found), bits(expected), "{ray:?}");
            assert_eq!(bits(closest[lane]), bits(expected), "lane {lane}: {ray:?}");
            assert_eq!(grid.is_blocked(ray), expected.is_some());
            assert_eq!(blocked >> lane & 1 == 1, expected.is_some());
            let blocker = grid.blocker(ray);
            assert_eq!(blocker.is_some(), expected.is_some());
            if let Some(id) = blocker {
                let hit = geometry.triangle(id).intersect(ray).expect("it blocks");
                let is_solid = cutout.as_ref().is_none_or(|cutout| {
                    !cutout.has_holes(id) || cutout.is_solid(id, hit.u, hit.v)
                });
                assert!(is_solid, "{id} has a hole there: {ray:?}");
            }
            hits += usize::from(expected.is_some());
        }
    }
    assert!(overruled <= rays.len() / 10, "{overruled}");
    hits
}

impl TwoLevelGrid {
    /// What the cells promise, and that every solid triangle is in some cell.
    fn check_invariants(&self) {
        let cells = &self.cells;
        let stats = self.stats();
        let mut is_there = vec![false; self.triangles.len()];
        for top in &cells.top {
            let count: usize = top.counts.iter().map(|&count| usize::from(count)).product();
            for cell in top.first as usize..top.first as usize + count {
                let ids = cells.of(cell);
                assert!(ids.is_sorted(), "{ids:?}");
                ids.iter().for_each(|&id| is_there[id as usize] = true);
            }
        }
        for (triangle, is_there) in self.triangles.iter().zip(is_there) {
            assert_eq!(triangle.normal.is_normalized(), is_there);
        }
        let count = self.triangles.len();
        assert!(stats.references <= 16 * count + 64, "{stats:?}");
        assert!(stats.cells <= 10 * count + 64, "{stats:?}");
    }
}

fn unit(key: RandomKey, index: u32) -> Vec3 {
    let xy = key.uniform2(2 * index);
    Vec3::new(xy.x, xy.y, key.uniform(2 * index + 1))
}

/// Rays of every awkward kind through a scene: from inside and outside, along axes, through
/// corners, along edges, from points on surfaces.
fn awkward(geometry: &Geometry, count: u32, seed: u64) -> Vec<Ray> {
    let key = RandomKey::new(seed);
    let bounds = geometry.bounds();
    let size = bounds.size();
    let size = size.max(Vec3::splat(1.0e-3 * size.max_element()));
    let place = |index, around: f32| {
        bounds.center() + around * size * (unit(key, index) - Vec3::splat(0.5))
    };
    (0..count)
        .map(|index| {
            let base = 8 * index;
            let id = (key.uniform(base + 1) * geometry.len() as f32) as u32;
            let triangle = geometry.triangle(id.min(geometry.len() as u32 - 1));
            let [inside, outside] = [place(base + 2, 1.0), place(base + 3, 3.0)];
            let axis = [Vec3::X, Vec3::NEG_Y, Vec3::Z][index as usize % 3];
            match index % 8 {
                0 => Ray::new(inside, place(base + 4, 1.0) - inside),
                1 => Ray::new(outside, inside - outside),
                2 => Ray::new(inside, axis),
                3 => Ray::new(outside, triangle.a - outside),
                4 => Ray::new(triangle.a - 3.0 * axis, axis),
                5 => Ray::new(outside, 0.5 * (triangle.a + triangle.b) - outside),
                6 => Ray::segment(inside, place(base + 5, 1.0)),
                _ => Ray::new(
                    triangle.a - (triangle.b - triangle.a),
                    triangle.b - triangle.a,
                ),
            }
        })
        .collect()
}

#[test]
fn soups_answer_like_the_hierarchy_and_like_brute_force() {
    for (count, seed) in [(1, 2), (2, 3), (9, 4), (300, 5), (3000, 6), (40_000, 7)] {
        let geometry = soup(count, seed);
        let mut rays = rays(1000, seed + 100);
        rays.extend(awkward(&geometry, 2000, seed + 200));
        let hits = check(&geometry, None, &rays);
        assert!(count < 300 || hits > rays.len() / 10, "{hits} hits");
        let grid = TwoLevelGrid::build(&geometry, None);
        for ray in rays.iter().step_by(37) {
            let expected = brute_force(&geometry, ray, None);
            let found = grid.closest(ray);
            if !is_in_plane(&geometry, ray, expected) && !is_in_plane(&geometry, ray, found) {
                assert_eq!(bits(found), bits(expected), "{ray:?}");
            }
        }
    }
}

#[test]
fn scenes_answer_like_the_hierarchy() {
    let rough = 0.2;
    let scenes = [
        lie_scene::cornell_box(),
        lie_scene::gallery(&lie_scene::Gallery {
            detail: rough,
            ..lie_scene::Gallery::default()
        }),
        lie_scene::bar(&lie_scene::Bar {
            detail: rough,
            ..lie_scene::Bar::default()
        }),
    ];
    for scene in &scenes {
        let mut rays = awkward(&scene.geometry, 20_000, 9);
        for camera in &scene.cameras {
            let size = glam::UVec2::new(40, 30);
            rays.extend((0..size.x * size.y).map(|index| {
                let film = Vec2::new((index % size.x) as f32, (index / size.x) as f32);
                camera.ray(film + 0.5, size)
            }));
        }
        let hits = check(&scene.geometry, None, &rays);
        assert!(hits > rays.len() / 3, "{}: {hits} hits", scene.name);
    }
}

#[test]
fn holes_let_rays_through() {
    let hits = check(&soup(2000, 8), Some(Arc::new(Half)), &rays(2000, 9));
    assert!(hits > 200, "{hits}");
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let edge = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X];
    for corners in [&[][..], &edge] {
        let grid = TwoLevelGrid::build(&geometry(corners), None);
        assert_eq!(grid.closest(&Ray::new(Vec3::Z, Vec3::NEG_Z)), None);
        assert_eq!(grid.stats().references, 0);
    }
    let grid = TwoLevelGrid::build(&soup(500, 11), None);
    let nan = Vec3::splat(f32::NAN);
    for (origin, direction) in [(nan, Vec3::X), (Vec3::ZERO, nan), (Vec3::ZERO, Vec3::ZERO)] {
        let ray = Ray::new(origin, direction);
        assert_eq!((grid.closest(&ray), grid.blocker(&ray)), (None, None));
        assert_eq!(grid.blocked_packet(&RayPacket::new(&[ray])), 0);
    }
    let backwards = Ray {
        t_max: -1.0,
        ..Ray::new(Vec3::ZERO, Vec3::X)
    };
    assert_eq!(grid.closest(&backwards), None);
}

#[test]
fn of_coincident_triangles_the_first_is_hit_and_memory_stays_bounded() {
    let corners = [Vec3::ZERO, 50.0 * Vec3::X, 50.0 * Vec3::Y];
    let many: Vec<Vec3> = (0..5000).flat_map(|_| corners).collect();
    let grid = TwoLevelGrid::build(&geometry(&many), None);
    grid.check_invariants();
    let ray = Ray::new(Vec3::new(10.0, 12.0, 1.0), Vec3::NEG_Z);
    assert_eq!(grid.closest(&ray).unwrap().triangle, 0);
    // Large ones all through each other, each of which meets most of the cells.
    let key = RandomKey::new(4);
    let large: Vec<Vec3> = (0..3 * 3000).map(|index| unit(key, index)).collect();
    check(&geometry(&large), None, &awkward(&geometry(&large), 500, 3));
}

#[test]
fn flat_enormous_tiny_and_far_away_scenes_answer_like_the_hierarchy() {
    for (scale, shift) in [
        (Vec3::new(1.0, 1.0, 0.0), Vec3::ZERO),
        (Vec3::new(0.0, 1.0, 1.0), Vec3::ONE),
        (Vec3::new(1.0, 0.0, 1.0), Vec3::Y),
        (Vec3::splat(1.0e9), Vec3::ZERO),
        (Vec3::splat(1.0e-9), Vec3::ZERO),
        (Vec3::ONE, Vec3::splat(1.0e4)),
        (Vec3::new(1.0e3, 1.0e-3, 1.0), Vec3::ZERO),
    ] {
        let soup = soup(1500, 17);
        let moved: Vec<Vec3> = (0..soup.len() as u32)
            .map(|id| soup.triangle(id))
            .flat_map(|Triangle { a, b, c, .. }| [a, b, c])
            .map(|corner| scale * corner + shift)
            .collect();
        let moved = geometry(&moved);
        let grid = TwoLevelGrid::build(&moved, None);
        grid.check_invariants();
        let mut rays = awkward(&moved, 2000, 18);
        // Across the thin side too.
        rays.extend((0..500).map(|index| {
            let triangle = moved.triangle(index);
            let middle = (triangle.a + triangle.b + triangle.c) / 3.0;
            let away = triangle.normal * moved.bounds().size().max_element();
            Ray::new(middle + away, -away)
        }));
        check(&moved, None, &rays);
    }
}

#[test]
fn two_builds_are_the_same() {
    let geometry = soup(20_000, 12);
    let [one, two] = [(); 2].map(|()| TwoLevelGrid::build(&geometry, None));
    assert_eq!(one.cells.ids, two.cells.ids);
    assert_eq!(one.cells.starts, two.cells.starts);
}

/// Corners on a coarse raster: edges, planes and cells' borders fall together.
fn raster() -> impl Strategy<Value = Vec3> {
    [-4i8..=4, -4i8..=4, -4i8..=4].prop_map(|place| Vec3::from(place.map(f32::from)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_triangles_answer_like_brute_force(
        corners in proptest::collection::vec(raster(), 3..90),
        places in proptest::collection::vec((raster(), raster()), 1..40),
    ) {
        let geometry = geometry(&corners[..corners.len() / 3 * 3]);
        let grid = TwoLevelGrid::build(&geometry, None);
        grid.check_invariants();
        for (origin, target) in places {
            for ray in [Ray::new(2.0 * origin, target - origin), Ray::segment(origin, target)] {
                let expected = brute_force(&geometry, &ray, None);
                let found = grid.closest(&ray);
                if !is_in_plane(&geometry, &ray, expected) && !is_in_plane(&geometry, &ray, found) {
                    prop_assert_eq!(bits(found), bits(expected));
                    prop_assert_eq!(grid.is_blocked(&ray), expected.is_some());
                }
            }
        }
    }
}
