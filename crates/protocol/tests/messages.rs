//! Every message survives the way there, however the bytes are cut; no bytes do harm.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod strategy;

use lie_protocol::*;
use proptest::prelude::*;
use std::fmt::Debug;

/// Encodes, then decodes with the stream cut in two at every byte.
fn check_round_trip<M: Message + Debug + PartialEq>(message: &M) {
    let mut bytes = Vec::new();
    encode(message, &mut bytes).unwrap();
    for cut in 0..=bytes.len() {
        let mut decoder = Decoder::default();
        decoder.push(&bytes[..cut]);
        let early: Option<M> = decoder.next().unwrap();
        assert_eq!(early.is_some(), cut == bytes.len());
        decoder.push(&bytes[cut..]);
        let late = early.or_else(|| decoder.next().unwrap());
        assert_eq!(late.as_ref(), Some(message));
        assert_eq!(decoder.pending(), 0);
    }
    check_strictness::<M>(&bytes);
}

/// A body with one byte more than it needs, or one less, is refused (bytes of a scene or
/// of pixels may be any number, and the timeless messages may grow).
fn check_strictness<M: Message + Debug>(bytes: &[u8]) {
    let kind = u16::from_le_bytes([bytes[6], bytes[7]]);
    let length = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
    if [1, 2, 17, 49].contains(&kind) {
        return;
    }
    let mut longer = bytes.to_vec();
    longer.push(0);
    longer[8..12].copy_from_slice(&(length + 1).to_le_bytes());
    let mut shorter = bytes[..bytes.len() - 1].to_vec();
    shorter[8..12].copy_from_slice(&(length - 1).to_le_bytes());
    for wrong in [longer, shorter] {
        let mut decoder = Decoder::default();
        decoder.push(&wrong);
        let result = decoder.next::<M>();
        assert!(
            matches!(result, Err(ProtocolError::Malformed { .. })),
            "{result:?}"
        );
    }
}

/// Reads as much as can be read.
fn feed<M: Message>(bytes: &[u8]) {
    let mut decoder = Decoder::default();
    for piece in bytes.chunks(7) {
        decoder.push(piece);
        loop {
            match decoder.next::<M>() {
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => return,
            }
        }
        assert!(decoder.pending() <= bytes.len());
    }
}

fn feed_all(bytes: &[u8]) {
    feed::<Opening>(bytes);
    feed::<ConstructorToShader>(bytes);
    feed::<ShaderToConstructor>(bytes);
    feed::<ConstructorToClient>(bytes);
    feed::<ClientToConstructor>(bytes);
    feed::<ShaderToClient>(bytes);
    feed::<ClientToShader>(bytes);
    feed::<ConstructorToObserver>(bytes);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn openings_round_trip(message in strategy::opening()) {
        check_round_trip(&message);
    }

    #[test]
    fn constructor_to_shader_round_trips(message in strategy::constructor_to_shader()) {
        check_round_trip(&message);
    }

    #[test]
    fn shader_to_constructor_round_trips(message in strategy::shader_to_constructor()) {
        check_round_trip(&message);
    }

    #[test]
    fn constructor_to_client_round_trips(message in strategy::constructor_to_client()) {
        check_round_trip(&message);
    }

    #[test]
    fn client_to_constructor_round_trips(message in strategy::client_to_constructor()) {
        check_round_trip(&message);
    }

    #[test]
    fn constructor_to_observer_round_trips(message in strategy::constructor_to_observer()) {
        check_round_trip(&message);
    }

    #[test]
    fn shader_to_client_round_trips(message in strategy::shader_to_client()) {
        check_round_trip(&message);
    }

    #[test]
    fn client_to_shader_round_trips(message in strategy::client_to_shader()) {
        check_round_trip(&message);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn arbitrary_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        feed_all(&bytes);
    }

    #[test]
    fn arbitrary_bodies_do_no_harm(
        kind in 0u16..80,
        version in PROTOCOL_VERSION - 1..=PROTOCOL_VERSION + 1,
        body in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        let header = Header { version, kind, length: body.len() as u32 };
        let mut bytes = header.to_bytes().to_vec();
        bytes.extend_from_slice(&body);
        feed_all(&bytes);
    }
}

