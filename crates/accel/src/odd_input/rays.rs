use glam::Vec3;
use lie_geom::{RandomKey, Ray};
use lie_scene::Geometry;

/// Rays of every awkward kind through a scene, in an order in which packets have some of each.
pub(super) fn odd_rays(geometry: &Geometry) -> Vec<Ray> {
    let mut rays = numbers(geometry);
    rays.extend(axes(geometry));
    rays.extend(corners(geometry));
    rays.extend(intervals(geometry));
    let key = RandomKey::new(71);
    let mut keyed: Vec<(f32, Ray)> = (0..).map(|at| key.uniform(at)).zip(rays).collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
    keyed.into_iter().map(|(_, ray)| ray).collect()
}

/// Somewhere around the scene, however large it is.
fn around(geometry: &Geometry, index: u32) -> Vec3 {
    let key = RandomKey::new(72).mix(u64::from(index));
    let place = Vec3::new(key.uniform(0), key.uniform(1), key.uniform(2)) - 0.5;
    let bounds = geometry.bounds();
    bounds.center() + 1.5 * place * bounds.size()
}

/// Numbers that are none, or that are as large or small as there are, in every place.
fn numbers(geometry: &Geometry) -> Vec<Ray> {
    let odd = [
        f32::NAN,
        -f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN_POSITIVE,
        1.0e-42,
        0.0,
        -0.0,
    ];
    let mut rays = vec![];
    for (index, number) in (0..).zip(odd) {
        let (origin, target) = (around(geometry, index), around(geometry, 100 + index));
        let ray = Ray::new(origin, target - origin);
        for axis in 0..3 {
            let mut moved = ray;
            moved.origin[axis] = number;
            rays.push(moved);
            let mut turned = ray;
            turned.direction[axis] = number;
            rays.push(turned);
        }
        rays.push(Ray::new(Vec3::splat(number), ray.direction));
        rays.push(Ray::new(origin, Vec3::splat(number)));
        // What begins behind its origin is no ray: boxes there are passed over.
        if number.is_nan() || number >= 0.0 {
            rays.push(Ray {
                t_min: number,
                ..ray
            });
        }
        rays.push(Ray {
            t_max: number,
            ..ray
        });
    }
    rays
}

/// Along each axis, through where something is and through where nothing is.
fn axes(geometry: &Geometry) -> Vec<Ray> {
    let mut rays = vec![];
    for index in 0..8 {
        let mut origins = vec![around(geometry, 200 + index)];
        origins.extend(
            geometry
                .shapes()
                .get(3 * index as usize)
                .map(|shape| (shape.a + shape.b + shape.c) / 3.0),
        );
        for origin in origins {
            for direction in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                let back = geometry.bounds().size().max_element();
                rays.push(Ray::new(origin, direction));
                rays.push(Ray::new(origin - back * direction, direction));
            }
        }
    }
    rays
}

/// Through vertices and along edges, at and past the triangle's own plane.
fn corners(geometry: &Geometry) -> Vec<Ray> {
    let mut rays = vec![];
    for (index, shape) in (300..).zip(geometry.shapes().iter().take(30)) {
        let from = around(geometry, index);
        let middle = (shape.a + shape.b) / 2.0;
        let inside = (shape.a + shape.b + shape.c) / 3.0;
        for target in [shape.a, shape.b, shape.c, middle, inside] {
            rays.push(Ray::new(from, target - from));
            rays.push(Ray::segment(from, target));
            rays.push(Ray::segment_from(target, from));
        }
        rays.push(Ray::new(shape.a, shape.b - shape.a));
        rays.push(Ray::new(inside, shape.c - inside));
    }
    rays
}

/// Intervals that are empty, the wrong way round, or end about where a triangle is.
///
/// Boxes are passed over by a distance that is rounded otherwise than a triangle's: a hit within a
/// few units in the last place of where a ray ends may be lost with its box, so none is asked for here.
/// Lists have no boxes ([`exact_ends`]).
fn intervals(geometry: &Geometry) -> Vec<Ray> {
    const NEAR: f32 = 32.0 * f32::EPSILON;
    at_triangles(geometry, |t| {
        vec![
            [0.0, t],
            [0.0, t * (1.0 + NEAR)],
            [0.0, t * (1.0 - NEAR)],
            [t, 2.0 * t],
            [t * (1.0 - NEAR), 2.0 * t],
            [t, t],
            [2.0 * t, 0.5 * t],
            [0.0, f32::MAX],
        ]
    })
}

/// Rays that end, or begin, at the very numbers before and after where a triangle is.
pub(super) fn exact_ends(geometry: &Geometry) -> Vec<Ray> {
    at_triangles(geometry, |t| {
        vec![
            [0.0, t.next_down()],
            [0.0, t],
            [0.0, t.next_up()],
            [t.next_down(), 2.0 * t],
            [t, 2.0 * t],
            [t.next_up(), 2.0 * t],
        ]
    })
}

/// Rays to the middle of some triangles, with intervals that depend on where these are.
fn at_triangles(geometry: &Geometry, intervals: impl Fn(f32) -> Vec<[f32; 2]>) -> Vec<Ray> {
    let mut rays = vec![];
    for (index, shape) in (400..).zip(geometry.shapes().iter().take(20)) {
        let from = around(geometry, index);
        let inside = (shape.a + shape.b + shape.c) / 3.0;
        let ray = Ray::new(from, inside - from);
        let t = shape.intersect(&ray).map_or(1.0, |hit| hit.t);
        for [t_min, t_max] in intervals(t) {
            rays.push(Ray {
                t_min,
                t_max,
                ..ray
            });
        }
    }
    rays
}
