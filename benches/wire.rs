//! Pixels as they travel: packed by a shader, unpacked by the client.
//!
//! `cargo bench --bench wire` prints pixels per second.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod fixture;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixture::{FILM, brief};
use glam::Vec3;
use lie_farm::pixels::{PackedPixels, pack};
use lie_protocol::{Compression, PixelFormat};
use lie_render::{FrameSettings, World, render_frame};

fn pixels(criterion: &mut Criterion) {
    let world = World::new(std::sync::Arc::new(lie_scene::cornell_box()));
    let scene = world.scene();
    let settings = FrameSettings {
        size: FILM,
        ..FrameSettings::new(&scene.settings)
    };
    let (film, _) = render_frame(&world, None, &scene.cameras[0], &settings, &mut |_| {});
    let radiance = film.radiance();
    let mut group = criterion.benchmark_group("pixels");
    group.throughput(Throughput::Elements(radiance.len() as u64));
    for (format_name, format) in [("halves", PixelFormat::F16), ("floats", PixelFormat::F32)] {
        for (how, compression) in [("plain", Compression::None), ("lz4", Compression::Lz4)] {
            let of = |what: &str| format!("{what}, {format_name}, {how}");
            group.bench_function(of("pack"), |bencher| {
                bencher.iter(|| pack(radiance, format, compression));
            });
            let bytes = pack(radiance, format, compression);
            let mut into = vec![Vec3::ZERO; radiance.len()];
            group.bench_function(of("unpack"), |bencher| {
                bencher.iter(|| {
                    let packed = PackedPixels::new(&bytes, into.len(), format, compression);
                    packed.expect("they were packed so").unpack(0, &mut into);
                });
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = wire;
    config = brief();
    targets = pixels
}
criterion_main!(wire);
