use std::sync::Arc;

use super::*;
use crate::{
    Film, ImageError, LightSet, Precision, RenderStats, luminance, read_image, render_frame,
};

/// The same cell everywhere.
struct OneCell(LieCell);

impl LieLookup for OneCell {
    fn cell(&self, _: Vec3) -> &LieCell {
        &self.0
    }
}

fn gallery() -> World {
    let gallery = lie_scene::Gallery {
        detail: 0.25,
        ..lie_scene::Gallery::default()
    };
    World::new(Arc::new(lie_scene::gallery(&gallery)))
}

/// Every third light unoccluded, every third behind some triangles, every third traced.
fn mixed_cell(world: &World) -> LieCell {
    mixed_cell_of(0..world.scene().lights.len() as u32)
}

/// The same of some lights.
fn mixed_cell_of(lights: std::ops::Range<u32>) -> LieCell {
    let occluders: Vec<u32> = (0..30).map(|index| 7 * index).collect();
    let list = |light: u32| &occluders[..(light as usize % 5 + 1) * 6];
    let known = lights.clone().filter(|light| light % 3 < 2);
    let known = known.map(|light| (light, if light % 3 == 0 { &[][..] } else { list(light) }));
    LieCell::new(known, lights.filter(|light| light % 3 == 2).collect())
}

const FACTS: CellFacts = CellFacts {
    depth: 4,
    samples: 77,
    masked: 0,
};

fn settings(world: &World, samples_per_pixel: u32) -> FrameSettings {
    FrameSettings {
        size: UVec2::new(40, 24),
        samples_per_pixel,
        light_samples: 4,
        ..FrameSettings::new(&world.scene().settings)
    }
}

fn aovs(world: &World, cell: Option<&OneCell>, settings: &FrameSettings) -> Aovs {
    let camera = &world.scene().cameras[0];
    let lies = cell.map(|cell| AovLies {
        lookup: cell,
        facts: &|_| FACTS,
        odds: None,
    });
    Aovs::render(world, lies, camera, settings, &mut |_| {})
}

fn stats(world: &World, cell: Option<&OneCell>, settings: &FrameSettings) -> RenderStats {
    let lies = cell.map(|cell| cell as &dyn LieLookup);
    let camera = &world.scene().cameras[0];
    render_frame(world, lies, camera, settings, &mut |_| {}).1
}

#[test]
fn what_is_counted_is_what_the_renderer_does() {
    let world = gallery();
    let cell = OneCell(mixed_cell(&world));
    for (cell, ward) in [(None, None), (None, Some(0.05)), (Some(&cell), None)] {
        for samples in [1, 3] {
            let settings = FrameSettings {
                ward,
                ..settings(&world, samples)
            };
            let total = aovs(&world, cell, &settings).total();
            let stats = stats(&world, cell, &settings);
            assert_eq!(total.primary_rays, stats.primary_rays);
            assert_eq!(total.shadow_rays, stats.shadow_rays);
            assert_eq!(total.list_rays, stats.list_rays);
            assert_eq!(total.occluder_tests(), stats.occluder_tests);
            assert_eq!(total.list_rays > 0, cell.is_some());
            assert!(total.shadow_rays > 0);
        }
    }
}

#[test]
fn a_light_less_never_costs_more() {
    let world = gallery();
    let settings = settings(&world, 1);
    let whole = OneCell(mixed_cell(&world));
    let part = OneCell(mixed_cell_of(0..world.scene().lights.len() as u32 - 3));
    let model = CostModel::default();
    let cost = |cell| {
        let aovs = aovs(&world, Some(cell), &settings);
        let costs = aovs.pixels.iter().map(|pixel| model.cost_ns(&pixel.work));
        costs.collect::<Vec<f64>>()
    };
    let (whole, part) = (cost(&whole), cost(&part));
    assert!(whole.iter().zip(&part).all(|(whole, part)| part <= whole));
    assert!(part.iter().sum::<f64>() < whole.iter().sum());
}

#[test]
fn classes_add_up_to_all_lights() {
    let world = gallery();
    let cell = OneCell(mixed_cell(&world));
    let aovs = aovs(&world, Some(&cell), &settings(&world, 2));
    let lights = world.scene().lights.len() as f32;
    let mut seen = 0;
    for pixel in aovs.pixels() {
        let cell = pixel.cell.unwrap();
        if cell == CellAov::default() {
            continue;
        }
        seen += 1;
        let sum = cell.unoccluded + cell.partial + cell.traced + cell.masked + cell.hidden;
        assert!((sum - lights).abs() < 1.0e-3, "{cell:?}");
        assert_eq!((cell.depth, cell.samples), (4.0, 77.0));
        assert!(pixel.normal.length() < 1.0 + 1.0e-5);
        assert!(pixel.albedo.min_element() >= 0.0 && pixel.albedo.max_element() <= 1.0);
    }
    assert!(seen > 0);
}

