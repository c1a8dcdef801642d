//! Area lights with and without something in the way: closed forms where there is nothing,
//! whoever asks, and visible shares of them elsewhere.

use std::f64::consts::PI;

use glam::{UVec2, Vec3};
use lie_render::{
    FrameSettings, LieCell, LieLookup, LightSet, RenderStats, World, luminance, render_frame,
};
use lie_scene::{AreaLight, AreaShape, Camera, LightKind, Material};

use crate::stage::{Estimate, Stage, polygon_irradiance, seen};

const ALBEDO: f32 = 0.5;
const EYE: Vec3 = Vec3::new(3.0, 5.0, 4.0);

/// 2 × 1 m, 2 m above the floor.
const CORNERS: [Vec3; 4] = [
    Vec3::new(-1.0, 2.0, -0.5),
    Vec3::new(1.0, 2.0, -0.5),
    Vec3::new(1.0, 2.0, 0.5),
    Vec3::new(-1.0, 2.0, 0.5),
];

struct OneCell(LieCell);

impl LieLookup for OneCell {
    fn cell(&self, _: Vec3) -> &LieCell {
        &self.0
    }
}

fn panel() -> AreaShape {
    AreaShape::Rectangle {
        corner: CORNERS[0],
        edge_u: CORNERS[1] - CORNERS[0],
        edge_v: CORNERS[3] - CORNERS[0],
    }
}

fn stage(material: Material) -> Stage {
    Stage::default()
        .floor(material)
        .area_light(panel(), Vec3::ONE)
}

fn matt() -> Material {
    Material::diffuse("floor", Vec3::splat(ALBEDO))
}

/// A roof 1 m above the floor that hides some of the panel.
fn with_roof(stage: Stage) -> World {
    let roof = Material::diffuse("roof", Vec3::ZERO);
    let corner = Vec3::new(-0.1, 1.0, -5.0);
    stage
        .quad(roof, corner, 0.6 * Vec3::X, 10.0 * Vec3::Z)
        .world()
}

/// One pixel by an integrator.
fn pixel(
    world: &World,
    cell: Option<&OneCell>,
    ward: Option<f32>,
    target: Vec3,
    light_samples: u32,
) -> (f32, RenderStats) {
    let settings = FrameSettings {
        size: UVec2::ONE,
        samples_per_pixel: 1,
        light_samples,
        seed: 0,
        ward,
    };
    let camera = Camera::look_at("eye", EYE, target, Vec3::Y, 0.5);
    let lies = cell.map(|cell| cell as &dyn LieLookup);
    let (film, stats) = render_frame(world, lies, &camera, &settings, &mut |_| {});
    (luminance(film.radiance()[0]), stats)
}

/// A cell that says that the light is behind these triangles.
fn behind(triangles: &[u32]) -> OneCell {
    OneCell(LieCell::new(
        std::iter::once((0, triangles)),
        LightSet::default(),
    ))
}

fn is_near(found: f32, expected: f64, what: &str) {
    let off = (f64::from(found) / expected - 1.0).abs();
    assert!(off < 1.0e-5, "{what}: {found} is not {expected}");
}

#[test]
fn all_integrators_give_the_closed_form_without_noise() {
    let world = stage(matt()).world();
    let traced = OneCell(LieCell::new(
        std::iter::empty(),
        std::iter::once(0).collect(),
    ));
    for target in [
        Vec3::ZERO,
        Vec3::new(3.0, 0.0, 1.0),
        Vec3::new(0.0, 0.0, 15.0),
    ] {
        let expected = f64::from(ALBEDO) / PI * polygon_irradiance(target, Vec3::Y, &CORNERS);
        for samples in [1, 3, 64] {
            let (unoccluded, listed) = (behind(&[]), behind(&[0]));
            let of = |cell, ward| pixel(&world, cell, ward, target, samples);
            is_near(of(None, None).0, expected, "standard");
            is_near(of(None, Some(0.1)).0, expected, "ward");
            is_near(of(Some(&traced), None).0, expected, "traced");
            let (unoccluded, none) = of(Some(&unoccluded), None);
            is_near(unoccluded, expected, "unoccluded");
            // The floor itself hides nothing, which is seen without a ray: those that are near go
            // through the scene, as they do where there is no list.
            let (listed, stats) = of(Some(&listed), None);
            is_near(listed, expected, "listed");
            assert_eq!((stats.list_rays, stats.shadow_rays), (0, none.shadow_rays));
        }
        let stats = pixel(&world, Some(&behind(&[])), None, target, 64).1;
        assert_eq!(stats.shadow_rays + stats.list_rays, 0, "none is near");
    }
}

#[test]
fn the_diffuse_lobe_under_a_gloss_is_all_there_whatever_the_samples() {
    // Rough, and so smooth that lights are followed: the mean is that of many samples.
    for roughness in [0.9, 0.2] {
        let floor = Material {
            roughness,
            specular: 1.0,
            ..matt()
        };
        let world = stage(floor).world();
        let target = Vec3::new(0.3, 0.0, 0.2);
        let expected = Estimate::of(16, |seed| seen(&world, EYE, target, 4096, seed).x);
        let found = Estimate::of(4000, |seed| seen(&world, EYE, target, 6, seed).x);
        found.check(expected.mean, "gloss");
    }
}

