//! Scenes at the edges of what geometry and lights may be: with LIEs they look as the standard
//! ray tracer has them, whatever was learnt so far, from where it was learnt and from beside it.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod check;
mod model;

use glam::Vec3;
use lie_farm::ConstructSettings;
use lie_geom::RandomKey;
use lie_render::compare;

use self::{
    check::{TOLERANCE, check, check_samples, construct, frame},
    model::{Model, lamp, point, spot, sun, world},
};

const AHEAD: ([f32; 3], [f32; 3]) = ([0.0, 2.5, 6.0], [0.0, 0.5, 0.0]);
const BEHIND: ([f32; 3], [f32; 3]) = ([0.5, 2.0, -6.0], [0.0, 0.5, 0.0]);

/// Slivers of 1 m by 0.1 mm, standing and lying about on a floor.
fn blades(count: u32) -> Model {
    let mut model = Model::default();
    model.floor();
    for number in 0..count {
        let key = RandomKey::new(u64::from(number));
        let [place, way] = [key.uniform2(0), key.uniform2(1)];
        let root = Vec3::new(6.0 * place.x - 3.0, 0.01, 6.0 * place.y - 3.0);
        let up = Vec3::new(way.x - 0.5, 0.7, way.y - 0.5);
        let turn = std::f32::consts::TAU * key.uniform(9);
        let across = 1.0e-4 * Vec3::new(turn.cos(), 0.0, turn.sin());
        model.polygon(&[root, root + across, root + up]);
    }
    model
}

#[test]
fn thin_blades() {
    let lights = [
        point([1.0, 3.0, 1.0], 20.0),
        spot([3.0, 2.0, 2.0], [0.0, 0.0, 0.0], 10.0),
        sun([0.5, -0.3, 0.2]),
    ];
    check(&world(&blades(3000), &lights, &[AHEAD]));
}

/// A proof that is lost as a region grows leaves its light in doubt: the sun was dark for good in
/// cells where it had been certain while others were sampled.
#[test]
fn thin_blades_under_a_lamp_and_the_sun() {
    let lights = [
        point([1.0, 3.0, 1.0], 20.0),
        lamp([-1.0, 3.0, 0.0], 5.0),
        spot([3.0, 2.0, 2.0], [0.0, 0.0, 0.0], 10.0),
        sun([0.5, -0.3, 0.2]),
    ];
    let world = world(&blades(3000), &lights, &[AHEAD]);
    check_samples(&world, 1);
    let settings = ConstructSettings::new(world.scene());
    construct(&world, settings, &[64, 128], |lies| {
        let camera = &world.scene().cameras[0];
        let [picture, standard] = [Some(lies), None].map(|lies| frame(&world, lies, camera));
        let figures = compare(&picture, &standard, 0.0).unwrap();
        // Without the sun in some cells it was 4.5 %.
        assert!(figures.relative_rmse < 0.005, "{figures:?}");
    });
}

#[test]
fn grazing_light() {
    // Beside the floor, in its plane and just above it.
    let lights = [
        point([-4.5, 1.0e-3, 0.0], 20.0),
        point([3.0, 0.0, 3.0], 20.0),
        point([0.0, 1.0e-5, 0.0], 1.0),
        point([-6.0, 0.3, 1.0], 20.0),
        sun([1.0, -1.0e-3, 0.0]),
    ];
    check(&world(&blades(1000), &lights, &[AHEAD]));
}

/// Sheets without thickness, seen from both sides and along them, lit from both.
fn sheets() -> Model {
    let mut model = Model::default();
    model.floor();
    model.sheet(Vec3::new(-1.0, 0.0, 0.0), Vec3::X * 2.0, Vec3::Y * 1.5);
    model.sheet(Vec3::new(-1.5, 1.0, -0.5), Vec3::X, Vec3::Z);
    model
}

#[test]
fn sheets_of_paper() {
    let places = [AHEAD, BEHIND, ([3.0, 1.0, 0.0], [0.0, 1.0, 0.0])];
    // The last two shine along a sheet.
    let lights = [
        point([0.5, 2.0, 2.0], 20.0),
        point([-0.5, 2.0, -2.0], 20.0),
        point([0.0, 3.0, 0.0], 3.0),
        point([2.0, 1.0, 0.5], 3.0),
    ];
    check(&world(&sheets(), &lights, &places));
    check_samples(&world(&sheets(), &[lamp([0.0, 2.0, 0.0], 5.0)], &places), 1);
}