/// Errors to be expected of each pixel if every light is wrong with these odds, all of it at once.
fn expected_errors(world: &World, cell: &OneCell, settings: &FrameSettings, odds: f32) -> Aovs {
    let camera = &world.scene().cameras[0];
    let lights = world.scene().lights.len();
    let together = RayOdds {
        one: odds,
        two: odds,
    };
    let lies = AovLies {
        lookup: cell,
        facts: &|_| FACTS,
        odds: Some(&|_, all| all.extend(std::iter::repeat_n(together, lights))),
    };
    Aovs::render(world, Some(lies), camera, settings, &mut |_| {})
}

#[test]
fn a_cell_that_is_surely_wrong_is_off_by_all_that_it_answers() {
    let world = World::new(Arc::new(lie_scene::cornell_box()));
    let settings = settings(&world, 1);
    let camera = &world.scene().cameras[0];
    let dark = OneCell(LieCell::default());
    let lit = OneCell(LieCell::new(
        std::iter::once((0, &[][..])),
        LightSet::default(),
    ));
    let traced = OneCell(LieCell::new(
        std::iter::empty(),
        std::iter::once(0).collect(),
    ));
    let picture = |cell| render_frame(&world, Some(cell), camera, &settings, &mut |_| {}).0;
    let (lit_picture, dark_picture) = (picture(&lit), picture(&dark));
    for (odds, share) in [(1.0, 1.0), (0.25, 0.5), (0.0, 0.0)] {
        // √p w, and w is the light without shadows.
        let found = expected_errors(&world, &lit, &settings, odds);
        let mut sum = 0.0;
        for (index, pixel) in found.pixels().iter().enumerate() {
            let whole = lit_picture.radiance()[index] - dark_picture.radiance()[index];
            let expected = share * luminance(whole);
            let error = pixel.cell.unwrap().expected_error;
            assert!(
                (error - expected).abs() < 1.0e-3 * (1.0 + expected),
                "{error} is not {expected}"
            );
            sum += f64::from(error * error);
        }
        let rmse = (sum / found.pixels().len() as f64).sqrt();
        assert!((found.expected_rmse() - rmse).abs() < 1.0e-6 * (1.0 + rmse));
        assert_eq!(rmse > 0.0, odds > 0.0);
    }
    // What is left out may be missing as a whole, exact rays and all.
    assert!(expected_errors(&world, &dark, &settings, 0.25).expected_rmse() > 0.0);
    assert_eq!(
        expected_errors(&world, &traced, &settings, 1.0).expected_rmse(),
        0.0
    );
}

#[test]
fn where_nothing_is_seen_there_is_only_the_ray() {
    let world = gallery();
    let away = Camera::look_at("away", Vec3::splat(1.0e4), Vec3::splat(2.0e4), Vec3::Y, 0.5);
    let settings = settings(&world, 2);
    let aovs = Aovs::render(&world, None, &away, &settings, &mut |_| {});
    let nothing = AovPixel {
        work: Work {
            primary_rays: 2,
            ..Work::default()
        },
        ..AovPixel::default()
    };
    assert!(aovs.pixels().iter().all(|pixel| *pixel == nothing));
}

#[test]
fn the_file_holds_the_picture_and_the_same_bytes_each_time() {
    let world = gallery();
    let settings = settings(&world, 1);
    let camera = &world.scene().cameras[0];
    let (film, _) = render_frame(&world, None, camera, &settings, &mut |_| {});
    let aovs = aovs(&world, None, &settings);
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.exr", "b.exr"].map(|name| folder.path().join(name));
    for path in &paths {
        write_aovs(path, &film, Precision::Half, &aovs).unwrap();
    }
    assert_eq!(
        read_image(&paths[0]).unwrap(),
        film.clone().quantized(Precision::Half)
    );
    let [a, b] = paths.map(|path| std::fs::read(path).unwrap());
    assert!(a == b);
    let other = Film::new(UVec2::ONE);
    let path = folder.path().join("c.exr");
    assert!(matches!(
        write_aovs(&path, &other, Precision::Float, &aovs),
        Err(ImageError::Sizes(..))
    ));
    assert!(
        write_aovs(
            &folder.path().join("no/c.exr"),
            &film,
            Precision::Float,
            &aovs
        )
        .is_err()
    );
}
