//! From points to cells, and what it takes to open one.
//!
//! `cargo bench --bench descent` prints points, or cells, per second.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod fixture;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixture::{Seen, brief, construct, gallery};
use glam::Vec3;
use lie_farm::{Builder, LieReplica, PublishedLies};
use lie_geom::RandomKey;
use lie_octree::{CellBody, LieTree, PackedLie};
use lie_render::{LieCell, LieLookup};

/// A view's points, and what was learnt of the cells around them.
struct Case {
    builder: Builder,
    lies: PublishedLies,
    /// In the order in which a frame asks for them, and in no order at all.
    points: [(&'static str, Vec<Vec3>); 2],
}

impl Case {
    fn new() -> Self {
        let seen = Seen::new(gallery());
        let builder = construct(&seen.world);
        assert!(
            lights_known_of(builder.tree()) > 0,
            "construction found lights"
        );
        let coherent = seen.points();
        Self {
            lies: LieReplica::of(seen.world, builder.tree()).publish(),
            builder,
            points: [("scattered", shuffled(&coherent)), ("coherent", coherent)],
        }
    }
}

fn shuffled(points: &[Vec3]) -> Vec<Vec3> {
    let key = RandomKey::new(3);
    let mut keyed: Vec<(f32, Vec3)> = (0..)
        .map(|at| key.uniform(at))
        .zip(points.iter().copied())
        .collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
    keyed.into_iter().map(|(_, point)| point).collect()
}

fn lights_known_of(tree: &LieTree) -> usize {
    let states = tree.keys().into_iter().filter_map(|key| tree.state(key));
    states
        .map(|state| match state.body {
            CellBody::Leaf(lie) => lie.lights.len(),
            CellBody::Inner => 0,
        })
        .sum()
}

fn descent(criterion: &mut Criterion) {
    let case = Case::new();
    let (lies, tree) = (&case.lies, case.builder.tree());
    let mut group = criterion.benchmark_group("descent to a cell");
    for (order, points) in &case.points {
        group.throughput(Throughput::Elements(points.len() as u64));
        let of = |what: &str| format!("{order} points, {what}");
        group.bench_function(of("shader's copy, one by one"), |bencher| {
            bencher.iter(|| -> usize {
                let cells = points
                    .iter()
                    .map(|&point| std::ptr::from_ref(lies.cell(point)).addr());
                cells.fold(0, |sum, address| sum ^ address)
            });
        });
        group.bench_function(of("shader's copy, together"), |bencher| {
            let mut found: Vec<&LieCell> = Vec::with_capacity(points.len());
            bencher.iter(|| {
                found.clear();
                lies.cells(points, &mut found);
                found.len()
            });
        });
        group.bench_function(of("constructor's tree"), |bencher| {
            bencher.iter(|| -> usize {
                let cells = points
                    .iter()
                    .map(|&point| std::ptr::from_ref(tree.packed_at(point)).addr());
                cells.fold(0, |sum, address| sum ^ address)
            });
        });
        group.bench_function(of("constructor's tree, opened"), |bencher| {
            bencher.iter(|| -> usize {
                let lies = points.iter().map(|&point| tree.lie_at(point));
                lies.map(|lie| lie.lights().count()).sum()
            });
        });
    }
    group.finish();
}

/// The constructor's cells at rest: opened to be read or changed, and closed again.
fn packed_cells(criterion: &mut Criterion) {
    let case = Case::new();
    let tree = case.builder.tree();
    let (_, points) = &case.points[0];
    let packed: Vec<PackedLie> = points
        .iter()
        .take(2000)
        .map(|&point| tree.packed_at(point).clone())
        .collect();
    let open: Vec<_> = packed.iter().map(PackedLie::unpack).collect();
    let mut group = criterion.benchmark_group("packed cells");
    group.throughput(Throughput::Elements(packed.len() as u64));
    group.bench_function("open", |bencher| {
        bencher.iter(|| -> usize {
            packed
                .iter()
                .map(|cell| cell.unpack().lights().count())
                .sum()
        });
    });
    group.bench_function("pack", |bencher| {
        bencher.iter(|| open.iter().map(PackedLie::of).collect::<Vec<_>>());
    });
    group.finish();
}

criterion_group! {
    name = cells;
    config = brief();
    targets = descent, packed_cells
}
criterion_main!(cells);
