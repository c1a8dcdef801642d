//! The kernels that a frame's time goes to, on the gallery: rays through the hierarchy,
//! occluder lists, the descent to a cell, and light at a point.
//!
//! `cargo bench --bench kernels` prints time and throughput of each. Compare lines of one
//! run with each other; times from two machines, or two days, say little.

#![allow(missing_docs, reason = "criterion's macros make public functions")]
#![allow(clippy::unwrap_used)]

use std::{hint::black_box, sync::Arc, sync::atomic::AtomicBool, time::Duration};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{UVec2, Vec2, Vec3};
use lie_accel::{AccelKind, BlockPart, FanOccluders, OccluderBlocks, PACKET, RayPacket};
use lie_farm::{Builder, ConstructSettings, LieReplica, View};
use lie_geom::{Aabb, RandomKey, Ray};
use lie_octree::{CellBody, LieTree};
use lie_render::{FrameSettings, LieLookup, Tile, World, render_tile};
use lie_scene::Surface;

/// A packet's worth of pixels: the film is cut in squares of 4 × 4.
const SIDE: u32 = 4;
const FILM: UVec2 = UVec2::new(128, 96);

fn gallery() -> Arc<World> {
    let scene = lie_scene::gallery(&lie_scene::Gallery::default());
    Arc::new(World::new(Arc::new(scene)))
}

/// Camera rays, square by square.
fn camera_rays(world: &World) -> Vec<Ray> {
    let camera = &world.scene().cameras[0];
    let squares = FILM / SIDE;
    (0..squares.x * squares.y)
        .flat_map(|square| {
            let origin = UVec2::new(square % squares.x, square / squares.x) * SIDE;
            (0..SIDE * SIDE).map(move |lane| origin + UVec2::new(lane % SIDE, lane / SIDE))
        })
        .map(|pixel| camera.ray(pixel.as_vec2() + 0.5, FILM))
        .collect()
}

fn surfaces(world: &World) -> Vec<Surface> {
    let rays = camera_rays(world);
    rays.iter()
        .filter_map(|ray| world.first_surface(ray))
        .collect()
}

/// Shadow rays to one light after the other, as shading sends them.
fn shadow_rays(world: &World, surfaces: &[Surface]) -> Vec<Ray> {
    let lights = &world.scene().lights;
    let key = RandomKey::new(1);
    let mut rays = vec![];
    for (index, light) in lights.iter().enumerate().step_by(5) {
        for (number, surface) in surfaces.iter().enumerate().step_by(3) {
            let square = key.mix(index as u64).uniform2(number as u32);
            let sample = light.sample(surface.position, square, world.reach());
            let facing = sample.filter(|sample| surface.geometric_normal.dot(sample.wi) > 0.0);
            rays.extend(facing.map(|sample| Ray::segment(surface.shadow_origin, sample.target)));
        }
    }
    rays
}

fn packets(rays: &[Ray]) -> Vec<RayPacket> {
    rays.chunks(PACKET).map(RayPacket::new).collect()
}

fn rays(criterion: &mut Criterion) {
    let world = gallery();
    let camera_rays = camera_rays(&world);
    let shadow_rays = shadow_rays(&world, &surfaces(&world));
    let accel = world.accel();

    let mut group = criterion.benchmark_group("camera rays");
    group.throughput(Throughput::Elements(camera_rays.len() as u64));
    group.bench_function("closest, single", |bencher| {
        bencher.iter(|| {
            camera_rays
                .iter()
                .filter_map(|ray| accel.closest(ray))
                .count()
        });
    });
    let camera_packets = packets(&camera_rays);
    group.bench_function("closest, packets of 16", |bencher| {
        bencher.iter(|| {
            for packet in &camera_packets {
                black_box(accel.closest_packet(packet));
            }
        });
    });
    group.finish();

    let mut group = criterion.benchmark_group("shadow rays");
    group.throughput(Throughput::Elements(shadow_rays.len() as u64));
    group.bench_function("blocker, single", |bencher| {
        bencher.iter(|| {
            shadow_rays
                .iter()
                .filter_map(|ray| accel.blocker(ray))
                .count()
        });
    });
    let shadow_packets = packets(&shadow_rays);
    group.bench_function("blocked, packets of 16", |bencher| {
        bencher.iter(|| -> u32 {
            let blocked = shadow_packets
                .iter()
                .map(|packet| accel.blocked_packet(packet));
            blocked.map(u32::count_ones).sum()
        });
    });
    group.finish();
}

