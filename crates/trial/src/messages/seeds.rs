//! One message of every kind at least, with the content that a farm gives it.

use std::sync::atomic::AtomicBool;

use glam::{UVec2, Vec2, Vec3};
use lie_farm::{LieReplica, convert, handshake, pixels, scene_blob};
use lie_geom::Ray;
use lie_protocol::*;
use lie_render::{FrameSettings, Mismatch, Tile, render_tile};

use super::{Way, receive::TILE};
use crate::fixture::Fixture;

/// All of them, as they are on the wire.
pub(super) fn all() -> Vec<(Way, Vec<u8>)> {
    let fixture = Fixture::new();
    let mut seeds = Seeds(Vec::new());
    seeds.openings();
    seeds.of_the_session();
    seeds.scene(&fixture);
    seeds.lies(&fixture);
    seeds.audit(&fixture);
    seeds.client_and_constructor(&fixture);
    seeds.frame(&fixture);
    seeds.tiles(&fixture);
    seeds.status(&fixture);
    seeds.0
}

struct Seeds(Vec<(Way, Vec<u8>)>);

impl Seeds {
    fn add<M: Message>(&mut self, way: Way, message: M) {
        let mut bytes = Vec::new();
        encode(&message, &mut bytes).unwrap();
        self.0.push((way, bytes));
    }

    fn openings(&mut self) {
        for role in [Role::Shader, Role::Client, Role::Observer] {
            let hello = handshake::hello(role, 8, 7401);
            self.add(Way::Opening, Opening::Hello(hello));
        }
        let refuse = || Refuse::new("there are too many shaders");
        self.add(Way::Opening, Opening::Refuse(refuse()));
        let way = Way::ConstructorToShader;
        self.add(way, ConstructorToShader::Refuse(refuse()));
        let way = Way::ConstructorToClient;
        self.add(way, ConstructorToClient::Refuse(refuse()));
        let way = Way::ShaderToClient;
        self.add(way, ShaderToClient::Refuse(refuse()));
        let way = Way::ConstructorToObserver;
        self.add(way, ConstructorToObserver::Refuse(refuse()));
    }

    /// Signs of life and farewells, which go all ways.
    fn of_the_session(&mut self) {
        macro_rules! go {
            ($($way:ident)*) => {$(
                self.add(Way::$way, $way::Ping(Ping { nonce: 77 }));
                self.add(Way::$way, $way::Pong(Pong { nonce: 1 << 40 }));
                let reason = Text::new("the process is ending");
                self.add(Way::$way, $way::Goodbye(Goodbye { reason }));
            )*};
        }
        go!(ConstructorToShader ShaderToConstructor ConstructorToClient ClientToConstructor);
        go!(ShaderToClient ClientToShader);
    }

    fn scene(&mut self, fixture: &Fixture) {
        let (scene, way) = (fixture.hash, Way::ConstructorToShader);
        let bytes = scene_blob::encode(fixture.scene()).unwrap();
        let settings = fixture.builder().tree().settings();
        let welcome = ShaderWelcome {
            id: 3,
            scene,
            scene_length: bytes.len() as u64,
            settings: WireLieSettings {
                max_depth: settings.max_depth,
                split_threshold: settings.split_threshold,
                trust: settings.trust,
            },
        };
        self.add(way, ConstructorToShader::Welcome(welcome));
        let chunk = SceneChunk {
            offset: 100,
            bytes: bytes[100..600].to_vec(),
        };
        self.add(way, ConstructorToShader::SceneChunk(chunk));
        self.add(way, ConstructorToShader::SceneReady(SceneReady { scene }));
        let way = Way::ShaderToConstructor;
        let request = SceneRequest { scene, offset: 0 };
        self.add(way, ShaderToConstructor::SceneRequest(request));
        self.add(way, ShaderToConstructor::Subscribe(Subscribe { scene }));
        self.add(way, ShaderToConstructor::Ready(ShaderReady { scene }));
        let have_version = 12;
        let resync = ResyncRequest { have_version };
        self.add(way, ShaderToConstructor::Resync(resync));
    }

    /// A snapshot, and updates of what was learnt.
    fn lies(&mut self, fixture: &Fixture) {
        let builder = fixture.learnt();
        let tree = builder.tree();
        let states = tree.keys().into_iter().filter_map(|key| tree.state(key));
        let cells: Vec<WireCell> = states.map(|state| convert::wire_cell(&state)).collect();
        let update = |from_version, cells: &[WireCell]| LieDelta {
            from_version,
            to_version: tree.version(),
            part: 0,
            last: true,
            cells: cells.to_vec(),
        };
        let way = Way::ConstructorToShader;
        // The ancestors come first: a beginning is a tree.
        for count in [1, 9, 40] {
            let snapshot = update(0, &cells[..count.min(cells.len())]);
            self.add(way, ConstructorToShader::LieDelta(snapshot));
        }
        let parts = cells.chunks(12);
        let most = cells.len().div_ceil(12) / 5 + 1;
        for cells in parts.step_by(most) {
            let news = update(tree.version() - 1, cells);
            self.add(way, ConstructorToShader::LieDelta(news));
        }
    }