/// What of the panel the point below its middle sees past the roof, in m along x: the roof's
/// edges at ½ of the height hide from -0.2 to 1.
fn visible_irradiance() -> f64 {
    let mut corners = CORNERS;
    corners[1].x = -0.2;
    corners[2].x = -0.2;
    polygon_irradiance(Vec3::ZERO, Vec3::Y, &corners)
}

#[test]
fn what_is_in_the_way_takes_its_share() {
    let world = with_roof(stage(matt()));
    let expected = f64::from(ALBEDO) / PI * visible_irradiance();
    let found = Estimate::of(16, |seed| seen(&world, EYE, Vec3::ZERO, 4096, seed).x);
    found.check(expected, "many samples");
    // A ratio of means is not the mean of ratios: with few samples it is off, but by little.
    for samples in [4, 16] {
        let found = Estimate::of(4000, |seed| seen(&world, EYE, Vec3::ZERO, samples, seed).x);
        let off = found.mean / expected - 1.0;
        assert!(
            off.abs() < 0.08 / f64::from(samples).sqrt(),
            "{samples}: {off}"
        );
    }
}

#[test]
fn a_cell_with_the_right_list_shows_what_tracing_does() {
    let world = with_roof(stage(matt()));
    for x in [-2.0, -1.5, 0.0, 0.7] {
        let target = Vec3::new(x, 0.0, 0.1);
        let (traced, _) = pixel(&world, None, None, target, 64);
        let (listed, stats) = pixel(&world, Some(&behind(&[2, 3])), None, target, 64);
        assert!(
            (traced - listed).abs() <= 1.0e-6 * traced,
            "{traced} {listed}"
        );
        // Half-way up, rays to the panel pass from (x - 1) / 2 to (x + 1) / 2: by the roof, which
        // begins at -0.1, or not. All samples are asked about, or none.
        let is_hidden = (x + 1.0) / 2.0 > -0.1;
        assert_eq!(stats.list_rays, if is_hidden { 64 } else { 0 }, "{x}");
        if !is_hidden {
            let whole = f64::from(ALBEDO) / PI * polygon_irradiance(target, Vec3::Y, &CORNERS);
            is_near(listed, whole, "clear");
        }
    }
}

#[test]
fn next_to_a_light_rays_are_traced_whatever_a_cell_says() {
    // 10 cm below the panel, where four samples stand for half of the view each.
    let near = AreaShape::Rectangle {
        corner: Vec3::new(-1.0, 0.1, -1.0),
        edge_u: 2.0 * Vec3::X,
        edge_v: 2.0 * Vec3::Z,
    };
    let roof = Material::diffuse("roof", Vec3::ZERO);
    let world = Stage::default()
        .floor(matt())
        .quad(
            roof,
            Vec3::new(-1.0, 0.05, -1.0),
            2.0 * Vec3::X,
            2.0 * Vec3::Z,
        )
        .light(LightKind::Area(AreaLight::new(near, Vec3::ONE, false)))
        .world();
    let camera_below = |cell: Option<&OneCell>| {
        let settings = FrameSettings {
            size: UVec2::ONE,
            samples_per_pixel: 1,
            light_samples: 4,
            seed: 0,
            ward: None,
        };
        let eye = Vec3::new(6.0, 0.04, 0.0);
        let camera = Camera::look_at("eye", eye, Vec3::ZERO, Vec3::Y, 0.5);
        let lies = cell.map(|cell| cell as &dyn LieLookup);
        let (film, stats) = render_frame(&world, lies, &camera, &settings, &mut |_| {});
        (film.radiance()[0], stats)
    };
    let (radiance, stats) = camera_below(Some(&behind(&[])));
    assert!(stats.shadow_rays > 0);
    // The rays that stand for much are found blocked; what is left is what the others carry.
    let whole = ALBEDO * std::f32::consts::FRAC_1_PI * 3.0;
    assert!(radiance.x < 0.2 * whole, "{radiance}");
    assert_eq!(camera_below(None).0, Vec3::ZERO);
}

#[test]
fn a_strip_above_the_horizon_is_lit_by_a_ray_of_its_own() {
    // A wall of light that reaches 2 cm above the floor: a single sample rarely meets that.
    let wall = AreaShape::Rectangle {
        corner: Vec3::new(2.0, -3.0, -1.0),
        edge_u: 2.0 * Vec3::Z,
        edge_v: 3.02 * Vec3::Y,
    };
    let strip = [
        Vec3::new(2.0, 0.0, -1.0),
        Vec3::new(2.0, 0.0, 1.0),
        Vec3::new(2.0, 0.02, 1.0),
        Vec3::new(2.0, 0.02, -1.0),
    ];
    let hidden = |is_hidden: bool| {
        let stage = Stage::default()
            .floor(matt())
            .area_light(wall.clone(), Vec3::ONE);
        let fence = Material::diffuse("fence", Vec3::ZERO);
        match is_hidden {
            true => stage.quad(fence, Vec3::new(1.9, 0.0, -5.0), 10.0 * Vec3::Z, Vec3::Y),
            false => stage,
        }
        .world()
    };
    let expected = f64::from(ALBEDO) / PI * polygon_irradiance(Vec3::ZERO, Vec3::Y, &strip);
    let clear = hidden(false);
    let cells = [None, Some(behind(&[])), Some(behind(&[0]))];
    for cell in &cells {
        let (found, _) = pixel(&clear, cell.as_ref(), None, Vec3::ZERO, 1);
        is_near(found, expected, "strip");
    }
    assert_eq!(pixel(&hidden(true), None, None, Vec3::ZERO, 1).0, 0.0);
}
