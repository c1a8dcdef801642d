use std::sync::Arc;

use glam::Vec3;
use lie_render::{Tile, render_tile};

use super::*;
use crate::{Builder, ConstructSettings, LieReplica, View};

const SIZE: UVec2 = UVec2::new(48, 32);

/// The coarse gallery with some samples: lights of many classes.
struct Stage {
    world: Arc<World>,
    tree: LieTree,
    replica: LieReplica,
    settings: FrameSettings,
}

impl Stage {
    fn new(trust: u32, samples: u64) -> Self {
        let gallery = lie_scene::Gallery {
            detail: 0.25,
            ..lie_scene::Gallery::default()
        };
        let world = Arc::new(World::new(Arc::new(lie_scene::gallery(&gallery))));
        let mut settings = ConstructSettings::new(world.scene());
        settings.lie.trust = trust;
        let mut builder = Builder::new(world.clone(), settings).unwrap();
        let view = View {
            camera: world.scene().cameras[0].clone(),
            size: SIZE,
        };
        builder.sample(&[view], samples, |_| {});
        Self {
            settings: FrameSettings {
                size: SIZE,
                light_samples: 4,
                ..FrameSettings::new(&world.scene().settings)
            },
            tree: builder.tree().clone(),
            replica: LieReplica::of(world.clone(), builder.tree()),
            world,
        }
    }

    fn camera(&self) -> &Camera {
        &self.world.scene().cameras[0]
    }

    fn inspect(&self, pixel: UVec2) -> Result<PixelReport, OutsidePicture> {
        let lies = self.replica.publish();
        inspect(
            &self.world,
            &self.tree,
            &lies,
            self.camera(),
            &self.settings,
            pixel,
        )
    }
}

/// Pixels spread over the picture.
fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.x * SIZE.y)
        .step_by(37)
        .map(|index| UVec2::new(index % SIZE.x, index / SIZE.x))
}

#[test]
fn a_report_is_about_the_pixel_that_shaders_render() {
    let stage = Stage::new(64, 30_000);
    let lies = stage.replica.publish();
    let mut classes = vec![];
    for pixel in pixels() {
        let report = stage.inspect(pixel).unwrap();
        let seen = report.seen.unwrap();
        let tile = Tile {
            origin: pixel,
            size: UVec2::ONE,
        };
        let never = false.into();
        let rendered = |lies| {
            render_tile(
                &stage.world,
                lies,
                stage.camera(),
                &stage.settings,
                tile,
                &never,
            )
            .unwrap()
        };
        let (standard, with_lies) = (rendered(None), rendered(Some(&lies)));
        let totals = &seen.totals;
        for (found, expected) in [(totals.exact, &standard), (totals.shaded, &with_lies)] {
            let found = Vec3::from(found) + Vec3::from(seen.surface.emitted);
            let expected = expected.radiance.radiance()[0];
            assert!(
                (found - expected).abs().max_element() <= 1.0e-4 * (1.0 + expected.max_element())
            );
        }
        assert_eq!(totals.standard_rays, standard.stats.shadow_rays);
        assert_eq!(totals.traced_rays, with_lies.stats.shadow_rays);
        assert_eq!(totals.occluder_tests, with_lies.stats.occluder_tests);
        assert_eq!(seen.lights.len(), stage.world.scene().lights.len());
        assert_eq!(seen.cell.path.len(), seen.cell.depth as usize);
        seen.lights
            .iter()
            .for_each(|light| check(light, seen.cell.holds));
        classes.extend(seen.lights.iter().map(|light| light.class));
    }
    classes.sort_unstable();
    classes.dedup();
    assert!(classes.len() >= 5, "{classes:?}");
}

/// What must hold of any light.
fn check(light: &LightReport, holds: bool) {
    use LightClass as Class;
    let wrong = light.error != 0.0;
    let may_be_wrong = light.expected_error > 0.0;
    match light.class {
        Class::ProvenUnoccluded | Class::ProvenHidden | Class::CompleteList => {
            assert!(!wrong && !may_be_wrong, "{light:?}");
            assert!(!light.open && light.evidence.is_none(), "{light:?}");
        }
        Class::Doubtful | Class::Crowded => assert!(!wrong && !may_be_wrong, "{light:?}"),
        _ => {}
    }
    if !holds || light.answer == Answer::Traced {
        assert!(
            !wrong && !may_be_wrong && light.saved_rays == 0,
            "{light:?}"
        );
    }
    if let (Class::Lit | Class::Hidden, Some(evidence)) = (light.class, light.evidence) {
        assert!(u32::from(evidence.agreed) >= light.needed, "{light:?}");
    }
    assert_eq!(light.saved_rays + light.traced_rays, light.standard_rays);
    assert!(light.missed.is_empty() || wrong, "{light:?}");
}

#[test]
fn without_trust_nothing_is_traced_and_what_is_unknown_is_dark() {
    let stage = Stage::new(0, 0);
    for pixel in pixels().take(5) {
        let seen = stage.inspect(pixel).unwrap().seen.unwrap();
        assert!(seen.cell.holds && seen.cell.region.is_none());
        for light in &seen.lights {
            assert_eq!(
                (light.class, light.answer),
                (LightClass::Dark, Answer::Hidden)
            );
            assert_eq!(light.error, -light.luminance);
        }
    }
}

#[test]
fn what_is_not_known_at_all_is_traced() {
    let stage = Stage::new(64, 0);
    let seen = stage.inspect(SIZE / 2).unwrap().seen.unwrap();
    assert!(!seen.cell.holds);
    assert_eq!((seen.cell.samples, seen.cell.depth), (0, 0));
    assert_eq!(seen.totals.saved_rays, 0);
    assert_eq!((seen.totals.error, seen.totals.expected_error), (0.0, 0.0));
}

#[test]
fn a_pixel_outside_of_the_picture_is_refused() {
    let stage = Stage::new(64, 0);
    for pixel in [SIZE, UVec2::new(SIZE.x, 0), UVec2::new(0, SIZE.y)] {
        let error = stage.inspect(pixel).unwrap_err();
        assert_eq!(error, OutsidePicture { pixel, size: SIZE });
        assert!(error.to_string().contains("columns are 0 to 47"), "{error}");
    }
    assert!(stage.inspect(SIZE - 1).is_ok());
}
