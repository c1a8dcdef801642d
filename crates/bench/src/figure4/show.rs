use glam::{UVec2, Vec3};
use lie_render::{CostModel, Film, ToneCurve, ToneMap};
use serde_json::{Value, json};

use super::{CostRow, SceneCosts};
use crate::{
    Contender, Figure, Panel, Picture, Section, Stage, Table,
    report::file_stem,
    table::{or_dash, percent},
};

/// Costs of all scenes.
#[must_use]
pub fn table(rows: &[CostRow]) -> Table {
    let numbers = [
        "mean cost µs",
        "measured µs",
        "evaluations",
        "occluder tests",
        "shadow rays",
        "cheaper pixels",
        "saved",
        "rel. RMSE",
        "FLIP",
    ];
    let mut table = Table::new(&["scene", "integrator"], &numbers);
    for row in rows {
        let per_ray = |count: u64| count as f64 / row.work.primary_rays.max(1) as f64;
        table.push([
            row.scene.clone(),
            row.contender.name().to_owned(),
            format!("{:.2}", row.cost_us),
            format!("{:.2}", row.measured_us),
            format!("{:.1}", per_ray(row.work.evaluations())),
            format!("{:.1}", per_ray(row.work.occluder_tests())),
            format!("{:.2}", per_ray(row.work.shadow_rays)),
            or_dash(row.cheaper_pixels, percent),
            or_dash(row.saved, percent),
            percent(row.relative_rmse),
            format!("{:.5}", row.flip_mean),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[CostRow]) -> Value {
    rows.iter().map(row_json).collect()
}

fn row_json(row: &CostRow) -> Value {
    let (work, stats) = (&row.work, &row.stats);
    json!({
        "scene": row.scene,
        "path": row.path,
        "camera": row.camera,
        "integrator": row.contender.name(),
        "mean_cost_us": row.cost_us,
        "mean_measured_us": row.measured_us,
        "cheaper_pixels": row.cheaper_pixels,
        "saved": row.saved,
        "relative_rmse": row.relative_rmse,
        "flip_mean": row.flip_mean,
        "work": {
            "primary_rays": work.primary_rays,
            "lane_evaluations": work.lane_evaluations,
            "single_evaluations": work.single_evaluations,
            "list_rays": work.list_rays,
            "lane_tests": work.lane_tests,
            "shadow_rays": work.shadow_rays,
        },
        "measured_ns": {
            "visibility": stats.visibility_ns,
            "unoccluded": stats.unoccluded_ns,
            "partial": stats.partial_ns,
            "full": stats.full_ns,
        },
    })
}

/// The section of a report, with one panel for each scene.
#[must_use]
pub fn section(rows: &[CostRow], panels: Vec<Panel>) -> Section {
    let CostModel {
        primary_ray_ns,
        lane_evaluation_ns,
        single_evaluation_ns,
        lane_test_ns,
        shadow_ray_ns,
    } = CostModel::default();
    let model = format!(
        "What each pixel costs, as in the paper's Figure 4. The cost is counted, not timed, so \
         that it is the same on every machine: nanoseconds of one thread, of {primary_ray_ns} \
         for a camera ray, {lane_evaluation_ns} for a light or sample point on a light evaluated \
         with sixteen pixels at a time, {single_evaluation_ns} for one evaluated alone, \
         {lane_test_ns} for a ray and a triangle of an occluder list, and {shadow_ray_ns} for a \
         shadow ray through the scene. *Measured* is the time that this machine took for the same frame, \
         once, on each thread, by the number of pixels: how far the model can be relied on."
    );
    let pictures = "In the pictures light is in proportion to cost: black is nothing, white is \
        said below each. Both pictures of LIEs have the same scale, and white is what one pixel \
        in a hundred exceeds without masking; the standard's has its own. *Cheaper pixels* is \
        the share of pixels that cost less with masking than without, *saved* the share of the \
        whole cost; evaluations, tests and shadow rays are per camera ray.";
    Section {
        heading: "Figure 4: cost of each pixel".to_owned(),
        paragraphs: vec![model, pictures.to_owned()],
        tables: vec![table(rows)],
        panels,
        ..Section::default()
    }
}

/// A scene's picture and the standard's cost, and below them the costs without masking and
/// with it.
#[must_use]
pub fn panel(stage: &Stage, costs: &SceneCosts) -> Panel {
    let stem = file_stem(stage.name());
    let mut figures = vec![Figure {
        name: format!("figure4-{stem}.png"),
        caption: format!("{}, camera {}", stage.name(), stage.camera().name),
        picture: Picture::Frame(costs.picture.clone(), stage.tone_map()),
    }];
    let white_of = |contender: Contender| {
        let mut all = costs.rows.iter().zip(&costs.costs_us);
        let found = all.find(|(row, _)| row.contender == contender);
        found.map(|(_, costs_us)| white_us(costs_us))
    };
    // In two columns: without and with masking beside each other, as in the paper.
    for wanted in [Contender::Standard, Contender::Lie, Contender::LieMasked] {
        let mut all = costs.rows.iter().zip(&costs.costs_us);
        let Some((row, costs_us)) = all.find(|(row, _)| row.contender == wanted) else {
            continue;
        };
        let scale = match wanted {
            Contender::LieMasked => white_of(Contender::Lie),
            _ => None,
        };
        let white_us = scale.unwrap_or_else(|| white_us(costs_us));
        let (name, mean_us) = (wanted.name(), row.cost_us);
        figures.push(Figure {
            name: format!("figure4-{stem}-{name}.png"),
            caption: format!("cost of {name}: white is {white_us} µs, the mean {mean_us:.2} µs"),
            picture: grey(stage.settings().size, costs_us, white_us),
        });
    }
    Panel {
        columns: 2,
        figures,
    }
}

/// What one pixel in a hundred exceeds, rounded up to two digits; 1 where that is nothing.
fn white_us(costs_us: &[f32]) -> f32 {
    let mut sorted = costs_us.to_vec();
    sorted.sort_by(f32::total_cmp);
    let exceeded = sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(0.0);
    if !(exceeded > 0.0 && exceeded.is_finite()) {
        return 1.0;
    }
    let step = 10f64.powf(f64::from(exceeded).log10().floor() - 1.0);
    ((f64::from(exceeded) / step).ceil() * step) as f32
}

/// Costs as shades of grey.
fn grey(size: UVec2, costs_us: &[f32], white_us: f32) -> Picture {
    let shades = costs_us.iter().map(|cost| Vec3::splat(cost / white_us));
    let film = Film::from_radiance(size, shades.collect());
    let tone_map = ToneMap {
        exposure_stops: 0.0,
        curve: ToneCurve::Linear,
    };
    Picture::Frame(film.unwrap_or_else(|| Film::new(size)), tone_map)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_a_round_number_that_one_in_a_hundred_exceeds() {
        let costs: Vec<f32> = (0..1000).map(|index| index as f32 * 0.01234).collect();
        let white = white_us(&costs);
        assert_eq!(white, 13.0);
        assert!(costs.iter().filter(|&&cost| cost > white).count() <= 10);
        assert_eq!(white_us(&[]), 1.0);
        assert_eq!(white_us(&[0.0; 7]), 1.0);
        assert_eq!(white_us(&[0.0123]), 0.013);
    }

    #[test]
    fn grey_is_in_proportion() {
        let picture = grey(UVec2::new(2, 1), &[0.0, 5.0], 10.0);
        let Picture::Frame(film, _) = picture else {
            panic!("a frame");
        };
        assert_eq!(film.radiance(), [Vec3::ZERO, Vec3::splat(0.5)]);
    }
}