    /// Rays that a true audit could have found.
    fn audit(&mut self, fixture: &Fixture) {
        let world = &fixture.world;
        let camera = &world.scene().cameras[0];
        let ray = camera.ray(Vec2::new(2.5, 3.5), UVec2::new(5, 4));
        let point = world.first_surface(&ray).unwrap().shadow_origin;
        let lights = 0..world.scene().lights.len() as u32;
        let wrong = lights.map(|light| Mismatch {
            light,
            point,
            ray: Ray {
                origin: point,
                direction: Vec3::new(0.1 * light as f32, 2.0, 0.1),
                t_min: 0.0,
                t_max: 1.0,
            },
        });
        let mismatches: Vec<_> = wrong.map(|wrong| convert::wire_mismatch(&wrong)).collect();
        let report = AuditReport {
            rays: 5000,
            wrong: mismatches.len() as u64,
            mismatches,
        };
        let way = Way::ShaderToConstructor;
        self.add(way, ShaderToConstructor::Audit(report));
        self.add(way, ShaderToConstructor::Report(shader_report()));
    }

    fn client_and_constructor(&mut self, fixture: &Fixture) {
        let way = Way::ConstructorToClient;
        let scene = convert::summary(fixture.scene(), fixture.hash);
        let welcome = ClientWelcome { id: 4, scene };
        self.add(way, ConstructorToClient::Welcome(welcome));
        let entry = |id| RosterEntry {
            id,
            address: Text::new("127.0.0.1:7401"),
            threads: 2,
            ready: id != 2,
            replays: id == 3,
        };
        let shaders = (1..4).map(entry).collect();
        self.add(way, ConstructorToClient::Roster(Roster { shaders }));
        self.add(way, ConstructorToClient::LieStatus(lie_status()));
        let way = Way::ClientToConstructor;
        let camera = CameraUpdate {
            serial: 9,
            camera: convert::wire_camera(&fixture.scene().cameras[0]),
            size: [64, 48],
        };
        self.add(way, ClientToConstructor::Camera(camera));
        self.add(way, ClientToConstructor::Report(client_report()));
    }

    fn frame(&mut self, fixture: &Fixture) {
        let way = Way::ClientToShader;
        for integrator in [WireIntegrator::Standard, WireIntegrator::Lie] {
            let begin = BeginFrame {
                frame: 5,
                view: 4,
                camera: convert::wire_camera(&fixture.scene().cameras[0]),
                size: TILE.to_array(),
                samples_per_pixel: 1,
                light_samples: 4,
                integrator,
                seed: 1,
                format: PixelFormat::F16,
                compression: Compression::Lz4,
            };
            self.add(way, ClientToShader::BeginFrame(begin));
        }
        let request = TileRequest {
            frame: 5,
            tile: 0,
            origin: [0, 0],
            size: TILE.to_array(),
        };
        self.add(way, ClientToShader::TileRequest(request));
        let cancel = CancelBefore { frame: 5 };
        self.add(way, ClientToShader::CancelBefore(cancel));
    }

    /// A rendered tile, packed in every way.
    fn tiles(&mut self, fixture: &Fixture) {
        let way = Way::ShaderToClient;
        let (scene, threads) = (fixture.hash, 2);
        let welcome = TileWelcome {
            scene,
            threads,
            replays: false,
        };
        self.add(way, ShaderToClient::Welcome(welcome));
        let builder = fixture.learnt();
        let lies = LieReplica::of(fixture.world.clone(), builder.tree()).publish();
        let settings = FrameSettings {
            size: TILE,
            ..FrameSettings::new(&fixture.scene().settings)
        };
        let (origin, size) = (UVec2::ZERO, TILE);
        let (camera, never) = (&fixture.scene().cameras[0], AtomicBool::new(false));
        let world = &fixture.world;
        let tile = Tile { origin, size };
        let done = render_tile(world, Some(&lies), camera, &settings, tile, &never).unwrap();
        for format in [PixelFormat::F16, PixelFormat::F32] {
            for compression in [Compression::None, Compression::Lz4] {
                let report = TileReport {
                    frame: 5,
                    tile: 0,
                    lie_version: lies.version(),
                    cost: cost(),
                };
                let pixels = pixels::pack(done.radiance.radiance(), format, compression);
                self.add(way, ShaderToClient::TileDone(TileDone { report, pixels }));
            }
        }
        let failed = TileFailed {
            frame: 5,
            tile: 1,
            reason: Text::new("index out of bounds: the len is 3 but the index is 3"),
        };
        self.add(way, ShaderToClient::TileFailed(failed));
    }

