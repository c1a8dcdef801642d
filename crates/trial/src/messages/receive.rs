//! What processes do with what they read, without their sockets.

use std::sync::atomic::AtomicBool;

use glam::{UVec2, Vec3};
use lie_farm::{
    Builder, LieReplica, convert,
    pixels::{self, PackedPixels},
    snapshot::SnapshotFile,
};
use lie_octree::{CellState, LieSettings};
use lie_protocol::{
    BeginFrame, ClientToConstructor, ClientToShader, Compression, ConstructorToClient,
    ConstructorToObserver, ConstructorToShader, LieDelta, Opening, PixelFormat, SceneSummary,
    ShaderToClient, ShaderToConstructor, Text, WireIntegrator, limit,
};
use lie_render::{Film, FrameSettings, LieLookup, Tile, render_tile};
use lie_scene::Camera;
use tempfile::TempDir;

use crate::fixture::Fixture;

/// Pixels of the tile that a client waits for: what the seeds have.
pub(super) const TILE: UVec2 = UVec2::new(12, 8);

/// A constructor, a shader and a client, as far as a message can get in them.
pub(super) struct Processes {
    fixture: Fixture,
    builder: Builder,
    /// What the builder goes back to: its tree as it was.
    snapshot: SnapshotFile,
    _folder: TempDir,
    settings: LieSettings,
    /// A shader's LIEs, for updates that go on from there.
    states: Vec<CellState>,
    film: Film,
}

impl Processes {
    pub(super) fn new() -> Self {
        let fixture = Fixture::new();
        let builder = fixture.learnt();
        let folder = tempfile::tempdir().unwrap();
        let snapshot = SnapshotFile::new(folder.path().join("a.lies"));
        snapshot.save(&builder.snapshot(), fixture.hash).unwrap();
        let tree = builder.tree();
        let keys = tree.keys().into_iter();
        Self {
            settings: tree.settings(),
            states: keys.filter_map(|key| tree.state(key)).take(40).collect(),
            film: Film::new(TILE),
            fixture,
            builder,
            snapshot,
            _folder: folder,
        }
    }

    pub(super) fn opening(&mut self, message: Opening) {
        if let Opening::Hello(hello) = message
            && let Err(refusal) = hello.check_version("a trial")
        {
            check_text(&refusal.reason);
        }
    }

    pub(super) fn shader(&mut self, message: ConstructorToShader) {
        match message {
            ConstructorToShader::LieDelta(delta) => self.take_in(delta),
            ConstructorToShader::Refuse(refusal) => check_text(&refusal.reason),
            ConstructorToShader::SceneChunk(chunk) => {
                assert!(chunk.bytes.len() <= limit::SCENE_CHUNK);
            }
            _ => {}
        }
    }

    /// Applies an update, and renders a little with what then holds.
    fn take_in(&mut self, delta: LieDelta) {
        let cells = delta.cells.into_iter().map(convert::cell);
        let Ok(cells) = cells.collect::<Result<Vec<_>, _>>() else {
            return;
        };
        let mut replica = LieReplica::new(self.fixture.world.clone(), self.settings);
        if delta.from_version != 0 {
            replica.apply(&self.states, delta.from_version).unwrap();
        }
        if replica.apply(&cells, delta.to_version).is_err() {
            return;
        }
        let lies = replica.publish();
        assert_eq!(lies.version(), delta.to_version);
        let _ = lies.bytes();
        let everywhere = [Vec3::ZERO, Vec3::splat(f32::MAX), Vec3::NAN];
        lies.cells(&everywhere, &mut Vec::new());
        let camera = &self.fixture.scene().cameras[0];
        self.render(camera, &small(7), Some(&lies));
    }

    fn render(&self, camera: &Camera, settings: &FrameSettings, lies: Option<&dyn LieLookup>) {
        let tile = Tile {
            origin: UVec2::ZERO,
            size: settings.size.min(UVec2::splat(4)),
        };
        let never = AtomicBool::new(false);
        let done = render_tile(&self.fixture.world, lies, camera, settings, tile, &never);
        let done = done.unwrap();
        assert!(
            done.radiance
                .radiance()
                .iter()
                .all(|pixel| pixel.is_finite())
        );
    }

