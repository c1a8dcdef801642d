//! What nobody should ask of the kernels, and somebody will: every kind of odd ray through every
//! kind of odd scene, by every kernel, on each vector unit, against one triangle after the other.

mod lists;
mod rays;
mod scenes;

use lie_geom::{Hit, Ray};
use lie_scene::Geometry;

use self::{rays::odd_rays, scenes::odd_scenes};
use crate::{
    Accel, AccelKind, PACKET, RayPacket, bvh::tests::brute_force, vector_unit::on_each_unit,
};

/// The oracle. A ray that is not defined hits nothing, whatever arithmetic makes of it.
fn expected(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    brute_force(geometry, ray, None).filter(|_| ray.is_defined())
}

/// Whether two answers are the same, bit by bit. Weights of a triangle that is too small or too large
/// for its numbers may be undefined, in both.
fn is_same(one: Option<Hit>, other: Option<Hit>) -> bool {
    let same = |a: f32, b: f32| a == b || (a.is_nan() && b.is_nan());
    match (one, other) {
        (Some(one), Some(other)) => {
            let is_same_triangle = (one.t, one.triangle) == (other.t, other.triangle);
            is_same_triangle && same(one.u, other.u) && same(one.v, other.v)
        }
        _ => one.is_none() && other.is_none(),
    }
}

/// Whether two hits are as near as rounding tells: boxes are passed over by a distance that is
/// rounded otherwise than a triangle's.
fn is_as_near([one, other]: [Option<Hit>; 2]) -> bool {
    let apart = |(one, other): (Hit, Hit)| (one.t - other.t).abs() / other.t;
    one.zip(other).is_some_and(|hits| apart(hits) < 1.0e-6)
}

/// Whether some triangle that was hit lies in the plane of a ray, but for rounding: at what distance it
/// is hit, and whether at all, then means nothing, and a grid may differ.
fn is_in_a_plane(geometry: &Geometry, ray: &Ray, hits: [Option<Hit>; 2]) -> bool {
    let direction = ray.direction.as_dvec3().normalize_or_zero();
    hits.into_iter().flatten().any(|hit| {
        let normal = geometry.triangle(hit.triangle).normal.as_dvec3();
        normal.dot(direction).abs() < 1.0e-5
    })
}

/// All answers of a structure about some rays, together and one by one.
fn check(name: &str, accel: &dyn Accel, geometry: &Geometry, rays: &[Ray], is_grid: bool) {
    let mut differing = 0;
    for packet in rays.chunks(PACKET) {
        let together = RayPacket::new(packet);
        let closest = accel.closest_packet(&together);
        let blocked = accel.blocked_packet(&together);
        let blockers = accel.blocker_packet(&together);
        for (lane, ray) in packet.iter().enumerate() {
            let says = |what: &str| format!("{name}: {what}, lane {lane}, {ray:?}");
            let wanted = expected(geometry, ray);
            let mut is_lost = false;
            for (what, hit) in [("closest", accel.closest(ray)), ("packet", closest[lane])] {
                if !is_same(hit, wanted) {
                    let hits = [hit, wanted];
                    is_lost |= is_grid && is_in_a_plane(geometry, ray, hits);
                    let is_excused = is_lost || is_as_near(hits);
                    assert!(is_excused, "{}: {hit:?}, not {wanted:?}", says(what));
                    differing += 1;
                }
            }
            if is_lost {
                continue;
            }
            let is_blocked = wanted.is_some();
            assert_eq!(blocked >> lane & 1 == 1, is_blocked, "{}", says("blocked"));
            for blocker in [accel.blocker(ray), blockers[lane]] {
                assert_eq!(blocker.is_some(), is_blocked, "{}", says("blocker"));
                let blocks = |triangle: u32| geometry.triangle(triangle).intersect(ray).is_some();
                assert!(blocker.is_none_or(blocks), "{}", says("blocker"));
            }
        }
        for (lane, closest) in closest.iter().enumerate().skip(packet.len()) {
            assert_eq!((*closest, blocked >> lane & 1), (None, 0), "{name}: no ray");
        }
    }
    assert!(differing <= rays.len() / 8, "{name}: {differing} differ");
}

#[test]
fn odd_rays_through_odd_scenes_hit_what_each_triangle_says() {
    for (name, geometry) in odd_scenes() {
        let rays = odd_rays(&geometry);
        let hierarchy = AccelKind::Bvh.build(&geometry, None);
        on_each_unit(|| {
            check(
                &format!("{name}, bvh"),
                &*hierarchy,
                &geometry,
                &rays,
                false,
            )
        });
        // It has no vector code of its own.
        let grid = AccelKind::Grid.build(&geometry, None);
        check(&format!("{name}, grid"), &*grid, &geometry, &rays, true);
    }
}

#[test]
fn the_tests_meet_every_kind() {
    // Products of numbers that small or large are none.
    let beyond = ["denormal", "enormous"];
    let (mut hits, mut misses, mut undefined) = (0, 0, 0);
    for (name, geometry) in odd_scenes() {
        let rays = odd_rays(&geometry);
        let found = rays.iter().filter(|ray| expected(&geometry, ray).is_some());
        let found = found.count();
        let mut shapes = geometry.shapes().iter();
        let has_any = shapes.any(|shape| shape.normal.is_normalized()) && !beyond.contains(&name);
        assert_eq!(found > 0, has_any, "{name}: {found} hits");
        hits += found;
        misses += rays.len() - found;
        undefined += rays.iter().filter(|ray| !ray.is_defined()).count();
    }
    assert!(
        hits > 500 && misses > 500 && undefined > 100,
        "{hits}, {misses}, {undefined}"
    );
}
