//! A farm that is protected by a bundle, and those who do not belong to it: real processes
//! over real sockets.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    thread,
    time::Duration,
};

use lie_farm::{
    client::{Client, ClientConfig},
    connection, handshake,
    network::{self, Exposure},
};
use lie_protocol::{ConstructorToClient, Role, ShaderToClient};
use support::{
    Process,
    bundles::Authority,
    secured::{Farm, cluster, connect, new_bundle, render, shader},
};
use tokio::time::sleep;

/// Longer than anything here takes, and shorter than anybody likes to wait.
const SOON: Duration = Duration::from_secs(20);

/// A shader that is to end by itself; what it says then.
fn refused_shader(constructor: &str, more: &[&str]) -> String {
    let mut shader = support::lie();
    shader.args(["shader", "--constructor", constructor, "--no-cache"]);
    shader.args(["--listen", "127.0.0.1:0"]).args(more);
    support::failure(&mut shader, 1)
}

/// A view that is to fail; what it says then.
fn refused_view(constructor: &str, more: &[&str]) -> String {
    let mut view = support::lie();
    support::failure(
        view.args(["view", "--constructor", constructor]).args(more),
        1,
    )
}

fn count(process: &Process, line: &str) -> usize {
    process.log().matches(line).count()
}

fn hears(process: &Process, line: &str) {
    support::wait_until(line, || count(process, line) > 0);
}

#[tokio::test]
async fn a_farm_with_a_bundle_gives_the_pictures_of_one_without() {
    let home = tempfile::tempdir().unwrap();
    let frames = |name: &str, more: &[&str]| {
        let out = home.path().join(name);
        let mut run = support::lie();
        run.arg("run").arg(support::cornell());
        run.args([
            "--frames",
            "2",
            "--size",
            "64x48",
            "--integrator",
            "standard",
        ]);
        run.args(more).arg("--out").arg(&out);
        run.arg("--cache").arg(home.path().join("cache"));
        support::succeeds(&mut run);
        ["frame-0000.exr", "frame-0001.exr"].map(|name| std::fs::read(out.join(name)).unwrap())
    };
    let bundle = new_bundle(home.path(), "bundle.pem");
    let plain = frames("plain", &["--insecure"]);
    assert!(plain == frames("fresh", &[]), "with a bundle of its own");
    let named = frames("named", &["--bundle", &bundle]);
    assert!(plain == named, "with a bundle that is named");

    // And one by one, where client, constructor and shader know each other by the file alone.
    let mut farm = Farm::start(bundle.as_ref()).await;
    let secured = render(&mut farm.client, 1).await;
    let constructor = Process::constructor(&[]);
    let _shader = shader(&constructor.address, &[]);
    let mut client = connect(&constructor, Exposure::Loopback).await;
    client.wait_for_shaders(1).await;
    assert!(secured.film == render(&mut client, 1).await.film);
}

#[test]
fn nothing_of_a_runs_bundle_is_left_behind_or_shown() {
    let home = tempfile::tempdir().unwrap();
    let mut run = support::lie();
    run.arg("run").arg(support::cornell()).arg("--cache");
    run.arg(home.path().join("cache"))
        .env("TMPDIR", home.path());
    run.args(["--shaders", "1", "--frames", "1000000", "--size", "64x64"]);
    let mut run = run.spawn().unwrap();
    let mut children = Vec::new();
    support::wait_until("two children run", || {
        children = support::children_of(run.id());
        children.len() == 2
    });
    for child in children {
        for file in ["environ", "cmdline"] {
            let shown = std::fs::read(format!("/proc/{child}/{file}")).unwrap();
            assert!(!String::from_utf8_lossy(&shown).contains("BEGIN"), "{file}");
        }
    }
    run.kill().unwrap();
    run.wait().unwrap();
    for entry in std::fs::read_dir(home.path()).unwrap() {
        assert_eq!(entry.unwrap().file_name(), "cache");
    }
}

#[test]
fn other_machines_need_a_bundle_or_the_users_word() {
    let scene = support::cornell();
    let scene = scene.to_str().unwrap();
    for arguments in [
        &["constructor", scene, "--listen", "0.0.0.0:0"][..],
        &[
            "shader",
            "--constructor",
            "127.0.0.1:1",
            "--listen",
            "0.0.0.0:0",
        ],
        &["shader", "--constructor", "192.0.2.1:1"],
        &["view", "--constructor", "192.0.2.1:1"],
    ] {
        let message = support::failure(support::lie().args(arguments), 2);
        for way in ["lie key new", "--bundle", "--insecure"] {
            assert!(message.contains(way), "{arguments:?}: {message}");
        }
    }
    let insecure = Process::constructor(&["--listen", "0.0.0.0:0", "--insecure"]);
    hears(&insecure, "neither encrypted nor authenticated");
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "bundle.pem");
    let secured = Process::constructor(&["--listen", "0.0.0.0:0", "--bundle", &bundle]);
    assert!(!secured.log().contains("WARN"), "{}", secured.log());
}