    pub(super) fn constructor(&mut self, message: ShaderToConstructor) {
        if let ShaderToConstructor::Audit(report) = message {
            let found: Vec<_> = report.mismatches.iter().map(convert::mismatch).collect();
            if self.builder.mend(&found) > 0 {
                assert_eq!(self.builder.tree().validate(), Ok(()));
            }
            let hash = self.fixture.hash;
            assert!(self.snapshot.restore(&mut self.builder, hash).unwrap());
        }
    }

    pub(super) fn client(&mut self, message: ConstructorToClient) {
        match message {
            ConstructorToClient::Welcome(welcome) => self.look_around(&welcome.scene),
            ConstructorToClient::Roster(roster) => {
                roster
                    .shaders
                    .iter()
                    .for_each(|entry| check_text(&entry.address));
            }
            ConstructorToClient::Refuse(refusal) => check_text(&refusal.reason),
            _ => {}
        }
    }

    /// Renders from the cameras and along the walkthroughs that a constructor announces.
    fn look_around(&self, scene: &SceneSummary) {
        check_text(&scene.name);
        for camera in scene.cameras.iter().take(4) {
            if let Ok(camera) = convert::camera(camera) {
                self.render(&camera, &small(1), None);
            }
        }
        for walk in scene.walkthroughs.iter().take(4) {
            let Ok(walk) = convert::walkthrough(walk) else {
                continue;
            };
            for share in [0.0, 0.3, 1.0] {
                let camera = walk.camera_at(share * walk.duration_s());
                self.render(&camera, &small(1), None);
            }
        }
    }

    pub(super) fn constructor_of_client(&mut self, message: ClientToConstructor) {
        if let ClientToConstructor::Camera(update) = message
            && let Ok(camera) = convert::camera(&update.camera)
        {
            self.render(&camera, &small(1), None);
        }
    }

    pub(super) fn client_of_shader(&mut self, message: ShaderToClient) {
        let ShaderToClient::TileDone(done) = message else {
            return;
        };
        let (tile, count) = (
            Tile {
                origin: UVec2::ZERO,
                size: TILE,
            },
            TILE.element_product(),
        );
        for format in [PixelFormat::F16, PixelFormat::F32] {
            for compression in [Compression::None, Compression::Lz4] {
                let packed = PackedPixels::new(&done.pixels, count as usize, format, compression);
                let Ok(packed) = packed else { continue };
                let filled = self.film.fill(tile, |from, row| packed.unpack(from, row));
                if filled.is_ok() {
                    let all = self.film.radiance();
                    assert!(all.iter().all(|pixel| pixel.is_finite()));
                    let _ = pixels::pack(all, format, compression);
                }
            }
        }
    }

    pub(super) fn shader_of_client(&mut self, message: ClientToShader) {
        match message {
            ClientToShader::BeginFrame(begin) => self.begin(&begin),
            ClientToShader::TileRequest(request) => {
                let tile = Tile {
                    origin: request.origin.into(),
                    size: request.size.into(),
                };
                let _ = tile.is_inside(TILE);
            }
            _ => {}
        }
    }

    fn begin(&self, begin: &BeginFrame) {
        let (Ok(camera), Ok(settings)) = (
            convert::camera(&begin.camera),
            convert::frame_settings(begin),
        ) else {
            return;
        };
        // More is allowed, and takes its time.
        if settings.samples_per_pixel * settings.light_samples > 16 {
            return;
        }
        let lies = match begin.integrator {
            WireIntegrator::Standard => None,
            WireIntegrator::Lie => {
                let mut replica = LieReplica::new(self.fixture.world.clone(), self.settings);
                replica.apply(&self.states, 1).unwrap();
                Some(replica.publish())
            }
        };
        let lies = lies.as_ref().map(|lies| lies as &dyn LieLookup);
        self.render(&camera, &settings, lies);
    }

    pub(super) fn observer(&mut self, message: ConstructorToObserver) {
        match message {
            ConstructorToObserver::Refuse(refusal) => check_text(&refusal.reason),
            ConstructorToObserver::Status(status) => {
                check_text(&status.scene);
                check_text(&status.build);
            }
        }
    }
}

/// Settings of a quick picture.
fn small(seed: u64) -> FrameSettings {
    FrameSettings {
        size: UVec2::new(6, 4),
        samples_per_pixel: 1,
        light_samples: 1,
        seed,
        ward: None,
    }
}

/// A peer's text goes to logs and terminals.
fn check_text(text: &Text) {
    assert!(text.as_str().len() <= limit::TEXT);
    assert!(!text.as_str().chars().any(char::is_control));
}