/// The paper's grid against the hierarchy, ray by ray, on two scenes.
fn structures(criterion: &mut Criterion) {
    let bar = lie_scene::bar(&lie_scene::Bar::default());
    for (name, world) in [
        ("gallery", gallery()),
        ("bar", Arc::new(World::new(Arc::new(bar)))),
    ] {
        let camera_rays = camera_rays(&world);
        let shadow_rays = shadow_rays(&world, &surfaces(&world));
        for kind in [AccelKind::Bvh, AccelKind::Grid] {
            let accel = kind.build(&world.scene().geometry, None);
            let mut group = criterion.benchmark_group(format!("structures, {name}"));
            group.throughput(Throughput::Elements(camera_rays.len() as u64));
            group.bench_function(format!("camera rays, {}", kind.name()), |bencher| {
                bencher.iter(|| {
                    let found = camera_rays.iter().filter_map(|ray| accel.closest(ray));
                    found.count()
                });
            });
            group.throughput(Throughput::Elements(shadow_rays.len() as u64));
            group.bench_function(format!("shadow rays, {}", kind.name()), |bencher| {
                bencher.iter(|| {
                    let blocked = shadow_rays.iter().filter(|ray| accel.is_blocked(ray));
                    blocked.count()
                });
            });
            group.throughput(Throughput::Elements(world.scene().geometry.len() as u64));
            group.bench_function(format!("build, {}", kind.name()), |bencher| {
                bencher.iter(|| kind.build(&world.scene().geometry, None));
            });
            group.finish();
        }
    }
}

fn occluder_lists(criterion: &mut Criterion) {
    let world = gallery();
    let shadow_rays = shadow_rays(&world, &surfaces(&world));
    let accel = world.accel();
    // Triangles that do come in between somewhere, as in a cell's lists.
    let mut blockers: Vec<u32> = shadow_rays
        .iter()
        .filter_map(|ray| accel.blocker(ray))
        .collect();
    blockers.sort_unstable();
    blockers.dedup();
    let packets = packets(&shadow_rays);
    let mut group = criterion.benchmark_group("occluder lists");
    group.throughput(Throughput::Elements(shadow_rays.len() as u64));
    for length in [1, 8, 24, 96] {
        let stride = (blockers.len() / length).max(1);
        let list = blockers.iter().copied().step_by(stride).take(length);
        let list: Vec<u32> = list.collect();
        let shapes = list.iter().map(|&index| *world.triangle(index).unwrap());
        let mut blocks = OccluderBlocks::default();
        blocks.fill(&list, &shapes.collect::<Vec<_>>());
        let parts = list
            .chunks(PACKET)
            .zip(0..)
            .map(|(chunk, block)| BlockPart {
                block,
                places: ((1u32 << chunk.len()) - 1) as u16,
            });
        let parts: Vec<BlockPart> = parts.collect();
        group.bench_function(format!("{length} triangles, any rays"), |bencher| {
            bencher.iter(|| -> u32 {
                let blocked = packets
                    .iter()
                    .map(|packet| packet.blocked_by_parts(&blocks, &parts, None));
                blocked.map(u32::count_ones).sum()
            });
        });
        let apex = shadow_rays[0].at(1.0);
        let fans: Vec<(RayPacket, Aabb)> = shadow_rays
            .chunks(PACKET)
            .map(|rays| fan(apex, rays))
            .collect();
        group.bench_function(format!("{length} triangles, from one light"), |bencher| {
            let mut seen = FanOccluders::default();
            bencher.iter(|| -> u32 {
                seen.look_from(apex.to_array(), &blocks, &parts);
                let blocked = fans
                    .iter()
                    .map(|(packet, ends)| packet.blocked_by_fan(&seen, *ends, None));
                blocked.map(u32::count_ones).sum()
            });
        });
    }
    group.finish();
}