#[tokio::test]
async fn those_who_do_not_belong_are_told_why_and_named_once() {
    let home = tempfile::tempdir().unwrap();
    let authority = Authority::new();
    let write = |name: &str, text: String| {
        let path = home.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let ours = write("ours.pem", authority.node(-10, 1000));
    let foreign = new_bundle(home.path(), "foreign.pem");
    let mut farm = Farm::start(ours.as_ref()).await;
    let address = farm.constructor.address.clone();
    let quiet = render(&mut farm.client, 1).await;

    // Another cluster: whoever dials sees it first, and the other side hears of it.
    let told = refused_shader(&address, &["--bundle", &foreign]);
    assert!(
        told.contains(&address) && told.contains("another cluster"),
        "{told}"
    );
    let told = refused_view(&address, &["--bundle", &foreign]);
    assert!(told.contains("another cluster"), "{told}");
    hears(
        &farm.constructor,
        "refused: it does not accept our certificate",
    );

    // No bundle at all.
    let told = refused_shader(&address, &[]);
    assert!(
        told.contains("it uses TLS") && told.contains("--bundle"),
        "{told}"
    );
    assert!(refused_view(&address, &[]).contains("it uses TLS"));
    hears(&farm.constructor, "refused: it does not use TLS");

    // Ours, but too old: it was good when the process began.
    let short = write("short.pem", authority.node(-10, 4));
    let late = cluster(short.as_ref());
    let fading = Process::constructor(&["--bundle", &short]);
    // Certificates count whole seconds, the last one included.
    sleep(Duration::from_millis(5200)).await;
    let error = Client::connect(ClientConfig::new(&address, late)).await;
    let error = error.err().unwrap().to_string();
    assert!(error.contains("our certificate has expired"), "{error}");
    hears(&farm.constructor, "refused: its certificate has expired");
    let told = refused_shader(&fading.address, &["--bundle", &ours]);
    assert!(told.contains("its certificate has expired"), "{told}");
    hears(&fading, "refused: it says that our certificate has expired");

    // The client trusts us, but we do not trust the client.
    let half = write("half.pem", Authority::new().node_trusting(&authority));
    let told = refused_shader(&address, &["--bundle", &half]);
    assert!(
        told.contains("it does not accept our certificate"),
        "{told}"
    );
    hears(&farm.constructor, "refused: it belongs to another cluster");

    // Neither of the two languages, and TLS that breaks off.
    let garbage = |bytes: &[u8]| {
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.write_all(bytes).unwrap();
        let mut answer = Vec::new();
        stream.set_read_timeout(Some(SOON)).unwrap();
        let _ = stream.read_to_end(&mut answer);
        answer
    };
    for _ in 0..5 {
        let answer = garbage(b"GET / HTTP/1.1\r\n\r\n");
        assert!(answer.len() < 10, "{answer:?}");
    }
    hears(
        &farm.constructor,
        "refused: it speaks neither TLS nor lie's protocol",
    );
    garbage(&[0x16, 3, 1, 0, 5, 9, 9, 9, 9, 9]);

    // Another version of the protocol, from somebody who belongs to us.
    let stream = network::dial(&address, &cluster(ours.as_ref()))
        .await
        .unwrap();
    let (mut receiver, mut sender) = connection::split(stream);
    let mut hello = handshake::hello(Role::Client, 0, 0);
    hello.protocol_version = 99;
    let answer: ConstructorToClient = handshake::greet(&mut receiver, &mut sender, hello)
        .await
        .unwrap();
    let ConstructorToClient::Refuse(refusal) = answer else {
        panic!("{answer:?}");
    };
    assert!(
        refusal.reason.as_str().contains("version 99"),
        "{refusal:?}"
    );
    hears(&farm.constructor, "version 99");

    // Each of them once, however often it happened, and nobody has noticed anything.
    for line in [
        "refused: it does not accept our certificate",
        "refused: it does not use TLS",
        "refused: its certificate has expired",
        "refused: it belongs to another cluster",
        "refused: it speaks neither TLS nor lie's protocol",
        "version 99",
    ] {
        assert_eq!(
            count(&farm.constructor, line),
            1,
            "{}",
            farm.constructor.log()
        );
    }
    let after = render(&mut farm.client, 1).await;
    assert!(quiet.film == after.film && after.stats.lost_tiles == 0);
    assert!(farm.constructor.end().success());
}

#[tokio::test]
async fn shaders_ask_clients_as_constructors_do() {
    let home = tempfile::tempdir().unwrap();
    let ours = new_bundle(home.path(), "ours.pem");
    let foreign = new_bundle(home.path(), "foreign.pem");
    let constructor = Process::constructor(&["--bundle", &ours]);
    let shader = shader(&constructor.address, &["--bundle", &ours]);
    for (exposure, told) in [
        (Exposure::Loopback, "it uses TLS"),
        (cluster(foreign.as_ref()), "another cluster"),
    ] {
        let error = match network::dial(&shader.address, &exposure).await {
            Ok(stream) => {
                let (mut receiver, mut sender) = connection::split(stream);
                let hello = handshake::hello(Role::Client, 0, 0);
                let answer =
                    handshake::greet::<ShaderToClient, _, _>(&mut receiver, &mut sender, hello);
                answer.await.unwrap_err().to_string()
            }
            Err(error) => error.to_string(),
        };
        assert!(error.contains(told), "{error}");
    }
    hears(&shader, "refused: it does not use TLS");
    hears(&shader, "refused: it does not accept our certificate");
}

#[test]
fn tls_to_a_process_without_a_bundle_is_told_apart() {
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "bundle.pem");
    let plain = Process::constructor(&[]);
    let told = refused_shader(&plain.address, &["--bundle", &bundle]);
    assert!(told.contains("it does not speak TLS"), "{told}");
    let told = refused_view(&plain.address, &["--bundle", &bundle]);
    assert!(told.contains("it does not speak TLS"), "{told}");
    hears(
        &plain,
        "refused: it uses TLS, and this process has no bundle",
    );
    assert_eq!(count(&plain, "refused"), 1, "{}", plain.log());
}

