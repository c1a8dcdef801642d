//! What processes hand out to Prometheus, and to others who ask for it.

use std::{
    collections::BTreeMap,
    io::Write,
    net::TcpStream,
    time::{Duration, Instant},
};

use crate::{
    scrape::{GET, exchange, metrics_address, scrape},
    support::{self, LONG, Process, wait_until},
    view, wait_for_shaders,
};

fn shader_with_metrics(constructor: &Process) -> Process {
    Process::start(&[
        "shader",
        "--constructor",
        &constructor.address,
        "--threads",
        "1",
        "--no-cache",
        "--audit",
        "1",
        "--metrics",
        "0",
    ])
}

#[test]
fn metrics_are_prometheus_and_rise() {
    let constructor = Process::constructor(&["--metrics", "127.0.0.1:0"]);
    let shader = shader_with_metrics(&constructor);
    wait_for_shaders(&constructor, 1);
    let (top, tiles) = (metrics_address(&constructor), metrics_address(&shader));
    assert!(tiles.starts_with("127.0.0.1:"), "{tiles}");
    let before = scrape(&tiles);
    assert_eq!(before["lie_tiles_total"], 0.0);
    assert_eq!(before["lie_constructor_connected"], 1.0);
    support::succeeds(view(&constructor, "3", "1").arg("--settle"));
    let between = scrape(&tiles);
    support::succeeds(view(&constructor, "3", "1").arg("--settle"));
    let after = scrape(&tiles);
    for series in [
        "lie_tiles_total",
        "lie_render_seconds_total",
        "lie_rays_total{kind=\"camera\"}",
        "lie_light_evaluations_total",
        "lie_audit_rays_total",
        "lie_tile_stage_seconds_count{stage=\"visibility\"}",
        "lie_tile_stage_seconds_sum{stage=\"visibility\"}",
        "lie_tile_stage_seconds_bucket{stage=\"pack\",le=\"+Inf\"}",
        "lie_sent_bytes_total{peer=\"client\"}",
    ] {
        let values = [&before, &between, &after].map(|samples| samples[series]);
        assert!(values.is_sorted_by(|a, b| a < b), "{series}: {values:?}");
    }
    // What has converged is not sent again.
    let from_constructor = "lie_received_bytes_total{peer=\"constructor\"}";
    assert!(after[from_constructor] > before[from_constructor]);
    let stage = |name: &str| after[&format!("lie_tile_stage_seconds_count{{stage=\"{name}\"}}")];
    for name in ["queued", "unoccluded", "partial", "traced", "pack"] {
        assert_eq!(stage(name), after["lie_tiles_total"], "{name}");
    }
    // Nothing but what is of the moment has fallen.
    for (series, value) in &between {
        let name = series.split('{').next().unwrap();
        let is_counter = ["_total", "_bucket", "_sum", "_count"];
        if is_counter.iter().any(|ending| name.ends_with(ending)) {
            assert!(after[series] >= *value, "{series}");
        }
    }

    let mut samples = BTreeMap::new();
    wait_until("the shader is ready", || {
        samples = scrape(&top);
        samples["lie_shaders{health=\"ready\"}"] == 1.0
    });
    assert!(samples["lie_lies_cells"] > 0.0 && samples["lie_lies_version"] > 0.0);
    assert!(samples["lie_sent_bytes_total{peer=\"shader\"}"] > 1000.0);
    let ready = samples
        .iter()
        .find(|(series, _)| series.starts_with("lie_shader_ready{"));
    let (series, value) = ready.unwrap();
    assert!(series.contains(&shader.address) && *value == 1.0);

    // Whoever is refused is counted by the reason.
    exchange(&constructor.address, b"GET / HTTP/1.1\r\n\r\n");
    wait_until("the refusal is counted", || {
        scrape(&top)["lie_connections_refused_total{reason=\"garbage\"}"] == 1.0
    });
}

#[test]
fn bad_requests_for_metrics_hurt_nothing() {
    let constructor = Process::constructor(&["--metrics", "0"]);
    let shader = shader_with_metrics(&constructor);
    wait_for_shaders(&constructor, 1);
    let addresses = [metrics_address(&constructor), metrics_address(&shader)];
    for address in &addresses {
        for (request, status) in [
            (&b"\x16\x03\x01\x02\0\n\n"[..], "400"),
            (b"LIE\x1a\x06\0\n\n", "400"),
            (b"GET /metrics SPDY\r\n\r\n", "400"),
            (
                b"POST /metrics HTTP/1.1\r\nContent-Length: 4\r\n\r\nabcd",
                "405",
            ),
            (b"GET /etc/passwd HTTP/1.1\r\n\r\n", "404"),
        ] {
            let answer = exchange(address, request);
            assert!(
                answer.starts_with(&format!("HTTP/1.1 {status} ")),
                "{answer}"
            );
        }
        let endless = [&GET[..GET.len() - 2], &[b'a'; 100_000]].concat();
        let answer = exchange(address, &endless);
        assert!(
            answer.is_empty() || answer.starts_with("HTTP/1.1 431 "),
            "{answer}"
        );
    }
    // Many that say nothing, or their word byte by byte, keep nobody out.
    let mut held: Vec<TcpStream> = Vec::new();
    for address in &addresses {
        held.extend((0..300).map(|_| TcpStream::connect(address).unwrap()));
    }
    let slow = Instant::now();
    let mut trickle = TcpStream::connect(&addresses[1]).unwrap();
    for address in &addresses {
        let samples = scrape(address);
        let mut names = samples.keys();
        assert!(names.any(|series| series.starts_with("lie_build_info{")));
    }
    support::succeeds(&mut view(&constructor, "2", "1"));
    while slow.elapsed() < LONG && trickle.write_all(b"G").is_ok() {
        std::thread::sleep(Duration::from_millis(200));
    }
    assert!(slow.elapsed() < LONG, "a slow request is never ended");
    drop(held);
    support::succeeds(&mut view(&constructor, "2", "1"));
    assert!(constructor.end().success());
}

#[test]
fn metrics_are_where_they_were_asked_for_or_the_process_ends() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    for (metrics, code, piece) in [
        ("nonsense", 2, "expected PORT or HOST:PORT"),
        (":9464", 2, "expected PORT or HOST:PORT"),
        (address.as_str(), 1, "cannot listen on"),
    ] {
        let mut shader = support::lie();
        shader.args([
            "shader",
            "--constructor",
            "127.0.0.1:9",
            "--metrics",
            metrics,
        ]);
        let message = support::failure(&mut shader, code);
        assert!(message.contains(piece), "{message}");
    }
    // A process that was not asked opens no port for them.
    let constructor = Process::constructor(&[]);
    assert!(!constructor.log().contains("metrics"));
}
