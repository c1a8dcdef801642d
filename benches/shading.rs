//! Light at a point, by kind of light and of surface.
//!
//! `cargo bench --bench shading` prints lights at points per second: one light at one point is one
//! element, however many sample points it takes. Its loops are the compiler's vector code, on the
//! widest unit that the machine has.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod fixture;

use std::{hint::black_box, sync::atomic::AtomicBool, time::Duration};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixture::{FILM, Seen, brief, construct, gallery};
use glam::{UVec2, Vec3};
use lie_farm::LieReplica;
use lie_geom::{RandomKey, sampling::strata};
use lie_render::{
    Brdf, FrameSettings, LieCell, LieLookup, LightPoints, RenderStats, Tile, World, render_tile,
};
use lie_scene::{Light, LightKind, Material, Scene};

/// Sample points on an area light.
const SAMPLES: u32 = 16;

/// LIEs by which every light reaches everything.
struct AllClear(LieCell);

impl AllClear {
    fn of(scene: &Scene) -> Self {
        Self(LieCell {
            unoccluded: (0..scene.lights.len() as u32).collect(),
            ..LieCell::default()
        })
    }
}

impl LieLookup for AllClear {
    fn cell(&self, _point: Vec3) -> &LieCell {
        &self.0
    }
}

/// Something with its name.
type Named<T> = (&'static str, T);
/// Which lights are meant.
type OfKind = fn(&Light) -> bool;

/// Kinds of lights, each with which lights of the gallery are of it.
fn lights() -> [Named<OfKind>; 3] {
    [
        ("points", |light| {
            matches!(light.kind, LightKind::Point { .. })
        }),
        ("spots", |light| {
            matches!(light.kind, LightKind::Spot { .. })
        }),
        ("area lights", |light| {
            matches!(light.kind, LightKind::Area(_))
        }),
    ]
}

/// Kinds of surfaces: matt; with a highlight; so smooth that area lights are sampled by it.
fn surfaces() -> [Named<fn(&mut Material)>; 3] {
    fn glossy(material: &mut Material, roughness: f32) {
        (material.specular, material.roughness) = (1.0, roughness);
        material.metallic_roughness_texture = None;
    }
    [
        ("matt", |material| {
            (material.specular, material.metallic) = (0.0, 0.0);
            material.metallic_roughness_texture = None;
        }),
        ("glossy", |material| glossy(material, 0.8)),
        ("smooth", |material| glossy(material, 0.3)),
    ]
}

fn settings(light_samples: u32) -> FrameSettings {
    FrameSettings {
        size: FILM,
        samples_per_pixel: 1,
        light_samples,
        seed: 0,
        ward: None,
    }
}

/// Renders a part of the film on this thread.
fn render(world: &World, lies: Option<&dyn LieLookup>, samples: u32, tile: Tile) -> RenderStats {
    let never = AtomicBool::new(false);
    let camera = &world.scene().cameras[0];
    let result = render_tile(world, lies, camera, &settings(samples), tile, &never);
    black_box(result).expect("nobody cancels it").stats
}

/// Lights that nothing hides: what the renderer itself measures of that stage, sixteen points at
/// a time, and the same point by point as a scalar twin, without visibility in both.
fn unoccluded(criterion: &mut Criterion) {
    let whole = Tile {
        origin: UVec2::ZERO,
        size: FILM,
    };
    for (lights, is_kind) in lights() {
        let mut group = criterion.benchmark_group(format!("unoccluded {lights}"));
        for (surface, change) in surfaces() {
            let mut scene = gallery();
            scene.lights.retain(is_kind);
            scene.materials.iter_mut().for_each(change);
            let seen = Seen::new(scene);
            let scene = seen.world.scene();
            let all_clear = AllClear::of(scene);
            let count = seen.surfaces.len() * scene.lights.len();
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(format!("{surface}, sixteen at a time"), |bencher| {
                bencher.iter_custom(|repeat| {
                    let stats =
                        (0..repeat).map(|_| render(&seen.world, Some(&all_clear), SAMPLES, whole));
                    Duration::from_nanos(stats.map(|stats| stats.unoccluded_ns).sum())
                });
            });
            group.bench_function(format!("{surface}, one by one"), |bencher| {
                bencher.iter(|| one_by_one(&seen));
            });
        }
        group.finish();
    }
}

/// All lights of all points, by the function that every other way is held against.
fn one_by_one(seen: &Seen) -> Vec3 {
    let scene = seen.world.scene();
    let mut sum = Vec3::ZERO;
    for (number, surface) in seen.surfaces.iter().enumerate() {
        let points = LightPoints {
            surface,
            brdf: &Brdf::new(scene, surface),
            key: RandomKey::new(number as u64),
            strata: strata(SAMPLES),
        };
        for light in 0..scene.lights.len() as u32 {
            seen.world
                .for_each_light_ray(light, &points, |ray| sum += ray.radiance);
        }
    }
    sum
}

/// Whole tiles, with visibility; an element is a light at a point as the renderer counts it,
/// with each sample point and each edge of an area light as one.
fn tiles(criterion: &mut Criterion) {
    let seen = Seen::new(gallery());
    let world = &seen.world;
    let builder = construct(world);
    let lies = LieReplica::of(world.clone(), builder.tree()).publish();
    let tile = Tile {
        origin: FILM / 2 - UVec2::splat(16),
        size: UVec2::splat(32),
    };
    let mut group = criterion.benchmark_group("a tile of 32 x 32");
    for samples in [1, SAMPLES] {
        for (name, lookup) in [("standard", None), ("lie", Some(&lies as &dyn LieLookup))] {
            let evaluations = render(world, lookup, samples, tile).evaluations;
            group.throughput(Throughput::Elements(evaluations));
            group.bench_function(format!("{name}, {samples} light samples"), |bencher| {
                bencher.iter(|| render(world, lookup, samples, tile));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = shading;
    config = brief();
    targets = unoccluded, tiles
}
criterion_main!(shading);
