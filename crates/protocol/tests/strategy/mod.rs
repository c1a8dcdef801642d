//! Arbitrary messages of every kind.

use lie_protocol::*;
use proptest::{collection::vec, prelude::*};

fn text() -> impl Strategy<Value = Text> {
    ".{0,40}".prop_map(|text| Text::new(&text))
}

/// Any bits that compare equal to themselves.
fn number() -> impl Strategy<Value = f32> {
    any::<f32>().prop_filter("NaN is not equal to itself", |value| !value.is_nan())
}

fn point() -> impl Strategy<Value = [f32; 3]> {
    [number(), number(), number()]
}

fn rotation() -> impl Strategy<Value = [f32; 4]> {
    [number(), number(), number(), number()]
}

fn hash() -> impl Strategy<Value = SceneHash> {
    any::<[u8; 32]>().prop_map(SceneHash)
}

fn camera() -> impl Strategy<Value = WireCamera> {
    (text(), point(), rotation(), number()).prop_map(|(name, eye, orientation, vertical_fov)| {
        WireCamera {
            name,
            eye,
            orientation,
            vertical_fov,
        }
    })
}

fn walkthrough() -> impl Strategy<Value = WireWalkthrough> {
    let key = (number(), point(), rotation(), number()).prop_map(
        |(time_s, eye, orientation, vertical_fov)| WireKeyFrame {
            time_s,
            eye,
            orientation,
            vertical_fov,
        },
    );
    (text(), vec(key, 0..4)).prop_map(|(name, key_frames)| WireWalkthrough { name, key_frames })
}

fn refuse() -> impl Strategy<Value = Refuse> {
    text().prop_map(|reason| Refuse { reason })
}

fn goodbye() -> impl Strategy<Value = Goodbye> {
    text().prop_map(|reason| Goodbye { reason })
}

fn ping() -> impl Strategy<Value = Ping> {
    any::<u64>().prop_map(|nonce| Ping { nonce })
}

fn pong() -> impl Strategy<Value = Pong> {
    any::<u64>().prop_map(|nonce| Pong { nonce })
}

pub(crate) fn opening() -> impl Strategy<Value = Opening> {
    let role = prop_oneof![
        Just(Role::Constructor),
        Just(Role::Shader),
        Just(Role::Client),
        Just(Role::Observer),
        Just(Role::Replay)
    ];
    let hello = (role, any::<u32>(), any::<u16>(), text()).prop_map(
        |(role, threads, listen_port, build)| Hello {
            protocol_version: PROTOCOL_VERSION,
            role,
            threads,
            listen_port,
            build,
        },
    );
    prop_oneof![
        hello.prop_map(Opening::Hello),
        refuse().prop_map(Opening::Refuse)
    ]
}

fn cell() -> impl Strategy<Value = WireCell> {
    let light = (any::<u32>(), vec(any::<u32>(), 0..6))
        .prop_map(|(light, occluders)| WireLight { light, occluders });
    let body = prop_oneof![
        Just(WireBody::Interior),
        (
            proptest::option::of(any::<[[f32; 3]; 2]>()),
            vec(light, 0..5),
            vec(any::<u32>(), 0..5),
            vec(any::<u32>(), 0..5)
        )
            .prop_map(|(region, lights, hidden, crowded)| WireBody::Leaf {
                region,
                lights,
                hidden,
                crowded
            })
    ];
    (any::<u64>(), any::<u64>(), body).prop_map(|(key, version, body)| WireCell {
        key,
        version,
        body,
    })
}

pub(crate) fn constructor_to_shader() -> impl Strategy<Value = ConstructorToShader> {
    use ConstructorToShader as M;
    let welcome = (any::<u32>(), hash(), any::<u64>(), any::<[u32; 3]>()).prop_map(
        |(id, scene, scene_length, [max_depth, split_threshold, trust])| ShaderWelcome {
            id,
            scene,
            scene_length,
            settings: WireLieSettings {
                max_depth,
                split_threshold,
                trust,
            },
        },
    );
    let chunk = (any::<u64>(), vec(any::<u8>(), 0..300))
        .prop_map(|(offset, bytes)| SceneChunk { offset, bytes });
    let delta = (
        any::<[u64; 2]>(),
        any::<u32>(),
        any::<bool>(),
        vec(cell(), 0..8),
    )
        .prop_map(|([from_version, to_version], part, last, cells)| LieDelta {
            from_version,
            to_version,
            part,
            last,
            cells,
        });
    prop_oneof![
        refuse().prop_map(M::Refuse),
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        welcome.prop_map(M::Welcome),
        chunk.prop_map(M::SceneChunk),
        hash().prop_map(|scene| M::SceneReady(SceneReady { scene })),
        delta.prop_map(M::LieDelta),
    ]
}

