//! Tiles that shaders say they cannot render: the client hears of it, and nothing waits for ever. The
//! shaders that fail are of this test and speak the protocol; all else is the real binary.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    fs,
    path::Path,
    process::Command,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use lie_farm::{
    connection::{self, LinkError},
    handshake,
};
use lie_protocol::{
    ClientToShader, ConstructorToShader, Ping, Pong, Role, SceneHash, ShaderReady, ShaderToClient,
    ShaderToConstructor, Subscribe, Text, TileFailed, TileWelcome,
};
use support::{Process, failure, lie, succeeds};
use tokio::net::{TcpListener, TcpStream};

const REASON: &str = "index out of bounds: the len is 3 but the index is 7";

/// A shader that cannot render anything.
struct Failing {
    address: String,
    asked: Arc<AtomicUsize>,
}

impl Failing {
    async fn start(constructor: &Process) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let asked = Arc::<AtomicUsize>::default();
        let scene = join(&constructor.address, address.port()).await;
        let counted = asked.clone();
        tokio::spawn(async move {
            while let Ok((client, _)) = listener.accept().await {
                tokio::spawn(fail(client, scene, counted.clone()));
            }
        });
        Self {
            address: address.to_string(),
            asked,
        }
    }

    fn asked(&self) -> usize {
        self.asked.load(Ordering::Relaxed)
    }
}

/// Becomes one of the constructor's shaders, and stays so.
async fn join(constructor: &str, port: u16) -> SceneHash {
    let stream = TcpStream::connect(constructor).await.unwrap();
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Shader, 1, port);
    let answer = handshake::greet(&mut receiver, &mut sender, hello).await;
    let ConstructorToShader::Welcome(welcome) = answer.unwrap() else {
        panic!("no welcome");
    };
    let scene = welcome.scene;
    let subscribe = ShaderToConstructor::Subscribe(Subscribe { scene });
    sender.send(&subscribe).await.unwrap();
    tokio::spawn(async move {
        let mut is_ready = false;
        while let Ok(message) = receiver.receive().await {
            let answer = match message {
                ConstructorToShader::LieDelta(_) if !std::mem::replace(&mut is_ready, true) => {
                    ShaderToConstructor::Ready(ShaderReady { scene })
                }
                ConstructorToShader::Ping(Ping { nonce }) => {
                    ShaderToConstructor::Pong(Pong { nonce })
                }
                _ => continue,
            };
            sender.send(&answer).await.unwrap();
        }
    });
    scene
}

/// Fails at every tile that a client asks for.
async fn fail(
    client: TcpStream,
    scene: SceneHash,
    asked: Arc<AtomicUsize>,
) -> Result<(), LinkError> {
    let (mut receiver, mut sender) = connection::split(client);
    handshake::await_hello(&mut receiver, &mut sender).await?;
    let welcome = TileWelcome {
        scene,
        threads: 1,
        replays: false,
    };
    sender.send(&ShaderToClient::Welcome(welcome)).await?;
    loop {
        let answer = match receiver.receive().await? {
            ClientToShader::TileRequest(request) => {
                asked.fetch_add(1, Ordering::Relaxed);
                ShaderToClient::TileFailed(TileFailed {
                    frame: request.frame,
                    tile: request.tile,
                    reason: Text::new(REASON),
                })
            }
            ClientToShader::Ping(Ping { nonce }) => ShaderToClient::Pong(Pong { nonce }),
            _ => continue,
        };
        sender.send(&answer).await?;
    }
}

fn frozen() -> Process {
    Process::constructor(&["--freeze", "--samples", "5000", "--freeze-size", "160x120"])
}

/// A client without a window.
fn view(constructor: &Process, shaders: &str) -> Command {
    let mut view = lie();
    view.args(["view", "--headless", "--constructor", &constructor.address]);
    view.args(["--wait-shaders", shaders, "--frames", "3"]);
    view.args(["--size", "160x120"]);
    view
}

fn pictures(constructor: &Process, shaders: &str, out: &Path) -> Vec<Vec<u8>> {
    succeeds(view(constructor, shaders).arg("--out").arg(out));
    let frame = |index| fs::read(out.join(format!("frame-{index:04}.exr"))).unwrap();
    (0..3).map(frame).collect()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_ends_with_the_reason_where_all_shaders_fail() {
    let constructor = frozen();
    let alone = Failing::start(&constructor).await;
    let message = failure(&mut view(&constructor, "1"), 1);
    assert_eq!(
        message.matches(&format!("{} says", alone.address)).count(),
        3
    );

    let second = Failing::start(&constructor).await;
    let message = failure(&mut view(&constructor, "2"), 1);
    for piece in [
        "cannot be rendered",
        "tile ",
        REASON,
        &format!("{} says '{REASON}'", alone.address),
        &format!("{} says '{REASON}'", second.address),
    ] {
        assert!(message.contains(piece), "no '{piece}' in: {message}");
    }
    let warned = message.matches("cannot render a tile").count();
    assert_eq!(warned, 2, "once for each shader: {message}");
    assert!(second.asked() > 0);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_one_shader_cannot_render_another_does() {
    let home = tempfile::tempdir().unwrap();
    let constructor = frozen();
    let _whole = Process::shader(&constructor.address);
    let expected = pictures(&constructor, "1", &home.path().join("whole"));
    let failing = Failing::start(&constructor).await;
    let pictures = pictures(&constructor, "2", &home.path().join("mixed"));
    assert!(pictures == expected, "pictures differ");
    assert!(failing.asked() > 0, "it was never asked");
}