/// The rays from a light to where some rays start, and a box around those places.
fn fan(apex: Vec3, rays: &[Ray]) -> (RayPacket, Aabb) {
    let mut ends = [[0.0; PACKET]; 3];
    for (lane, ray) in rays.iter().enumerate() {
        for axis in 0..3 {
            ends[axis][lane] = ray.origin[axis];
        }
    }
    let lanes = (1u32 << rays.len()) - 1;
    let bounds = Aabb::around(rays.iter().map(|ray| ray.origin));
    (RayPacket::fan(apex.to_array(), &ends, lanes), bounds)
}

/// LIEs of the film's view after some passes over it.
fn construct(world: &Arc<World>) -> Builder {
    let mut settings = ConstructSettings::new(world.scene());
    // As in the paper: what is known is used, so that every kind of light is met.
    settings.lie.trust = 0;
    let view = View {
        camera: world.scene().cameras[0].clone(),
        size: FILM,
    };
    let mut builder = Builder::new(world.clone(), settings).unwrap();
    builder.sample(&[view], 32 * 8192, |_| {});
    builder
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

fn cells(criterion: &mut Criterion) {
    let world = gallery();
    let points: Vec<Vec3> = surfaces(&world)
        .iter()
        .map(|surface| surface.position)
        .collect();
    let builder = construct(&world);
    let tree = builder.tree();
    assert!(lights_known_of(tree) > 0, "construction found lights");
    let lies = LieReplica::of(world, tree).publish();
    let mut group = criterion.benchmark_group("octree");
    group.throughput(Throughput::Elements(points.len() as u64));
    group.bench_function("descent, shader's copy", |bencher| {
        bencher.iter(|| -> usize {
            let found = points.iter().map(|&point| lies.cell(point).answered());
            found.sum()
        });
    });
    group.bench_function("descent, constructor's tree", |bencher| {
        bencher.iter(|| -> usize {
            let found = points
                .iter()
                .map(|&point| tree.lie_at(point).lights().count());
            found.sum()
        });
    });
    group.finish();
}

/// Whole tiles; the throughput counts evaluations: a light at a point, with all its samples.
fn shading(criterion: &mut Criterion) {
    let world = gallery();
    let builder = construct(&world);
    let lies = LieReplica::of(world.clone(), builder.tree()).publish();
    let camera = &world.scene().cameras[0];
    let tile = Tile {
        origin: FILM / 2 - UVec2::splat(16),
        size: UVec2::splat(32),
    };
    let never = AtomicBool::new(false);
    let mut group = criterion.benchmark_group("a tile of 32 x 32, per light at a point");
    for light_samples in [1, 16] {
        let settings = FrameSettings {
            size: FILM,
            samples_per_pixel: 1,
            light_samples,
            seed: 0,
            ward: None,
        };
        for (name, lookup) in [("standard", None), ("lie", Some(&lies as &dyn LieLookup))] {
            let render = || render_tile(&world, lookup, camera, &settings, tile, &never).unwrap();
            group.throughput(Throughput::Elements(render().stats.evaluations));
            group.bench_function(
                format!("{name}, {light_samples} light samples"),
                |bencher| {
                    bencher.iter(|| black_box(render()));
                },
            );
        }
    }
    group.finish();
}

fn sampling(criterion: &mut Criterion) {
    let world = gallery();
    let surfaces = surfaces(&world);
    let lights = &world.scene().lights;
    let mut group = criterion.benchmark_group("light samples, without visibility");
    let count = surfaces.len() * lights.len();
    group.throughput(Throughput::Elements(count as u64));
    group.bench_function("sample", |bencher| {
        bencher.iter(|| -> f32 {
            let mut sum = 0.0;
            for surface in &surfaces {
                for light in lights {
                    let sample = light.sample(surface.position, Vec2::splat(0.4), world.reach());
                    sum += sample.map_or(0.0, |sample| sample.normal_irradiance.x);
                }
            }
            sum
        });
    });
    group.finish();
}

fn brief() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .without_plots()
}

criterion_group! {
    name = kernels;
    config = brief();
    targets = rays, structures, occluder_lists, cells, sampling, shading
}
criterion_main!(kernels);