#[test]
fn a_length_over_the_limit_is_refused_from_the_header_alone() {
    for kind in 0..80 {
        for length in [limit::LIE_DELTA + 1, u32::MAX] {
            let header = Header {
                version: PROTOCOL_VERSION,
                kind,
                length,
            };
            let mut decoder = Decoder::default();
            decoder.push(&header.to_bytes());
            let result = decoder.next::<ConstructorToShader>();
            let refused = matches!(
                result,
                Err(ProtocolError::TooLong { .. } | ProtocolError::Kind(_))
            );
            assert!(refused, "{result:?}");
        }
    }
}

/// A farm of so many shaders and clients, with all that they can say of themselves.
fn farm(shaders: u32, clients: u32) -> ConstructorToObserver {
    let long = Text::new(&"x".repeat(limit::TEXT));
    let shader = |id| ShaderStatus {
        id,
        address: long.clone(),
        threads: u32::MAX,
        health: ShaderHealth::Silent,
        joined_ms: u64::MAX,
        heard_ms: u64::MAX,
        ping_us: Some(u64::MAX),
        sent_bytes: u64::MAX,
        report: Some(ShaderReport {
            tiles: u64::MAX,
            camera_rays: u64::MAX,
            shadow_rays: u64::MAX,
            list_rays: u64::MAX,
            render_ns: u64::MAX,
            lie_version: u64::MAX,
            clients: u32::MAX,
            outstanding: u32::MAX,
            sent_bytes: u64::MAX,
        }),
    };
    let client = |id| ClientStatus {
        id,
        address: long.clone(),
        joined_ms: u64::MAX,
        cameras: u64::MAX,
        report: None,
    };
    ConstructorToObserver::Status(FarmStatus {
        build: long.clone(),
        scene: long.clone(),
        hash: SceneHash::default(),
        triangles: 0,
        lights: 0,
        uptime_ms: 0,
        lies: LieStatus::default(),
        samples_per_s: 0.0,
        shaders_joined: 0,
        shaders_lost: 0,
        shaders: (0..shaders).map(shader).collect(),
        clients: (0..clients).map(client).collect(),
    })
}

#[test]
fn the_largest_farm_has_a_status_and_a_larger_one_is_refused() {
    let (shaders, clients) = (limit::SHADERS as u32, limit::CLIENTS as u32);
    check_once(&farm(shaders, clients)).unwrap();
    for too_large in [farm(shaders + 1, 0), farm(0, clients + 1)] {
        let refused = check_once(&too_large);
        assert!(
            matches!(refused, Err(ProtocolError::Malformed { kind: 64, .. })),
            "{refused:?}"
        );
    }
}

fn check_once(message: &ConstructorToObserver) -> Result<(), ProtocolError> {
    let mut bytes = Vec::new();
    encode(message, &mut bytes)?;
    let mut decoder = Decoder::default();
    decoder.push(&bytes);
    let read = decoder.next::<ConstructorToObserver>()?;
    assert_eq!(read.as_ref(), Some(message));
    Ok(())
}

#[test]
fn messages_in_sequence_come_out_in_sequence_and_errors_are_named() {
    let mut bytes = Vec::new();
    for nonce in 0..3 {
        encode(&ClientToShader::Ping(Ping { nonce }), &mut bytes).unwrap();
    }
    let mut decoder = Decoder::default();
    decoder.push(&bytes);
    for nonce in 0..3 {
        let message = decoder.next::<ClientToShader>().unwrap();
        assert_eq!(message, Some(ClientToShader::Ping(Ping { nonce })));
    }
    decoder.push(b"GET / HTTP/1.1\r\n");
    assert_eq!(
        decoder.next::<ClientToShader>(),
        Err(ProtocolError::Magic(*b"GET "))
    );

    let mut other_version = bytes[..Header::LENGTH].to_vec();
    other_version[4] = 8;
    let mut decoder = Decoder::default();
    decoder.push(&other_version);
    assert_eq!(
        decoder.next::<ClientToShader>(),
        Err(ProtocolError::Version { theirs: 8 })
    );
}

#[test]
fn what_is_too_long_to_be_read_is_not_sent() {
    let pixels = vec![0; limit::TILE_PIXELS + 1000];
    let report = TileReport {
        frame: 0,
        tile: 0,
        lie_version: 0,
        cost: WireCost::default(),
    };
    let mut out = vec![1, 2, 3];
    let message = ShaderToClient::TileDone(TileDone { report, pixels });
    let error = encode(&message, &mut out).unwrap_err();
    assert!(matches!(error, ProtocolError::TooLong { kind: 49, .. }));
    assert_eq!(out, [1, 2, 3]);
}
