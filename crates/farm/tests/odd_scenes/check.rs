//! What a picture with LIEs is held to.

use std::sync::Arc;

use glam::{UVec2, Vec3};
use lie_farm::{Builder, ConstructSettings, LieReplica, PublishedLies, View};
use lie_render::{Film, FrameSettings, LieLookup, World, compare, render_frame};
use lie_scene::Camera;

const SIZE: UVec2 = UVec2::new(64, 48);

/// Relative RMSE that a picture with the usual trust may have.
pub(crate) const TOLERANCE: f64 = 0.001;

/// Somewhat to the side and nearer: other pixels, other cells at the edges.
fn beside(camera: &Camera) -> Camera {
    let mut camera = camera.clone();
    camera.eye += camera.orientation * Vec3::new(0.07, 0.03, -0.05);
    camera
}

/// A frame, all of whose pixels are numbers.
pub(crate) fn frame(world: &World, lies: Option<&PublishedLies>, camera: &Camera) -> Film {
    let settings = FrameSettings {
        size: SIZE,
        samples_per_pixel: 1,
        ..FrameSettings::new(&world.scene().settings)
    };
    let lies = lies.map(|lies| lies as &dyn LieLookup);
    let (film, _) = render_frame(world, lies, camera, &settings, &mut |_| {});
    let is_sound = |radiance: &Vec3| radiance.is_finite() && radiance.min_element() >= 0.0;
    assert!(film.radiance().iter().all(is_sound));
    film
}

/// No number of samples is enough to be relied on.
const NEVER: u32 = 4_000_000_000;

/// Constructs LIEs of all of the world's views and calls `check` after so many passes each.
pub(crate) fn construct(
    world: &Arc<World>,
    settings: ConstructSettings,
    passes: &[u64],
    check: impl Fn(&PublishedLies),
) {
    let cameras = world.scene().cameras.iter();
    let views: Vec<View> = cameras
        .map(|camera| View {
            camera: camera.clone(),
            size: SIZE,
        })
        .collect();
    let pass = views.len() as u64 * u64::from(SIZE.x * SIZE.y);
    let mut builder = Builder::new(world.clone(), settings).unwrap();
    for count in passes {
        builder.sample(
            &views,
            (count * pass).saturating_sub(builder.taken()),
            |_| {},
        );
        builder.tree().validate().unwrap();
        check(&LieReplica::of(world.clone(), builder.tree()).publish());
    }
}

/// Calls `check` with the picture and the standard's from each place and from beside it.
fn compare_all(world: &World, lies: &PublishedLies, check: impl Fn(&str, &Film, &Film)) {
    for camera in &world.scene().cameras {
        for (what, camera) in [("at", camera.clone()), ("beside", beside(camera))] {
            let standard = frame(world, None, &camera);
            let picture = frame(world, Some(lies), &camera);
            check(
                &format!("{what} camera {}", camera.name),
                &picture,
                &standard,
            );
        }
    }
}

/// Mean over pixels and channels.
fn mean(film: &Film) -> f32 {
    let radiance = film.radiance();
    radiance.iter().map(|rgb| rgb.element_sum()).sum::<f32>() / (3.0 * radiance.len() as f32)
}

/// What geometry settles is right: the picture is the standard's, but for the order of sums.
fn check_proofs(world: &Arc<World>) {
    let mut settings = ConstructSettings::new(world.scene());
    settings.lie.trust = NEVER;
    settings.lie.split_samples = 16;
    construct(world, settings, &[1, 8], |lies| {
        compare_all(world, lies, |what, picture, standard| {
            let pixels = picture.radiance().iter().zip(standard.radiance());
            let least = 1.0e-2 * mean(standard);
            for (found, expected) in pixels {
                let room = 1.0e-5 * expected.max_element().max(least);
                assert!(
                    found.abs_diff_eq(*expected, room),
                    "{what}: {found} {expected}"
                );
            }
        });
    });
}

/// With the usual trust, too, what is relied on is right; beside the place that it was learnt from,
/// but for a pixel or two that nobody has looked at.
fn check_trust(world: &Arc<World>) {
    let settings = ConstructSettings::new(world.scene());
    construct(world, settings, &[1, 8, 64], |lies| {
        compare_all(world, lies, |what, picture, standard| {
            let figures = compare(picture, standard, 0.0).unwrap();
            let error = if what.starts_with("at") {
                figures.relative_rmse
            } else {
                figures.relative_rmse_p999
            };
            assert!(error < TOLERANCE, "{what}: {figures:?}");
        });
    });
}

/// Both, of lights without extent: of area lights samples alone tell mostly.
pub(crate) fn check(world: &Arc<World>) {
    check_proofs(world);
    check_trust(world);
}

/// By the rule of three, of rays that so many agreed on fewer than three in that number are
/// wrong (at 95 %). A pixel has four to each lamp.
pub(crate) fn check_samples(world: &Arc<World>, lamps: u32) {
    check_proofs(world);
    let settings = ConstructSettings::new(world.scene());
    let share = 3.0 / settings.lie.trust as f32;
    construct(world, settings, &[8, 64], |lies| {
        compare_all(world, lies, |what, picture, standard| {
            let least = 1.0e-2 * mean(standard);
            let pixels = picture.radiance().iter().zip(standard.radiance());
            let is_wrong = |(found, expected): &(&Vec3, &Vec3)| {
                !found.abs_diff_eq(**expected, 1.0e-4 * expected.max_element().max(least))
            };
            let wrong = pixels.filter(is_wrong).count();
            let most = 4.0 * lamps as f32 * share * picture.radiance().len() as f32;
            assert!((wrong as f32) < most, "{what}: {wrong} wrong pixels");
        });
    });
}
