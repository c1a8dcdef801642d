use std::sync::atomic::AtomicBool;

use glam::Vec3;

use super::Work;
use crate::{FrameSettings, LieCell, LightPoints, World, cell_answers::CellAnswers, ward};

/// Counts what [`crate::render_tile`] does at a surface point, stage by stage as there.
pub(super) fn count_point(
    world: &World,
    settings: &FrameSettings,
    answers: Option<&CellAnswers<'_>>,
    points: &LightPoints<'_>,
    work: &mut Work,
) {
    match (answers, settings.ward) {
        (Some(answers), _) => {
            let cell = answers.cell();
            count_unoccluded(world, cell, points, work);
            count_partial(world, answers, points, work);
            count_traced(world, cell.traced.iter(), points, work);
        }
        (None, None) => count_traced(world, all_lights(world), points, work),
        // It traces the rays along the lobe as well, and counts them.
        (None, Some(threshold)) => return count_ward(world, threshold, points, work),
    }
    if world.has_lobe_lights() {
        let mut directions = vec![];
        points.lobe_directions(&mut directions);
        world.for_each_lobe_ray(points, &directions, |_| work.shadow_rays += 1);
    }
}

fn count_unoccluded(world: &World, cell: &LieCell, points: &LightPoints<'_>, work: &mut Work) {
    for light in cell.unoccluded.iter() {
        work.lane_evaluations += points.evaluations(world, light, true);
        world.for_each_light_ray(light, points, |ray| {
            work.shadow_rays += u64::from(ray.exact);
        });
    }
}

fn count_partial(
    world: &World,
    answers: &CellAnswers<'_>,
    points: &LightPoints<'_>,
    work: &mut Work,
) {
    for (light, occluders) in answers.cell().partial.lights() {
        let is_clear = answers.is_clear(light, points.surface.shadow_origin);
        work.lane_evaluations += points.evaluations(world, light, is_clear);
        world.for_each_light_ray(light, points, |ray| {
            if ray.exact {
                work.shadow_rays += 1;
            } else if !is_clear {
                work.list_rays += 1;
                work.lane_tests += occluders;
            }
        });
    }
}

fn count_traced(
    world: &World,
    lights: impl Iterator<Item = u32>,
    points: &LightPoints<'_>,
    work: &mut Work,
) {
    for light in lights {
        work.lane_evaluations += points.evaluations(world, light, false);
        world.for_each_light_ray(light, points, |_| work.shadow_rays += 1);
    }
}

/// Which lights are tested depends on what the tests find: they are made.
fn count_ward(world: &World, threshold: f32, points: &LightPoints<'_>, work: &mut Work) {
    let evaluations = all_lights(world).map(|light| points.evaluations(world, light, false));
    work.single_evaluations += evaluations.sum::<u64>();
    let never = AtomicBool::new(false);
    let point = std::iter::once((0, *points));
    let traced = ward::shade(world, threshold, point, &mut [Vec3::ZERO], &never);
    work.shadow_rays += traced.unwrap_or(0);
}

fn all_lights(world: &World) -> std::ops::Range<u32> {
    0..world.scene().lights.len() as u32
}
