//! Rays through the hierarchy, by kind and by vector unit, and through the paper's grid. Rays *one by one*
//! take the widest unit: their loops are the compiler's vector code.
//!
//! `cargo bench --bench traversal` prints time and rays per second of each. Compare lines of one
//! run with each other; times from two machines, or two days, say little.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod fixture;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixture::{Seen, Shadows, brief, count, gallery, is_area, is_point_or_spot, packets};
use lie_accel::{Accel, AccelKind, RayPacket, VectorUnit};
use lie_geom::Ray;
use lie_scene::Scene;

/// What is measured on: few triangles and many.
fn scenes() -> [Scene; 2] {
    let mosque = lie_scene::mosque(&lie_scene::Mosque {
        detail: 0.5,
        ..lie_scene::Mosque::default()
    });
    [gallery(), mosque]
}

fn closest(accel: &dyn Accel, rays: &[Ray]) -> usize {
    rays.iter().filter_map(|ray| accel.closest(ray)).count()
}

fn closest_packets(accel: &dyn Accel, packets: &[RayPacket]) {
    for packet in packets {
        black_box(accel.closest_packet(packet));
    }
}

fn blocked(accel: &dyn Accel, rays: &[Ray]) -> usize {
    rays.iter().filter(|ray| accel.is_blocked(ray)).count()
}

fn blocked_packets(accel: &dyn Accel, packets: &[RayPacket]) -> u32 {
    let blocked = packets.iter().map(|packet| accel.blocked_packet(packet));
    blocked.map(u32::count_ones).sum()
}

/// Closest hits: rays of neighbouring pixels, and rays that go anywhere.
fn closest_hits(criterion: &mut Criterion) {
    for scene in scenes() {
        let seen = Seen::new(scene);
        let accel = seen.world.accel();
        let name = format!("closest hits, {}", seen.world.scene().name);
        let mut group = criterion.benchmark_group(name);
        for (kind, rays) in [
            ("camera rays", seen.camera_rays.clone()),
            ("bounces", seen.bounces()),
        ] {
            group.throughput(Throughput::Elements(rays.len() as u64));
            let packets = packets(&rays);
            for unit in VectorUnit::all() {
                group.bench_function(format!("{kind}, packets, {}", unit.name()), |bencher| {
                    unit.run(|| bencher.iter(|| closest_packets(accel, &packets)));
                });
            }
            group.bench_function(format!("{kind}, one by one"), |bencher| {
                bencher.iter(|| closest(accel, &rays));
            });
        }
        group.finish();
    }
}

/// Whether anything is in the way: from lights without extent, to places on area lights, and
/// towards a light that is infinitely far away.
fn any_hits(criterion: &mut Criterion) {
    for scene in scenes() {
        let seen = Seen::new(scene);
        let accel = seen.world.accel();
        let name = format!("any hits, {}", seen.world.scene().name);
        let mut group = criterion.benchmark_group(name);
        let mut kinds = vec![
            ("fans from a light", seen.shadows(is_point_or_spot), true),
            ("to a far light", seen.far_shadows(), false),
        ];
        if seen.world.scene().lights.iter().any(is_area) {
            kinds.push(("to area lights", seen.shadows(is_area), false));
        }
        for (kind, shadows, is_fan) in &kinds {
            group.throughput(Throughput::Elements(count(shadows)));
            let packet = |shadows: &Shadows| match is_fan {
                true => shadows.fan(),
                false => shadows.segments(),
            };
            let packets: Vec<RayPacket> = shadows.iter().map(packet).collect();
            let rays: Vec<Ray> = shadows.iter().flat_map(Shadows::rays).collect();
            for unit in VectorUnit::all() {
                group.bench_function(format!("{kind}, packets, {}", unit.name()), |bencher| {
                    unit.run(|| bencher.iter(|| blocked_packets(accel, &packets)));
                });
            }
            group.bench_function(format!("{kind}, one by one"), |bencher| {
                bencher.iter(|| blocked(accel, &rays));
            });
        }
        group.finish();
    }
}

/// The paper's grid against the hierarchy, on the widest unit, and the time to build both.
fn structures(criterion: &mut Criterion) {
    let bar = lie_scene::bar(&lie_scene::Bar {
        detail: 0.5,
        ..lie_scene::Bar::default()
    });
    for scene in [gallery(), bar] {
        let seen = Seen::new(scene);
        let scene = seen.world.scene();
        let shadows = seen.shadows(is_point_or_spot);
        let fans: Vec<RayPacket> = shadows.iter().map(Shadows::fan).collect();
        let shadow_rays: Vec<Ray> = shadows.iter().flat_map(Shadows::rays).collect();
        let camera_packets = packets(&seen.camera_rays);
        let mut group = criterion.benchmark_group(format!("structures, {}", scene.name));
        for kind in [AccelKind::Bvh, AccelKind::Grid] {
            let accel = kind.build(&scene.geometry, None);
            let of = |what: &str| format!("{what}, {}", kind.name());
            group.throughput(Throughput::Elements(seen.camera_rays.len() as u64));
            group.bench_function(of("camera rays, packets"), |bencher| {
                bencher.iter(|| closest_packets(&*accel, &camera_packets));
            });
            group.bench_function(of("camera rays, one by one"), |bencher| {
                bencher.iter(|| closest(&*accel, &seen.camera_rays));
            });
            group.throughput(Throughput::Elements(shadow_rays.len() as u64));
            group.bench_function(of("shadow rays, packets"), |bencher| {
                bencher.iter(|| blocked_packets(&*accel, &fans));
            });
            group.bench_function(of("shadow rays, one by one"), |bencher| {
                bencher.iter(|| blocked(&*accel, &shadow_rays));
            });
            group.throughput(Throughput::Elements(scene.geometry.len() as u64));
            group.bench_function(of("build, triangles"), |bencher| {
                bencher.iter(|| kind.build(&scene.geometry, None));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = traversal;
    config = brief();
    targets = closest_hits, any_hits, structures
}
criterion_main!(traversal);