/// Triangles that are there twice, walls that overlap in one plane, boxes that share a face.
fn coincident() -> Model {
    let mut model = Model::default();
    model.floor().floor();
    let corner = Vec3::new(-1.0, 0.0, 0.0);
    model.sheet(corner, Vec3::X * 2.0, Vec3::Y * 1.5);
    model.sheet(corner, Vec3::X * 2.0, Vec3::Y * 1.5);
    model.tiles(corner, Vec3::X * 2.0, Vec3::Y * 1.5, 3);
    model.sheet(corner + Vec3::X * 0.37, Vec3::X * 2.0, Vec3::Y * 1.1);
    model.sheet(corner + Vec3::X, Vec3::Y * 2.0, Vec3::X);
    model.solid(Vec3::new(1.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 1.0));
    model.solid(Vec3::new(2.0, 0.0, 0.0), Vec3::new(3.0, 1.0, 1.0));
    model.solid(Vec3::new(2.0, 0.0, 0.0), Vec3::new(3.0, 0.5, 1.5));
    model
}

#[test]
fn touching_and_coincident_triangles() {
    // Some are in the planes of walls and of edges between triangles.
    let lights = [
        point([0.5, 2.0, 2.0], 20.0),
        point([-0.5, 2.0, -2.0], 20.0),
        point([-3.0, 1.0, 0.5], 3.0),
        point([0.0, 3.0, 0.0], 3.0),
        point([2.0, 2.0, 2.0], 3.0),
        spot([2.0, 3.0, 1.0], [2.0, 0.0, 0.5], 4.0),
        sun([0.0, -1.0, 0.0]),
        sun([0.0, -1.0, -0.7]),
    ];
    let places = [AHEAD, BEHIND];
    check(&world(&coincident(), &lights, &places));
    check_samples(
        &world(&coincident(), &[lamp([0.0, 2.0, 0.0], 5.0)], &places),
        1,
    );
}

/// Two boxes and a wall of two sheets.
fn boxes() -> Model {
    let mut model = Model::default();
    model.floor();
    model.solid(Vec3::new(-2.0, 0.0, -1.0), Vec3::new(-1.0, 1.0, 0.0));
    model.solid(Vec3::new(1.0, 0.5, -1.0), Vec3::new(2.0, 1.5, 0.0));
    model.sheet(Vec3::new(-0.5, 0.0, -1.0), Vec3::X, Vec3::Y);
    model.sheet(Vec3::new(-0.5, 0.0, -1.0), Vec3::X, Vec3::Y);
    model
}

/// From outside, and from inside of a box.
const OUT_AND_IN: [([f32; 3], [f32; 3]); 2] = [AHEAD, ([1.3, 0.9, -0.3], [1.9, 0.6, -0.9])];

#[test]
fn lights_on_surfaces_and_inside_of_them() {
    let lights = [
        // On the floor, and at a corner of its tiles.
        point([0.3, 0.0, 0.7], 1.0),
        point([1.0, 0.0, 1.0], 1.0),
        // In a box, on its edge, and at the other's corner.
        point([-1.5, 0.5, -0.5], 50.0),
        point([-1.0, 1.0, -0.4], 2.0),
        point([2.0, 1.5, 0.0], 2.0),
        // Between the wall's sheets, on the edge between triangles and off it.
        point([0.0, 0.5, -1.0], 4.0),
        point([0.25, 0.5, -1.0], 4.0),
    ];
    check(&world(&boxes(), &lights, &OUT_AND_IN));
    let lamps = [
        // In the lid of a box, inside of the other, in the floor, across an edge.
        lamp([1.5, 1.5, -0.5], 4.0),
        lamp([-1.5, 0.5, -0.5], 4.0),
        lamp([0.0, 0.0, 2.0], 3.0),
        lamp([0.5, 0.5, 0.0], 1.0),
    ];
    check_samples(&world(&boxes(), &lamps, &OUT_AND_IN), 4);
}

/// From a million metres away distances are coarse: a proof must say what the rays do.
#[test]
fn lights_outside_of_the_scene() {
    let mut lights = vec![
        point([3.0e5, 1.0e6, 2.0e5], 1.0e12),
        point([0.0, 1.0, -1.0e4], 1.0e8),
        spot([0.0, 1.0e3, 10.0], [0.0, 0.0, 0.0], 1.0e6),
        point([0.0, -5.0, 0.0], 100.0),
    ];
    for turn in 0..8 {
        let (sine, cosine) = (0.3 + turn as f32).sin_cos();
        lights.push(point([1.0e5 * sine, 5.0e4, 1.0e5 * cosine], 1.0e10));
    }
    check(&world(&boxes(), &lights, &OUT_AND_IN));
}

