//! Adaptive shadow testing against the standard ray tracer.

use std::sync::Arc;

use glam::{UVec2, Vec3};
use lie_render::{Film, FrameSettings, RenderStats, World, luminance, render_frame};
use lie_scene::{Camera, LightKind, Material};

use crate::stage::Stage;

fn worlds() -> [World; 2] {
    let gallery = lie_scene::gallery(&lie_scene::Gallery {
        detail: 0.25,
        ..lie_scene::Gallery::default()
    });
    [lie_scene::cornell_box(), gallery].map(|scene| World::new(Arc::new(scene)))
}

fn frame(world: &World, ward: Option<f32>) -> (Film, RenderStats) {
    let settings = FrameSettings {
        size: UVec2::new(67, 45),
        samples_per_pixel: 1,
        light_samples: 5,
        seed: 3,
        ward,
    };
    let camera = &world.scene().cameras[0];
    render_frame(world, None, camera, &settings, &mut |_| {})
}

#[test]
fn a_threshold_of_0_is_the_standard_picture_bit_for_bit() {
    for world in worlds() {
        let (standard, cost) = frame(&world, None);
        let (ward, same_cost) = frame(&world, Some(0.0));
        assert!(ward == standard, "{}", world.scene().name);
        assert_eq!(cost.shadow_rays, same_cost.shadow_rays);
    }
}

#[test]
fn no_pixel_is_further_off_than_the_threshold_and_rays_are_saved() {
    for world in worlds() {
        let (standard, _) = frame(&world, None);
        let mut rays = u64::MAX;
        for threshold in [0.01, 0.1, 0.5, 1.0] {
            let (ward, cost) = frame(&world, Some(threshold));
            for (found, expected) in ward.radiance().iter().zip(standard.radiance()) {
                let (found, expected) = (luminance(*found), luminance(*expected));
                let allowed = (threshold + 1.0e-4) * expected;
                assert!((found - expected).abs() <= allowed, "{found} {expected}");
            }
            assert!(cost.shadow_rays <= rays);
            rays = cost.shadow_rays;
        }
        let many = world.scene().lights.len() > 1;
        assert_eq!(rays < frame(&world, None).1.shadow_rays, many);
    }
}

/// Two bright lights, one of them behind a roof, and a faint one: it is not tested, and
/// counts half.
#[test]
fn the_rest_is_estimated_by_the_share_of_clear_rays() {
    let light = |position, strength| LightKind::Point {
        position,
        radiant_intensity: Vec3::splat(strength),
    };
    let roof = Vec3::new(1.0, 2.0, -1.0);
    let lights = [
        light(Vec3::new(0.0, 4.0, 0.0), 100.0),
        light(Vec3::new(3.0, 4.0, 0.0), 500.0),
        light(Vec3::new(0.0, 4.0, 0.0), 1.0),
    ];
    let stage = |lights: &[LightKind]| {
        let stage = Stage::default().floor(Material::default());
        let stage = stage.quad(Material::default(), roof, 2.0 * Vec3::Z, 2.0 * Vec3::X);
        let stage = lights
            .iter()
            .fold(stage, |stage, kind| stage.light(kind.clone()));
        stage.world()
    };
    let seen = |lights: &[LightKind], ward| {
        let (eye, target) = (Vec3::new(-1.0, 2.0, 0.0), Vec3::new(0.5, 0.0, 0.0));
        let camera = Camera::look_at("eye", eye, target, Vec3::Y, 0.5);
        let settings = FrameSettings {
            size: UVec2::ONE,
            samples_per_pixel: 1,
            light_samples: 1,
            seed: 0,
            ward,
        };
        let (film, cost) = render_frame(&stage(lights), None, &camera, &settings, &mut |_| {});
        (film.radiance()[0], cost.shadow_rays)
    };
    let (tested, faint) = (seen(&lights[..2], None).0, seen(&lights[2..], None).0);
    assert_eq!(tested, seen(&lights[..1], None).0, "the second is hidden");
    let (found, rays) = seen(&lights, Some(0.05));
    assert_eq!(rays, 2);
    let error = found - (tested + 0.5 * faint);
    assert!(error.abs().max_element() < 1.0e-4 * faint.min_element());
}
