//! Which points construction looks at, and in which order.

use std::{collections::BTreeSet, sync::Arc};

use lie_scene::{Mosque, mosque};

use glam::{UVec2, Vec3};

use super::*;
use crate::{Builder, ConstructSettings, View, construct::view::ViewProgress};

const SIZE: UVec2 = UVec2::new(96, 64);

fn world() -> Arc<World> {
    let scene = mosque(&Mosque {
        detail: 0.2,
        ..Mosque::default()
    });
    Arc::new(World::new(Arc::new(scene)))
}

fn view(world: &World, moved: f32) -> View {
    let mut camera = world.scene().cameras[0].clone();
    camera.eye += camera.orientation * Vec3::X * moved;
    View { camera, size: SIZE }
}

fn builder(world: &Arc<World>, trust: u32) -> Builder {
    let mut settings = ConstructSettings::new(world.scene());
    settings.lie.trust = trust;
    settings.lie.split_samples = 16;
    Builder::new(world.clone(), settings).unwrap()
}

/// A whole pass of a view, as it would be planned now.
fn sheet(world: &World, builder: &Builder, view: &View) -> Sheet {
    sheet_in(Order::Doubt, world, builder, view)
}

fn sheet_in(order: Order, world: &World, builder: &Builder, view: &View) -> Sheet {
    later_sheet(order, 0, world, builder, view)
}

/// The same after some passes.
fn later_sheet(order: Order, passes: u64, world: &World, builder: &Builder, view: &View) -> Sheet {
    let mut progress = ViewProgress::new(view.clone(), 0, 0);
    progress.passes = passes;
    let squares: Vec<Square> = Square::all(SIZE).collect();
    let weighing = Weighing {
        world,
        tree: builder.tree(),
        order,
        prover: builder.prover.as_ref(),
    };
    Sheet::new(weighing, progress.rays(), &squares)
}

fn points(sheet: &Sheet) -> u64 {
    let places = sheet.clusters.iter().map(|cluster| cluster.places.len());
    places.sum::<usize>() as u64
}

#[test]
fn every_surface_point_of_an_unknown_view_is_worth_one_sample() {
    let world = world();
    for trust in [0, 512] {
        let sheet = sheet(&world, &builder(&world, trust), &view(&world, 0.0));
        let mut seen = BTreeSet::new();
        for cluster in &sheet.clusters {
            assert!((1..=MOST).contains(&cluster.places.len()));
            for place in &cluster.places {
                assert!(seen.insert(place.pixel.to_array()), "{place:?} comes twice");
            }
        }
        let pixels = u64::from(SIZE.x * SIZE.y);
        assert_eq!((points(&sheet) + sheet.rest, sheet.answered), (pixels, 0));
        assert!(points(&sheet) > pixels / 2, "the view shows something");
    }
}

#[test]
fn what_is_settled_is_passed_over_but_for_the_papers_mode() {
    let world = world();
    let view = view(&world, 0.0);
    for (trust, is_less) in [(0, false), (512, true)] {
        let mut builder = builder(&world, trust);
        let before = sheet(&world, &builder, &view);
        builder.sample(
            std::slice::from_ref(&view),
            u64::from(SIZE.x * SIZE.y),
            |_| {},
        );
        let after = sheet(&world, &builder, &view);
        assert_eq!(points(&after) < points(&before), is_less, "trust {trust}");
        assert_eq!(after.answered > 0, is_less, "trust {trust}");
    }
}

#[test]
fn in_the_order_of_space_every_point_comes_in_its_place() {
    let world = world();
    let view = view(&world, 0.0);
    let mut builder = builder(&world, 512);
    let before = points(&sheet(&world, &builder, &view));
    builder.sample(
        std::slice::from_ref(&view),
        u64::from(SIZE.x * SIZE.y),
        |_| {},
    );
    let sheet = sheet_in(Order::Space, &world, &builder, &view);
    assert_eq!((points(&sheet), sheet.answered), (before, 0));
    // The last is taken first.
    let taken = sheet.clusters.iter().rev();
    let codes: Vec<u64> = taken
        .flat_map(|cluster| cluster.places.iter().map(Place::code))
        .collect();
    assert!(codes.is_sorted());
}

#[test]
fn what_a_survey_left_open_is_worth_samples_in_later_passes() {
    let world = world();
    let mut builder = builder(&world, 512);
    let view = view(&world, 0.0);
    let pixels = u64::from(SIZE.x * SIZE.y);
    builder.sample(std::slice::from_ref(&view), pixels, |_| {});
    let survey = sheet(&world, &builder, &view);
    // It asks points of light alone, and has tried all of these.
    assert!(points(&survey) < pixels / 50, "{}", points(&survey));
    assert!(survey.answered < survey.evaluated);
    let second = later_sheet(Order::Doubt, 2, &world, &builder, &view);
    assert!(points(&second) > pixels / 4, "{}", points(&second));
    assert!(
        second.rest > pixels / 50,
        "some is settled: {}",
        second.rest
    );
}

#[test]
fn new_parts_of_a_moving_view_come_first() {
    let world = world();
    let mut builder = builder(&world, 512);
    let first = view(&world, 0.0);
    builder.sample(&[first], u64::from(SIZE.x * SIZE.y), |_| {});
    let moved = view(&world, 1.5);
    let is_new = |place: &&Place| {
        let lie = builder.tree().lie_at(place.origin);
        !lie.region().bounds.contains(place.origin)
    };
    let doubt = |cluster: &Cluster| {
        let new = cluster.places.iter().filter(is_new).count();
        new as f32 / cluster.places.len() as f32
    };
    // A survey has nothing to learn of what is known.
    let survey = sheet(&world, &builder, &moved);
    assert!(points(&survey) > 0 && survey.clusters.iter().all(|cluster| doubt(cluster) == 1.0));
    let moved = later_sheet(Order::Doubt, 2, &world, &builder, &moved);
    // The last is taken first.
    let ranks: Vec<u32> = moved.clusters.iter().map(|cluster| cluster.rank).collect();
    assert!(ranks.is_sorted());
    assert!(ranks[0] < ranks[ranks.len() - 1], "{ranks:?}");
    let half = moved.clusters.len() / 2;
    let mean = |clusters: &[Cluster]| clusters.iter().map(doubt).sum::<f32>() / half as f32;
    let (known, new) = (mean(&moved.clusters[..half]), mean(&moved.clusters[half..]));
    assert!(
        new > known,
        "{new} of what comes first is new, {known} of the rest"
    );
}

#[test]
fn neighbours_are_joined_in_the_order_of_their_places() {
    let world = world();
    let sheet = sheet(&world, &builder(&world, 512), &view(&world, 0.0));
    let all = points(&sheet);
    let joined = join(sheet.clusters);
    let codes: Vec<u64> = joined.iter().flatten().map(Place::code).collect();
    assert_eq!(codes.len() as u64, all);
    assert!(codes.is_sorted());
    assert!(joined.iter().all(|places| places.len() <= MOST));
    let small = joined
        .windows(2)
        .filter(|pair| pair[0].len() + pair[1].len() <= MOST);
    assert_eq!(small.count(), 0);
}
