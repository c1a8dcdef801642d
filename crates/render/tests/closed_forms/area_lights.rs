//! Rectangles and meshes that shine, over a Lambertian floor, against Lambert's formula.

use std::f64::consts::PI;

use glam::Vec3;
use lie_render::World;
use lie_scene::{AreaLight, AreaShape, LightKind, Material};

use crate::stage::{Estimate, Stage, polygon_irradiance, seen};

const ALBEDO: f32 = 0.5;
const EYE: Vec3 = Vec3::new(3.0, 5.0, 4.0);

/// Below the light, beside it, far off, and where it is seen edge-on or nearly so.
const POINTS: [Vec3; 5] = [
    Vec3::new(0.0, 0.0, 0.0),
    Vec3::new(0.8, 0.0, -0.3),
    Vec3::new(3.0, 0.0, 2.0),
    Vec3::new(-7.0, 0.0, 1.0),
    Vec3::new(0.0, 0.0, 12.0),
];

/// A parallelogram that faces down.
#[derive(Clone, Copy)]
struct Panel {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
}

/// The panel of most tests: 2 × 1 m, a little askew.
const PANEL: Panel = Panel {
    corner: Vec3::new(-1.0, 2.0, -0.5),
    u: Vec3::new(2.0, 0.2, 0.0),
    v: Vec3::new(0.1, 0.1, 1.0),
};

impl Panel {
    fn corners(self) -> [Vec3; 4] {
        let Self { corner, u, v } = self;
        [corner, corner + u, corner + u + v, corner + v]
    }

    fn rectangle(self) -> AreaShape {
        AreaShape::Rectangle {
            corner: self.corner,
            edge_u: self.u,
            edge_v: self.v,
        }
    }

    /// The same as a mesh of 2 · n² triangles.
    fn mesh(self, n: u32) -> AreaShape {
        let at = |i: u32, j: u32| {
            self.corner + i as f32 / n as f32 * self.u + j as f32 / n as f32 * self.v
        };
        let triangles = (0..n * n).flat_map(|index| {
            let (i, j) = (index % n, index / n);
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        });
        AreaShape::Mesh {
            triangles: triangles.collect(),
        }
    }

    fn irradiance(self, point: Vec3) -> f64 {
        polygon_irradiance(point, Vec3::Y, &self.corners())
    }
}

fn lit_by(shape: AreaShape) -> World {
    Stage::default()
        .floor(Material::diffuse("floor", Vec3::splat(ALBEDO)))
        .area_light(shape, Vec3::ONE)
        .world()
}

fn check(shape: &AreaShape, panel: Panel, light_samples: u32, what: &str) {
    let world = lit_by(shape.clone());
    for point in POINTS {
        let found = Estimate::of(24, |seed| seen(&world, EYE, point, light_samples, seed).x);
        let expected = f64::from(ALBEDO) / PI * panel.irradiance(point);
        found.check(expected, &format!("{what} at {point}"));
        // Strata make the mean sharp: what was tested says something.
        assert!(
            found.error < 0.01 * expected,
            "{what} at {point}: {found:?}"
        );
    }
}

#[test]
fn a_rectangle_gives_what_lamberts_formula_says() {
    check(&PANEL.rectangle(), PANEL, 1024, "rectangle");
}

#[test]
fn the_number_of_samples_does_not_change_the_mean() {
    let world = lit_by(PANEL.rectangle());
    for light_samples in [1, 2, 7, 16, 100] {
        let found = Estimate::of(4000 / light_samples, |seed| {
            seen(&world, EYE, POINTS[1], light_samples, seed).x
        });
        let expected = f64::from(ALBEDO) / PI * PANEL.irradiance(POINTS[1]);
        found.check(expected, &format!("{light_samples} samples"));
    }
}

#[test]
fn a_mesh_gives_what_its_outline_does_however_it_is_divided() {
    for n in [1, 3, 8] {
        let what = format!("mesh of {} triangles", 2 * n * n);
        check(&PANEL.mesh(n), PANEL, 1024, &what);
    }
}

#[test]
fn a_triangle_and_a_box_are_lights_too() {
    let triangle = [
        Vec3::new(-1.0, 1.5, 0.0),
        Vec3::new(1.0, 1.5, -1.0),
        Vec3::new(0.5, 2.0, 1.0),
    ];
    let world = lit_by(AreaShape::Mesh {
        triangles: vec![triangle],
    });
    for point in POINTS {
        let found = Estimate::of(24, |seed| seen(&world, EYE, point, 1024, seed).x);
        let irradiance = polygon_irradiance(point, Vec3::Y, &triangle);
        found.check(f64::from(ALBEDO) / PI * irradiance, "triangle");
    }
}

#[test]
fn one_sided_lights_give_nothing_behind() {
    // The same panels, turned over.
    let back = Panel {
        u: PANEL.v,
        v: PANEL.u,
        ..PANEL
    };
    for (shape, what) in [(back.rectangle(), "rectangle"), (back.mesh(2), "mesh")] {
        let dark = lit_by(shape.clone());
        let both = Stage::default()
            .floor(Material::diffuse("floor", Vec3::splat(ALBEDO)))
            .light(LightKind::Area(AreaLight::new(shape, Vec3::ONE, true)))
            .world();
        for point in POINTS {
            assert_eq!(seen(&dark, EYE, point, 64, 0), Vec3::ZERO, "{what}");
            let found = Estimate::of(24, |seed| seen(&both, EYE, point, 256, seed).x);
            let expected = f64::from(ALBEDO) / PI * PANEL.irradiance(point);
            found.check(expected, &format!("{what}, both sides"));
        }
    }
}

#[test]
fn a_light_that_is_a_surface_as_well_does_not_shade_itself() {
    // The usual case: an emissive quad is geometry and light at once.
    let shining = Material {
        emission: Vec3::ONE,
        ..Material::diffuse("panel", Vec3::ZERO)
    };
    let world = Stage::default()
        .floor(Material::diffuse("floor", Vec3::splat(ALBEDO)))
        .quad(shining, PANEL.corner, PANEL.u, PANEL.v)
        .area_light(PANEL.rectangle(), Vec3::ONE)
        .world();
    for point in POINTS {
        let found = Estimate::of(24, |seed| seen(&world, EYE, point, 256, seed).x);
        let expected = f64::from(ALBEDO) / PI * PANEL.irradiance(point);
        found.check(expected, &format!("at {point}"));
    }
}