#[test]
fn powers_of_all_sizes() {
    for [strong, faint] in [[1.0, 1.0e-9], [0.0, 0.0], [1.0e30, 1.0], [1.0e-30, 1.0e-32]] {
        let lights = [
            point([1.0, 2.0, 1.0], 20.0 * strong),
            point([-2.0, 2.0, -2.0], 20.0 * faint),
            point([0.0, 2.0, -1.0], 0.0),
        ];
        check(&world(&blades(200), &lights, &[AHEAD]));
        let lamps = [
            lamp([0.0, 3.0, 1.0], faint),
            lamp([1.0, 3.0, 1.0], strong),
            lamp([0.0, 2.0, 1.0], 0.0),
        ];
        check_samples(&world(&blades(200), &lamps, &[AHEAD]), 3);
    }
}

/// Triangles without area, and with next to none.
fn degenerate() -> Model {
    let mut model = Model::default();
    model.floor();
    for number in 0..200 {
        let turn = number as f32;
        let at = Vec3::Y + 0.02 * turn * Vec3::new(turn.cos(), 0.2, turn.sin());
        let aslant = Vec3::new(0.3, 0.1, 0.7);
        model.polygon(&[at, at, at]);
        model.polygon(&[at, at + Vec3::X, at + Vec3::X]);
        model.polygon(&[at, at + 0.5 * Vec3::X, at + Vec3::X]);
        model.polygon(&[at, at + aslant, at + 3.0 * aslant]);
        model.polygon(&[at, at + Vec3::splat(1.0e-20), at + Vec3::X * 1.0e-20]);
        model.polygon(&[at, at + 0.2 * Vec3::Y, at + Vec3::new(1.0e-6, 0.1, 0.0)]);
    }
    // Boxes without height and without depth.
    model.solid(Vec3::new(-2.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 0.0));
    model.solid(Vec3::new(-2.0, 0.0, 1.0), Vec3::new(-1.0, 1.0, 1.0));
    model
}

#[test]
fn degenerate_triangles() {
    let lights = [
        point([1.0, 3.0, 1.0], 20.0),
        point([0.0, 2.0, -1.0], 2.0),
        sun([0.5, -0.3, 0.2]),
    ];
    check(&world(&degenerate(), &lights, &[AHEAD]));
    check_samples(
        &world(&degenerate(), &[lamp([-1.0, 3.0, 0.0], 5.0)], &[AHEAD]),
        1,
    );
}

/// A large box with shells in shells inside, and rubble that everything runs through.
fn matter() -> Model {
    let mut model = Model::default();
    model.floor();
    model.solid(Vec3::new(-2.0, -1.0, -2.0), Vec3::splat(2.0));
    for number in 1..6 {
        let (middle, side) = (Vec3::new(0.5, 0.5, 0.0), Vec3::splat(0.1 * number as f32));
        model.solid(middle - side, middle + side);
    }
    for number in 0..100 {
        let key = RandomKey::new(number);
        let place = key.uniform2(0);
        let height = 2.0 * key.uniform(7) - 1.0;
        let min = Vec3::new(8.0 * place.x - 4.0, height, 8.0 * place.y - 4.0);
        model.solid(min, min + 0.4);
    }
    model
}

#[test]
fn cells_in_solid_matter() {
    let places = [
        AHEAD,
        ([0.5, 0.5, 0.25], [-2.0, 0.4, 0.1]),
        ([1.7, 1.7, 1.7], [-2.0, -0.5, 0.0]),
        ([0.0, -0.5, 3.0], [0.0, -0.6, 0.0]),
    ];
    let lights = [
        point([1.0, 3.0, 3.0], 20.0),
        point([0.5, 0.5, 0.0], 1.0),
        point([-1.5, 0.5, 0.5], 1.0),
        point([0.0, -0.5, -1.0], 2.0),
        sun([0.5, -0.3, 0.2]),
    ];
    check(&world(&matter(), &lights, &places));
    check_samples(&world(&matter(), &[lamp([0.0, 1.5, 0.0], 1.0)], &places), 1);
}

/// A point of light far away is a sun: what the standard ray tracer makes of distances.
#[test]
fn a_point_that_is_far_away_shines_like_the_sun() {
    let way = Vec3::new(0.3, 1.0, 0.2).normalize();
    let sun = world(&boxes(), &[sun((-way).to_array())], &OUT_AND_IN);
    for distance in [1.0e4f32, 1.0e5] {
        let lights = [point((distance * way).to_array(), distance * distance)];
        let far = world(&boxes(), &lights, &OUT_AND_IN);
        for camera in &sun.scene().cameras {
            let [found, expected] = [&far, &sun].map(|world| frame(world, None, camera));
            let figures = compare(&found, &expected, 0.0).unwrap();
            assert!(figures.relative_rmse < TOLERANCE, "{distance}: {figures:?}");
        }
    }
}
