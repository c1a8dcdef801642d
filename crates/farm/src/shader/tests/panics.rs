//! Shaders whose code panics at tiles: real sessions over real sockets, in a world that is broken.

use std::time::Duration;

use glam::{UVec2, Vec3};
use lie_octree::LieSettings;
use lie_protocol::{
    ClientToConstructor, ClientWelcome, Compression, ConstructorToClient, Ping, PixelFormat, Pong,
    Roster, RosterEntry, Text, WireIntegrator,
};
use lie_render::World;
use lie_scene::{Camera, Scene};
use tokio::{net::TcpListener, time::timeout};

use super::*;
use crate::{
    client::{Client, ClientConfig, ClientError, Frame, FrameRequest},
    connection, convert, handshake,
    scene_blob::{SceneBlob, encode, tests::full_scene},
};

/// A scene in which every hit asks for a material that is not there, which no loader lets through.
fn broken() -> Scene {
    let mut scene = full_scene();
    scene.materials.clear();
    scene.lights.clear();
    scene
}

fn whole() -> Scene {
    let mut scene = full_scene();
    scene.lights.clear();
    scene
}

/// A shader that has this scene and takes it for that of the hash.
async fn shader(scene: Scene, hash: lie_protocol::SceneHash) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let world = Arc::new(World::new(Arc::new(scene)));
    let stage = Stage::new(hash, world, LieSettings::default());
    let (meter, shutdown) = (Arc::<Meter>::default(), CancellationToken::new());
    let shared = Arc::new(Shared {
        stage: watch::Sender::new(Some(Arc::new(stage))),
        pool: RenderPool::start(1, 0.0, meter.clone()).unwrap(),
        meter,
        refusals: Arc::default(),
        threads: 1,
        shutdown: shutdown.clone(),
    });
    let gate = Gate {
        exposure: Exposure::Loopback,
        limit: MAX_CLIENTS,
        refusals: shared.refusals.clone(),
    };
    tokio::spawn(serve(listener, gate, shutdown, move |caller, _peer| {
        let shared = shared.clone();
        async move { client_session::run(&shared, caller).await }
    }));
    address
}

/// A constructor that names these shaders to one client.
async fn constructor(hash: lie_protocol::SceneHash, shaders: &[String]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let scene = convert::summary(&full_scene(), hash);
    let entry = |(id, address): (usize, &String)| RosterEntry {
        id: id as u32,
        address: Text::new(address),
        threads: 1,
        ready: true,
        replays: false,
    };
    let shaders = shaders.iter().enumerate().map(entry).collect();
    tokio::spawn(async move {
        let (stream, _) = listener.accept().await.unwrap();
        let (mut receiver, mut sender) = connection::split(stream);
        let hello = handshake::await_hello(&mut receiver, &mut sender);
        hello.await.unwrap();
        for message in [
            ConstructorToClient::Welcome(ClientWelcome { id: 1, scene }),
            ConstructorToClient::Roster(Roster { shaders }),
        ] {
            sender.send(&message).await.unwrap();
        }
        while let Ok(message) = receiver.receive::<ClientToConstructor>().await {
            if let ClientToConstructor::Ping(Ping { nonce }) = message {
                let pong = ConstructorToClient::Pong(Pong { nonce });
                sender.send(&pong).await.unwrap();
            }
        }
    });
    address
}

/// A client of shaders with these scenes, and their addresses.
async fn client(scenes: impl IntoIterator<Item = Scene>) -> (Client, Vec<String>) {
    let hash = SceneBlob::new(encode(&full_scene()).unwrap()).hash();
    let mut shaders = Vec::new();
    for scene in scenes {
        shaders.push(shader(scene, hash).await);
    }
    let constructor = constructor(hash, &shaders).await;
    let config = ClientConfig::new(constructor, Exposure::Loopback);
    let client = Client::connect(config).await.unwrap();
    client.wait_for_shaders(shaders.len()).await;
    (client, shaders)
}

/// A frame that sees the triangles, or nothing.
async fn render(client: &mut Client, sees: bool) -> Result<Frame, ClientError> {
    let eye = Vec3::new(0.3, 0.3, 3.0);
    let target = if sees { eye - Vec3::Z } else { eye + Vec3::Z };
    let request = FrameRequest {
        camera: Camera::look_at("", eye, target, Vec3::Y, 0.8),
        size: UVec2::splat(200),
        samples_per_pixel: 1,
        light_samples: 1,
        integrator: WireIntegrator::Standard,
        seed: 0,
        format: PixelFormat::F32,
        compression: Compression::None,
    };
    let rendered = timeout(Duration::from_secs(60), client.render_frame(&request));
    rendered.await.expect("the frame ends")
}

#[tokio::test]
async fn a_frame_ends_with_an_error_where_every_shader_panics_at_a_tile() {
    let (mut client, shaders) = client([broken(), broken()]).await;
    let error = render(&mut client, true).await.unwrap_err();
    assert!(matches!(error, ClientError::Tile { .. }), "{error}");
    let message = error.to_string();
    for piece in [&*shaders[0], &*shaders[1], "tile ", "index out of bounds"] {
        assert!(message.contains(piece), "no '{piece}' in: {message}");
    }
    // Both are still there, their threads too, and render what they can.
    render(&mut client, false).await.unwrap();
    assert_eq!(client.shaders(), 2);
}

#[tokio::test]
async fn a_shader_that_is_alone_has_another_try_and_then_the_frame_ends() {
    let (mut client, shaders) = client([broken()]).await;
    let message = render(&mut client, true).await.unwrap_err().to_string();
    assert_eq!(message.matches(&shaders[0]).count(), 3, "{message}");
}

#[tokio::test]
async fn what_one_shader_panics_at_another_renders() {
    let (mut alone, _) = client([whole()]).await;
    let expected = render(&mut alone, true).await.unwrap();
    let (mut mixed, shaders) = client([broken(), whole()]).await;
    let frame = render(&mut mixed, true).await.unwrap();
    assert!(frame.film == expected.film, "the pictures differ");
    assert!(
        frame
            .stats
            .shaders
            .iter()
            .any(|share| share.address == shaders[1])
    );
}
