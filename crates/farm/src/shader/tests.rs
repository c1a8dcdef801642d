mod panics;

use lie_protocol::{
    BeginFrame, ClientToShader, Compression, ConstructorToShader as Out, LieDelta, PixelFormat,
    SceneChunk, SceneReady, ShaderToClient, ShaderToConstructor as In, ShaderWelcome, WireBody,
    WireCell, WireIntegrator, WireLieSettings,
};
use tokio::{
    io::{ReadHalf, WriteHalf},
    net::{TcpListener, TcpStream},
};

use super::*;
use crate::{
    connection::{self, Receiver, Sender},
    convert, handshake,
    scene_blob::{SceneBlob, encode, tests::full_scene},
};

type Ends = (Receiver<ReadHalf<TcpStream>>, Sender<WriteHalf<TcpStream>>);

fn cell(key: u64, version: u64) -> WireCell {
    WireCell {
        key,
        version,
        body: WireBody::Leaf {
            region: None,
            lights: vec![],
            hidden: vec![],
            crowded: vec![],
        },
    }
}

fn delta(from_version: u64, to_version: u64) -> Out {
    Out::LieDelta(LieDelta {
        from_version,
        to_version,
        part: 0,
        last: true,
        cells: vec![cell(1, to_version)],
    })
}

/// Takes a shader in, as a constructor would, and gives it the scene if it asks.
async fn welcome(listener: &TcpListener, blob: &SceneBlob) -> (Ends, bool) {
    let (stream, _) = listener.accept().await.unwrap();
    let (mut receiver, mut sender) = connection::split(stream);
    handshake::await_hello(&mut receiver, &mut sender)
        .await
        .unwrap();
    let scene = blob.hash();
    let welcome = ShaderWelcome {
        id: 1,
        scene,
        scene_length: blob.bytes().len() as u64,
        settings: WireLieSettings {
            max_depth: 4,
            split_threshold: 4,
            trust: 1,
        },
    };
    sender.send(&Out::Welcome(welcome)).await.unwrap();
    let mut asked = false;
    loop {
        match receiver.receive::<In>().await.unwrap() {
            In::SceneRequest(_) => {
                asked = true;
                let chunk = SceneChunk {
                    offset: 0,
                    bytes: blob.bytes().to_vec(),
                };
                sender.send(&Out::SceneChunk(chunk)).await.unwrap();
                sender
                    .send(&Out::SceneReady(SceneReady { scene }))
                    .await
                    .unwrap();
            }
            In::Subscribe(_) => return ((receiver, sender), asked),
            _ => {}
        }
    }
}

/// A frame of one pixel.
fn begin(frame: u64) -> BeginFrame {
    BeginFrame {
        frame,
        view: 1,
        camera: convert::wire_camera(&full_scene().cameras[0]),
        size: [1, 1],
        samples_per_pixel: 1,
        light_samples: 1,
        integrator: WireIntegrator::Standard,
        seed: 0,
        format: PixelFormat::F32,
        compression: Compression::None,
    }
}

async fn next_resync(receiver: &mut Receiver<ReadHalf<TcpStream>>) -> u64 {
    loop {
        if let In::Resync(request) = receiver.receive().await.unwrap() {
            return request.have_version;
        }
    }
}

#[tokio::test]
async fn a_gap_leads_to_a_resync_and_a_damaged_cache_to_another_fetch() {
    let home = tempfile::tempdir().unwrap();
    let cache = SceneCache::open(home.path()).unwrap();
    let blob = SceneBlob::new(encode(&full_scene()).unwrap());
    let constructor = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let config = ShaderConfig {
        constructor: constructor.local_addr().unwrap().to_string(),
        exposure: Exposure::Loopback,
        threads: 1,
        accel: AccelKind::Bvh,
        audit: 1.0,
        cache: Some(cache.clone()),
    };
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let shutdown = CancellationToken::new();
    let shader = tokio::spawn(run(config, listener, shutdown.clone()));

    let ((mut receiver, mut sender), asked) = welcome(&constructor, &blob).await;
    assert!(asked);
    sender.send(&delta(0, 1)).await.unwrap();
    sender.send(&delta(1, 2)).await.unwrap();
    sender.send(&delta(5, 6)).await.unwrap();
    assert_eq!(next_resync(&mut receiver).await, 2);
    // What follows does not fit either, until the snapshot.
    sender.send(&delta(6, 7)).await.unwrap();
    assert_eq!(next_resync(&mut receiver).await, 2);
    sender.send(&delta(0, 7)).await.unwrap();
    sender.send(&delta(9, 10)).await.unwrap();
    assert_eq!(next_resync(&mut receiver).await, 7);

    // A constructor that comes back finds the scene in place.
    drop((receiver, sender));
    let (ends, asked) = welcome(&constructor, &blob).await;
    assert!(!asked);
    drop(ends);

    // Clients are served all the while.
    let stream = TcpStream::connect(address).await.unwrap();
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(lie_protocol::Role::Client, 0, 0);
    let answer = handshake::greet(&mut receiver, &mut sender, hello)
        .await
        .unwrap();
    let ShaderToClient::Welcome(welcome_message) = answer else {
        panic!("{answer:?}");
    };
    assert_eq!(welcome_message.scene, blob.hash());
    // A tile of no frame breaks the rules and ends this session alone.
    let request = lie_protocol::TileRequest {
        frame: 1,
        tile: 0,
        origin: [0, 0],
        size: [1, 1],
    };
    sender
        .send(&ClientToShader::TileRequest(request))
        .await
        .unwrap();
    while receiver.receive::<ShaderToClient>().await.is_ok() {}

    // So does a frame that is begun a second time, past the credits of the first.
    let stream = TcpStream::connect(address).await.unwrap();
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(lie_protocol::Role::Client, 0, 0);
    let answer: ShaderToClient = handshake::greet(&mut receiver, &mut sender, hello)
        .await
        .unwrap();
    assert!(matches!(answer, ShaderToClient::Welcome(_)));
    for _ in 0..2 {
        sender
            .send(&ClientToShader::BeginFrame(begin(1)))
            .await
            .unwrap();
    }
    let ended = tokio::time::timeout(std::time::Duration::from_secs(5), async {
        while receiver.receive::<ShaderToClient>().await.is_ok() {}
    });
    ended.await.expect("the session ends");
    shutdown.cancel();
    shader.await.unwrap().unwrap();

    // A new process takes the scene from the cache, but not from a damaged one.
    for (damage, expected) in [(false, false), (true, true)] {
        if damage {
            std::fs::write(cache.path(blob.hash()), b"scene").unwrap();
        }
        let config = ShaderConfig {
            constructor: constructor.local_addr().unwrap().to_string(),
            exposure: Exposure::Loopback,
            threads: 1,
            accel: AccelKind::Grid,
            audit: 0.0,
            cache: Some(cache.clone()),
        };
        let shutdown = CancellationToken::new();
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let shader = tokio::spawn(run(config, listener, shutdown.clone()));
        let (ends, asked) = welcome(&constructor, &blob).await;
        assert_eq!(asked, expected);
        shutdown.cancel();
        drop(ends);
        shader.await.unwrap().unwrap();
    }
    assert_eq!(cache.load(blob.hash()).as_deref(), Some(blob.bytes()));
}
