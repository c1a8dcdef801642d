use glam::{UVec2, Vec3};
use lie_protocol::{
    Compression, PixelFormat, Text, TileFailed, TileReport, WireCost, WireIntegrator,
};
use tokio_util::sync::CancellationToken;

use super::*;
use crate::{network::Exposure, pixels::pack, scene_blob::tests::full_scene};

/// A frame of three tiles.
fn request() -> FrameRequest {
    FrameRequest {
        camera: full_scene().cameras[0].clone(),
        size: UVec2::new(130, 1),
        samples_per_pixel: 1,
        light_samples: 1,
        integrator: WireIntegrator::Standard,
        seed: 0,
        format: PixelFormat::F32,
        compression: Compression::None,
    }
}

fn link() -> (Link, mpsc::Receiver<ClientToShader>) {
    let (outbox, messages) = mpsc::channel(16);
    let link = Link {
        address: "here:1".to_owned(),
        threads: 1,
        outbox,
        cut: CancellationToken::new(),
    };
    (link, messages)
}

fn done(tile: u32, radiance: &[Vec3]) -> TileDone {
    TileDone {
        report: TileReport {
            frame: 1,
            tile,
            lie_version: 0,
            cost: WireCost::default(),
        },
        pixels: pack(radiance, PixelFormat::F32, Compression::None),
    }
}

#[test]
fn only_what_was_asked_for_and_is_possible_stays_on_the_film() {
    let (request, config) = (request(), ClientConfig::new("here:2", Exposure::Loopback));
    let mut memory = Memory::default();
    let mut run = FrameRun::new(1, &request, &config, &mut memory, 0).unwrap();
    let mut film = Film::new(request.size);
    let ((first, _asked_first), (second, _asked_second)) = (link(), link());
    run.join(1, first.clone());
    run.assign();
    let held: Vec<u32> = (0..3)
        .filter(|&tile| run.scheduler.wants(tile, 1))
        .collect();
    assert_eq!(held.len(), 2, "twice its threads");
    let other = (0..3).find(|tile| !held.contains(tile)).unwrap();
    let pixels = |run: &FrameRun<'_>, tile: u32, value: f32| {
        vec![Vec3::splat(value); run.tiles[tile as usize].size.x as usize]
    };

    // Nobody asked it for this one.
    run.take(1, &done(other, &pixels(&run, other, 5.0)), &mut film);
    assert_eq!(film, Film::new(request.size));
    // The last pixel is impossible: another one has to render the tile again, and the other too.
    let mut bad = pixels(&run, held[0], 5.0);
    if let Some(last) = bad.last_mut() {
        last.y = f32::NAN;
    }
    run.take(1, &done(held[0], &bad), &mut film);
    assert!(first.cut.is_cancelled());
    assert_eq!(run.scheduler.shaders(), 0);
    assert_eq!(run.scheduler.unfinished(), 3);

    run.join(2, second.clone());
    while !run.scheduler.is_done() {
        run.assign();
        for tile in 0..3 {
            let value = if run.scheduler.wants(tile, 2) {
                1.0
            } else {
                7.0
            };
            run.take(2, &done(tile, &pixels(&run, tile, value)), &mut film);
        }
    }
    assert!(!second.cut.is_cancelled());
    assert!(film.radiance().iter().all(|&pixel| pixel == Vec3::ONE));
    run.take(2, &done(3, &[Vec3::ONE]), &mut film);
    assert!(second.cut.is_cancelled(), "there is no fourth tile");
}

#[test]
fn a_tile_fails_the_frame_after_three_failures_and_none_that_does_not_concern_it_counts() {
    let (request, config) = (request(), ClientConfig::new("here:2", Exposure::Loopback));
    let mut memory = Memory::default();
    let mut run = FrameRun::new(1, &request, &config, &mut memory, 0).unwrap();
    let ((first, _asked_first), (second, _asked_second)) = (link(), link());
    run.join(1, first);
    run.join(2, second.clone());
    let failed = |tile| TileFailed {
        frame: 1,
        tile,
        reason: Text::new("a mishap"),
    };
    run.assign();
    let tile = (0..3).find(|&tile| run.scheduler.wants(tile, 1)).unwrap();
    // It was never asked for this one.
    for _ in 0..5 {
        run.fail(2, &failed(tile)).unwrap();
    }
    for shader in [1, 2] {
        run.lose(3 - shader);
        run.assign();
        assert!(run.scheduler.wants(tile, shader));
        run.fail(shader, &failed(tile)).unwrap();
        if shader == 1 {
            run.scheduler.joined(2, 4);
        }
    }
    run.assign();
    assert!(run.scheduler.wants(tile, 2), "there is nobody else");
    let error = run.fail(2, &failed(tile)).unwrap_err();
    assert!(matches!(error, ClientError::Tile { number, .. } if number == tile));
    assert_eq!(error.to_string().matches("a mishap").count(), 3);
    run.fail(2, &failed(3)).unwrap();
    assert!(second.cut.is_cancelled(), "there is no fourth tile");
}

#[test]
fn who_lets_a_frame_wait_is_not_asked_in_the_next_unless_there_is_nobody_else() {
    let mut config = ClientConfig::new("here:2", Exposure::Loopback);
    config.late.floor = Duration::ZERO;
    config.late.factor = 0.0;
    let (request, mut memory) = (request(), Memory::default());
    let ((hangs, _asked_first), (works, mut asked)) = (link(), link());
    let both = BTreeMap::from([(1, hangs.clone()), (2, works)]);
    let mut run = FrameRun::new(1, &request, &config, &mut memory, 0).unwrap();
    let mut film = Film::new(request.size);
    run.gather(both.clone());
    while !run.scheduler.is_done() {
        run.assign();
        for tile in 0..3 {
            if run.scheduler.wants(tile, 2) {
                let size = run.tiles[tile as usize].size;
                run.take(2, &done(tile, &vec![Vec3::ONE; size.x as usize]), &mut film);
            }
        }
    }
    run.set_aside_the_silent();
    drop(run);

    while asked.try_recv().is_ok() {}
    let mut run = FrameRun::new(2, &request, &config, &mut memory, 0).unwrap();
    run.gather(both);
    assert_eq!((run.scheduler.shaders(), run.stats.set_aside), (2, 1));
    run.assign();
    assert_eq!(
        (run.scheduler.in_flight(1), run.scheduler.in_flight(2)),
        (0, 2)
    );
    run.lose(2);
    // It is tried with a single tile, and has its place back with the first that it finishes.
    run.assign();
    assert_eq!(run.scheduler.in_flight(1), 1);
    let tile = (0..3).find(|&tile| run.scheduler.wants(tile, 1)).unwrap();
    let size = run.tiles[tile as usize].size;
    run.take(1, &done(tile, &vec![Vec3::ONE; size.x as usize]), &mut film);
    drop(run);
    assert_eq!(memory.standings.credits(1, 2), 2);

    let mut run = FrameRun::new(3, &request, &config, &mut memory, 0).unwrap();
    run.gather(BTreeMap::from([(1, hangs)]));
    assert_eq!(run.stats.set_aside, 0);
}