/// A process that stays when its constructor comes back as another one.
#[test]
fn a_shader_that_was_welcome_goes_on_and_says_once_what_is_wrong() {
    let home = tempfile::tempdir().unwrap();
    let ours = new_bundle(home.path(), "ours.pem");
    let foreign = new_bundle(home.path(), "foreign.pem");
    let mut first = Process::constructor(&["--bundle", &ours]);
    let address = first.address.clone();
    let shader = shader(&address, &["--bundle", &ours]);
    hears(&shader, "the constructor's shader");
    first.kill();
    let mut second = Process::constructor(&["--bundle", &foreign, "--listen", &address]);
    hears(&shader, "another cluster");
    // Time to try again more than once.
    thread::sleep(Duration::from_millis(1000));
    assert_eq!(count(&shader, "another cluster"), 1, "{}", shader.log());
    assert_eq!(count(&second, "refused"), 1, "{}", second.log());
    second.kill();
    let before = count(&shader, "the constructor's shader");
    let third = Process::constructor(&["--bundle", &ours, "--listen", &address]);
    support::wait_until("it is back", || {
        count(&shader, "the constructor's shader") > before
    });
    drop(third);
}

#[tokio::test]
async fn bundles_are_replaced_while_the_farm_works() {
    let home = tempfile::tempdir().unwrap();
    let old = new_bundle(home.path(), "old.pem");
    let new = new_bundle(home.path(), "new.pem");
    let trust = |first: &str, second: &str, name: &str| {
        let path = home.path().join(name);
        let mut trust = support::lie();
        trust
            .args(["key", "trust", first, second, "--out"])
            .arg(&path);
        support::succeeds(&mut trust);
        path.to_str().unwrap().to_owned()
    };
    let old_and_new = trust(&old, &new, "old-and-new.pem");
    let new_and_old = trust(&new, &old, "new-and-old.pem");
    // Each pair meets at some moment of the change.
    for (constructor, others) in [
        (&old, &old_and_new),
        (&old_and_new, &old),
        (&old_and_new, &new_and_old),
        (&new_and_old, &old_and_new),
        (&new_and_old, &new),
        (&new, &new_and_old),
    ] {
        let constructor = Process::constructor(&["--bundle", constructor]);
        let _shader = shader(&constructor.address, &["--bundle", others]);
        let client = connect(&constructor, cluster(others.as_ref())).await;
        let came = tokio::time::timeout(SOON, client.wait_for_shaders(1)).await;
        assert!(came.is_ok(), "{}", constructor.log());
    }
}

/// A listener that is no constructor, whatever it is.
#[test]
fn a_constructor_that_is_none_is_told_apart() {
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "bundle.pem");
    let web = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = web.local_addr().unwrap().to_string();
    let server = thread::spawn(move || {
        for stream in web.incoming().take(2) {
            let mut stream = stream.unwrap();
            let _ = stream.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n");
            let _ = stream.read(&mut [0; 1024]);
        }
    });
    let told = refused_shader(&address, &["--bundle", &bundle]);
    assert!(told.contains("does not speak TLS"), "{told}");
    let told = refused_shader(&address, &[]);
    assert!(told.contains("does not speak lie's protocol"), "{told}");
    server.join().unwrap();
}

#[test]
fn only_tls_1_3_is_spoken() {
    let home = tempfile::tempdir().unwrap();
    let bundle = new_bundle(home.path(), "bundle.pem");
    let constructor = Process::constructor(&["--bundle", &bundle]);
    // A hello of TLS 1.2: no supported_versions, one of its cipher suites.
    let mut body = vec![3, 3];
    body.extend([7; 32]);
    body.extend([0, 0, 2, 0xc0, 0x2b, 1, 0]);
    let mut hello = vec![
        0x16,
        3,
        1,
        0,
        body.len() as u8 + 4,
        1,
        0,
        0,
        body.len() as u8,
    ];
    hello.extend(body);
    let mut stream = TcpStream::connect(&constructor.address).unwrap();
    stream.write_all(&hello).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    // A fatal alert: protocol_version, or handshake_failure.
    assert_eq!(answer[..1], [0x15], "{answer:?}");
    hears(&constructor, "it does not speak TLS 1.3");
}