pub(crate) fn shader_to_constructor() -> impl Strategy<Value = ShaderToConstructor> {
    use ShaderToConstructor as M;
    prop_oneof![
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        (hash(), any::<u64>())
            .prop_map(|(scene, offset)| M::SceneRequest(SceneRequest { scene, offset })),
        hash().prop_map(|scene| M::Subscribe(Subscribe { scene })),
        hash().prop_map(|scene| M::Ready(ShaderReady { scene })),
        audit().prop_map(M::Audit),
        shader_report().prop_map(M::Report),
        any::<u64>().prop_map(|have_version| M::Resync(ResyncRequest { have_version })),
    ]
}

fn shader_report() -> impl Strategy<Value = ShaderReport> {
    (any::<[u64; 7]>(), any::<[u32; 2]>()).prop_map(|(counts, now)| ShaderReport {
        tiles: counts[0],
        camera_rays: counts[1],
        shadow_rays: counts[2],
        list_rays: counts[3],
        render_ns: counts[4],
        lie_version: counts[5],
        sent_bytes: counts[6],
        clients: now[0],
        outstanding: now[1],
    })
}

fn audit() -> impl Strategy<Value = AuditReport> {
    let mismatch = (
        any::<u32>(),
        [point(), point(), point()],
        [number(), number()],
    )
        .prop_map(|(light, [at, origin, direction], span)| WireMismatch {
            light,
            point: at,
            origin,
            direction,
            span,
        });
    (any::<[u64; 2]>(), vec(mismatch, 0..5)).prop_map(|([rays, wrong], mismatches)| AuditReport {
        rays,
        wrong,
        mismatches,
    })
}

fn summary() -> impl Strategy<Value = SceneSummary> {
    (
        (text(), hash(), [point(), point()], any::<[u64; 2]>()),
        (vec(camera(), 0..4), vec(walkthrough(), 0..3)),
        (any::<[u32; 6]>(), number()),
    )
        .prop_map(
            |(
                (name, hash, bounds, [triangles, lights]),
                (cameras, walkthroughs),
                ([x, y, spp, samples, depth, split], exposure_stops),
            )| SceneSummary {
                name,
                hash,
                bounds,
                triangles,
                lights,
                cameras,
                walkthroughs,
                settings: WireRenderSettings {
                    size: [x, y],
                    samples_per_pixel: spp,
                    light_samples: samples,
                    exposure_stops,
                    max_depth: depth,
                    split_threshold: split,
                },
            },
        )
}

pub(crate) fn constructor_to_client() -> impl Strategy<Value = ConstructorToClient> {
    use ConstructorToClient as M;
    let entry =
        (any::<[u32; 2]>(), text(), any::<[bool; 2]>()).prop_map(|([id, threads], address, is)| {
            RosterEntry {
                id,
                address,
                threads,
                ready: is[0],
                replays: is[1],
            }
        });
    prop_oneof![
        refuse().prop_map(M::Refuse),
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        (any::<u32>(), summary()).prop_map(|(id, scene)| M::Welcome(ClientWelcome { id, scene })),
        vec(entry, 0..5).prop_map(|shaders| M::Roster(Roster { shaders })),
        lie_status().prop_map(M::LieStatus),
    ]
}

fn lie_status() -> impl Strategy<Value = LieStatus> {
    (any::<[u64; 10]>(), number(), any::<[bool; 2]>()).prop_map(
        |(
            [
                version,
                serial,
                cells,
                entries,
                occluders,
                bytes,
                samples,
                sent_bytes,
                audit_rays,
                audit_wrong,
            ],
            error,
            flags,
        )| LieStatus {
            version,
            camera_serial: serial,
            cells,
            entries,
            occluders,
            bytes,
            samples,
            sent_bytes,
            audit_rays,
            audit_wrong,
            estimated_error: error,
            converged: flags[0],
            frozen: flags[1],
        },
    )
}

fn client_report() -> impl Strategy<Value = ClientReport> {
    any::<[u64; 4]>().prop_map(|counts| ClientReport {
        frames: counts[0],
        frame_us: counts[1],
        lost_tiles: counts[2],
        reissued_tiles: counts[3],
    })
}