    fn status(&mut self, fixture: &Fixture) {
        let shader = |id, report| ShaderStatus {
            id,
            address: Text::new("127.0.0.1:7401"),
            threads: 2,
            health: ShaderHealth::Ready,
            joined_ms: 90_000,
            heard_ms: 12,
            ping_us: Some(140),
            sent_bytes: 1 << 20,
            replays: id == 2,
            report,
        };
        let client = ClientStatus {
            id: 4,
            address: Text::new("127.0.0.1:50000"),
            joined_ms: 1000,
            cameras: 9,
            report: Some(client_report()),
        };
        let scene = fixture.scene();
        let status = FarmStatus {
            build: handshake::build(),
            scene: Text::new(&scene.name),
            hash: fixture.hash,
            triangles: scene.geometry.len() as u64,
            lights: scene.lights.len() as u64,
            uptime_ms: 100_000,
            lies: lie_status(),
            samples_per_s: 12345.5,
            shaders_joined: 2,
            shaders_lost: 0,
            shaders: vec![shader(1, Some(shader_report())), shader(2, None)],
            clients: vec![client],
        };
        let way = Way::ConstructorToObserver;
        self.add(way, ConstructorToObserver::Status(status));
    }
}

fn lie_status() -> LieStatus {
    LieStatus {
        version: 7,
        camera_serial: 9,
        cells: 500,
        entries: 3000,
        occluders: 9000,
        bytes: 1 << 20,
        samples: 100_000,
        sent_bytes: 1 << 22,
        audit_rays: 5000,
        audit_wrong: 3,
        estimated_error: 0.01,
        converged: false,
        frozen: false,
    }
}

fn shader_report() -> ShaderReport {
    ShaderReport {
        tiles: 100,
        camera_rays: 409_600,
        shadow_rays: 90_000,
        list_rays: 800_000,
        render_ns: 5_000_000_000,
        lie_version: 7,
        clients: 1,
        outstanding: 4,
        sent_bytes: 1 << 21,
    }
}

fn client_report() -> ClientReport {
    ClientReport {
        frames: 12,
        frame_us: 45_000,
        lost_tiles: 0,
        reissued_tiles: 1,
    }
}

fn cost() -> WireCost {
    WireCost {
        queued_ns: 1_000_000,
        idle_ns: 20_000,
        render_ns: 9_000_000,
        visibility_ns: 2_000_000,
        unoccluded_ns: 3_000_000,
        partial_ns: 3_000_000,
        full_ns: 1_000_000,
        pack_ns: 50_000,
        primary_rays: 96,
        shadow_rays: 200,
        list_rays: 900,
        occluder_tests: 4000,
        evaluations: 2000,
        trusted: 1800,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds<M: Message>() -> Vec<u16> {
        let is_read = |kind: &u16| M::max_length(*kind).is_some();
        (0..=u16::MAX).filter(is_read).collect()
    }

    #[test]
    fn every_kind_of_every_direction_has_a_seed() {
        let seeds = all();
        for (way, kinds) in [
            (Way::Opening, kinds::<Opening>()),
            (Way::ConstructorToShader, kinds::<ConstructorToShader>()),
            (Way::ShaderToConstructor, kinds::<ShaderToConstructor>()),
            (Way::ConstructorToClient, kinds::<ConstructorToClient>()),
            (Way::ClientToConstructor, kinds::<ClientToConstructor>()),
            (Way::ShaderToClient, kinds::<ShaderToClient>()),
            (Way::ClientToShader, kinds::<ClientToShader>()),
            (Way::ConstructorToObserver, kinds::<ConstructorToObserver>()),
        ] {
            let there = seeds.iter().filter(|(of, _)| *of == way);
            let there: Vec<u16> = there
                .map(|(_, bytes)| u16::from_le_bytes([bytes[6], bytes[7]]))
                .collect();
            for kind in kinds {
                assert!(there.contains(&kind), "{way:?} {kind}");
            }
        }
        let longest = seeds.iter().map(|(_, bytes)| bytes.len()).max();
        assert!(longest < Some(32 * 1024), "{longest:?}");
    }
}
