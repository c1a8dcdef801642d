use std::sync::{Arc, atomic::AtomicBool};

use super::*;
use crate::{LieCell, Tile, TileResult, render_tile};

/// The same cell everywhere.
struct OneCell(LieCell);

impl LieLookup for OneCell {
    fn cell(&self, _: Vec3) -> &LieCell {
        &self.0
    }
}

/// Of every four lights one is unoccluded, one behind some triangles, one traced, one hidden.
fn mixed_cell(world: &World) -> OneCell {
    let lights = 0..world.scene().lights.len() as u32;
    let occluders: Vec<u32> = (0..40).map(|index| 11 * index).collect();
    let known = lights.clone().filter(|light| light % 4 < 2);
    let known = known.map(|light| {
        let list = if light % 4 == 0 { &[][..] } else { &occluders };
        (light, list)
    });
    OneCell(LieCell::new(
        known,
        lights.filter(|light| light % 4 == 2).collect(),
    ))
}

fn tile(
    world: &World,
    lies: Option<&dyn LieLookup>,
    settings: &FrameSettings,
    at: UVec2,
) -> TileResult {
    let tile = Tile {
        origin: at,
        size: UVec2::ONE,
    };
    let camera = &world.scene().cameras[0];
    render_tile(world, lies, camera, settings, tile, &AtomicBool::new(false)).unwrap()
}

fn check(name: &str, found: Vec3, expected: Vec3) {
    let distance = (found - expected).abs().max_element();
    assert!(
        distance <= 1.0e-4 * (1.0 + expected.max_element()),
        "{name}: {found} is not {expected}"
    );
}

#[test]
fn lights_add_up_to_the_renderers_pixel_and_rays_to_its_counts() {
    let gallery = lie_scene::Gallery {
        detail: 0.25,
        ..lie_scene::Gallery::default()
    };
    let world = World::new(Arc::new(lie_scene::gallery(&gallery)));
    let cell = mixed_cell(&world);
    let settings = FrameSettings {
        size: UVec2::new(24, 16),
        samples_per_pixel: 1,
        light_samples: 4,
        ..FrameSettings::new(&world.scene().settings)
    };
    let camera = &world.scene().cameras[0];
    let mut wrong = 0;
    for index in (0..24 * 16).step_by(7) {
        let pixel = UVec2::new(index % 24, index / 24);
        let light = PixelLight::of(&world, &cell, camera, &settings, pixel).unwrap();
        let sum =
            |of: fn(&LightShare) -> Vec3| light.emitted + light.lights.iter().map(of).sum::<Vec3>();
        let count = |of: fn(&LightShare) -> u64| light.lights.iter().map(of).sum::<u64>();
        let standard = tile(&world, None, &settings, pixel);
        let with_lies = tile(&world, Some(&cell), &settings, pixel);
        check(
            "exact",
            sum(|share| share.exact),
            standard.radiance.radiance()[0],
        );
        check(
            "shaded",
            sum(|share| share.shaded),
            with_lies.radiance.radiance()[0],
        );
        let (standard, stats) = (standard.stats, with_lies.stats);
        assert_eq!(
            count(|share| share.standard_rays.into()),
            standard.shadow_rays
        );
        assert_eq!(count(|share| share.traced_rays.into()), stats.shadow_rays);
        assert_eq!(count(|share| share.list_rays.into()), stats.list_rays);
        assert_eq!(count(|share| share.occluder_tests), stats.occluder_tests);
        for share in &light.lights {
            let beyond = share.exact.cmpgt(share.unoccluded * 1.0001);
            assert!(
                !beyond.any(),
                "light {} gives more than it has",
                share.light
            );
            let is_traced = share.answer == LightAnswer::Traced;
            assert!(!is_traced || share.at_stake == AtStake::default());
            wrong += share.missed.len();
        }
    }
    assert!(wrong > 0, "a cell that knows nothing is wrong somewhere");
}

#[test]
fn where_nothing_is_seen_there_is_no_light() {
    let world = World::new(Arc::new(lie_scene::cornell_box()));
    let cell = mixed_cell(&world);
    let settings = FrameSettings::new(&world.scene().settings);
    let away = Camera::look_at("away", Vec3::splat(1.0e4), Vec3::splat(2.0e4), Vec3::Y, 0.5);
    assert_eq!(
        PixelLight::of(&world, &cell, &away, &settings, UVec2::ZERO),
        None
    );
}