pub(crate) fn constructor_to_observer() -> impl Strategy<Value = ConstructorToObserver> {
    use ConstructorToObserver as M;
    use proptest::option;
    let health = prop_oneof![
        Just(ShaderHealth::Starting),
        Just(ShaderHealth::Ready),
        Just(ShaderHealth::Silent)
    ];
    let shader = (
        (any::<[u32; 2]>(), any::<bool>()),
        text(),
        health,
        any::<[u64; 3]>(),
        option::of(any::<u64>()),
        option::of(shader_report()),
    )
        .prop_map(
            |(([id, threads], replays), address, health, times, ping_us, report)| ShaderStatus {
                id,
                address,
                threads,
                replays,
                health,
                joined_ms: times[0],
                heard_ms: times[1],
                sent_bytes: times[2],
                ping_us,
                report,
            },
        );
    let client = (
        any::<u32>(),
        text(),
        any::<[u64; 2]>(),
        option::of(client_report()),
    )
        .prop_map(|(id, address, [joined_ms, cameras], report)| ClientStatus {
            id,
            address,
            joined_ms,
            cameras,
            report,
        });
    let status = (
        (text(), text(), hash(), any::<[u64; 5]>()),
        (lie_status(), number()),
        (vec(shader, 0..4), vec(client, 0..4)),
    )
        .prop_map(
            |((build, scene, hash, numbers), (lies, samples_per_s), (shaders, clients))| {
                FarmStatus {
                    build,
                    scene,
                    hash,
                    triangles: numbers[0],
                    lights: numbers[1],
                    uptime_ms: numbers[2],
                    lies,
                    samples_per_s,
                    shaders_joined: numbers[3],
                    shaders_lost: numbers[4],
                    shaders,
                    clients,
                }
            },
        );
    prop_oneof![refuse().prop_map(M::Refuse), status.prop_map(M::Status),]
}

pub(crate) fn client_to_constructor() -> impl Strategy<Value = ClientToConstructor> {
    use ClientToConstructor as M;
    prop_oneof![
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        (any::<u64>(), camera(), any::<[u32; 2]>()).prop_map(|(serial, camera, size)| M::Camera(
            CameraUpdate {
                serial,
                camera,
                size
            }
        )),
        client_report().prop_map(M::Report),
    ]
}

pub(crate) fn shader_to_client() -> impl Strategy<Value = ShaderToClient> {
    use ShaderToClient as M;
    let tile = (any::<[u64; 16]>(), any::<u32>(), vec(any::<u8>(), 0..400)).prop_map(
        |(numbers, tile, pixels)| TileDone {
            report: TileReport {
                frame: numbers[0],
                tile,
                lie_version: numbers[1],
                cost: WireCost {
                    queued_ns: numbers[2],
                    render_ns: numbers[3],
                    visibility_ns: numbers[4],
                    unoccluded_ns: numbers[5],
                    partial_ns: numbers[6],
                    full_ns: numbers[7],
                    primary_rays: numbers[8],
                    shadow_rays: numbers[9],
                    list_rays: numbers[10],
                    occluder_tests: numbers[11],
                    evaluations: numbers[12],
                    trusted: numbers[13],
                    idle_ns: numbers[14],
                    pack_ns: numbers[15],
                },
            },
            pixels,
        },
    );
    prop_oneof![
        refuse().prop_map(M::Refuse),
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        (hash(), any::<u32>(), any::<bool>()).prop_map(|(scene, threads, replays)| {
            M::Welcome(TileWelcome {
                scene,
                threads,
                replays,
            })
        }),
        tile.prop_map(M::TileDone),
        (any::<u64>(), any::<u32>(), text()).prop_map(|(frame, tile, reason)| {
            M::TileFailed(TileFailed {
                frame,
                tile,
                reason,
            })
        }),
    ]
}

pub(crate) fn client_to_shader() -> impl Strategy<Value = ClientToShader> {
    use ClientToShader as M;
    let begin = (
        any::<[u64; 2]>(),
        camera(),
        any::<[u32; 5]>(),
        any::<[bool; 3]>(),
    )
        .prop_map(
            |([frame, seed], camera, [x, y, samples_per_pixel, light_samples, view], flags)| {
                BeginFrame {
                    frame,
                    view,
                    camera,
                    size: [x, y],
                    samples_per_pixel,
                    light_samples,
                    integrator: if flags[0] {
                        WireIntegrator::Lie
                    } else {
                        WireIntegrator::Standard
                    },
                    seed,
                    format: if flags[1] {
                        PixelFormat::F16
                    } else {
                        PixelFormat::F32
                    },
                    compression: if flags[2] {
                        Compression::Lz4
                    } else {
                        Compression::None
                    },
                }
            },
        );
    prop_oneof![
        ping().prop_map(M::Ping),
        pong().prop_map(M::Pong),
        goodbye().prop_map(M::Goodbye),
        begin.prop_map(M::BeginFrame),
        (any::<u64>(), any::<[u32; 5]>()).prop_map(|(frame, [tile, x, y, w, h])| {
            M::TileRequest(TileRequest {
                frame,
                tile,
                origin: [x, y],
                size: [w, h],
            })
        }),
        any::<u64>().prop_map(|frame| M::CancelBefore(CancelBefore { frame })),
    ]
}
