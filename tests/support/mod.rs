//! Processes of the real binary, as tests need them.

#![allow(dead_code, reason = "each test file uses its part")]

pub(crate) mod bench;
pub(crate) mod bundles;
pub(crate) mod patience;
pub(crate) mod proc;
pub(crate) mod secured;

use std::{
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, Output, Stdio},
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};

/// Long enough for anything that works at all.
pub(crate) const LONG: Duration = Duration::from_secs(60);

/// Where the binary is.
pub(crate) const BINARY: &str = env!("CARGO_BIN_EXE_lie");

/// The binary.
pub(crate) fn lie() -> Command {
    unconfigured(Command::new(BINARY))
}

/// A command whose processes of ours take nothing from this environment.
pub(crate) fn unconfigured(mut command: Command) -> Command {
    for variable in [
        "LIE_LOG",
        "LIE_LOG_FORMAT",
        "LIE_LISTEN",
        "LIE_CONSTRUCTOR",
        "LIE_METRICS",
        "LIE_BUNDLE",
        "LIE_INSECURE",
    ] {
        command.env_remove(variable);
    }
    command
}

/// A small scene of this repository.
pub(crate) fn cornell() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell")
}

/// A constructor or shader; killed when dropped.
pub(crate) struct Process {
    child: Child,
    pub(crate) address: String,
    log: Arc<Mutex<String>>,
    /// Held open, or the process would fail when it prints.
    _stdout: BufReader<ChildStdout>,
}

impl Process {
    /// Starts a process and waits for its announcement.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::start_with(arguments, &["--log", "info"])
    }

    /// The same with a log of another kind.
    pub(crate) fn start_with(arguments: &[&str], logging: &[&str]) -> Self {
        let mut command = lie();
        command.args(arguments).args(logging);
        Self::spawn(command)
    }

    /// The same of a command that is ready but for its supervision.
    pub(crate) fn spawn(mut command: Command) -> Self {
        let mut child = command
            .arg("--supervised")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        let log = Arc::new(Mutex::new(String::new()));
        let (kept, stderr) = (log.clone(), child.stderr.take().expect("a pipe"));
        thread::spawn(move || {
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                let mut kept = kept.lock().expect("nobody panics with it");
                kept.push_str(&line);
                kept.push('\n');
            }
        });
        let mut stdout = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut line = String::new();
        stdout.read_line(&mut line).expect("a line");
        let address = line.trim().strip_prefix("listening ");
        let address = address.unwrap_or_else(|| panic!("{command:?} said {line:?}"));
        Self {
            address: address.to_owned(),
            child,
            log,
            _stdout: stdout,
        }
    }

    pub(crate) fn constructor(more: &[&str]) -> Self {
        let scene = cornell();
        let scene = scene.to_str().expect("a path in UTF-8");
        let mut arguments = vec!["constructor", scene, "--threads", "1"];
        if !more.contains(&"--listen") {
            arguments.extend(["--listen", "127.0.0.1:0"]);
        }
        arguments.extend(more);
        Self::start(&arguments)
    }

    pub(crate) fn shader(constructor: &str) -> Self {
        let arguments = ["shader", "--constructor", constructor];
        Self::start(&[&arguments[..], &["--threads", "1", "--no-cache"]].concat())
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    pub(crate) fn log(&self) -> String {
        self.log.lock().expect("nobody panics with it").clone()
    }

    /// `kill -9`.
    pub(crate) fn kill(&mut self) {
        self.child.kill().expect("it still runs");
        self.child.wait().expect("it ends");
    }

    /// Hangs it.
    pub(crate) fn stop(&self) {
        signal("-STOP", self.id());
    }

    /// Lets it go on.
    pub(crate) fn resume(&self) {
        signal("-CONT", self.id());
    }

    /// The process itself.
    pub(crate) fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Ends it in order, by closing its input; says how it ended.
    pub(crate) fn end(mut self) -> std::process::ExitStatus {
        drop(self.child.stdin.take());
        self.child.wait().expect("it ends")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Sends a signal by its name.
pub(crate) fn signal(name: &str, id: u32) {
    let sent = Command::new("kill").args([name, &id.to_string()]).status();
    assert!(sent.expect("kill starts").success());
}

/// Processes whose parent is `id`.
pub(crate) fn children_of(id: u32) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").expect("a Linux system");
    let ids = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    ids.filter(|&child| parent_of(child) == Some(id)).collect()
}

fn parent_of(id: u32) -> Option<u32> {
    let mut stat = String::new();
    let mut file = std::fs::File::open(format!("/proc/{id}/stat")).ok()?;
    file.read_to_string(&mut stat).ok()?;
    // The name, in parentheses, may hold anything; state and parent follow it.
    let mut fields = stat.rsplit(')').next()?.split_whitespace();
    let state = fields.next()?;
    let parent = fields.next()?.parse().ok()?;
    (state != "Z").then_some(parent)
}

/// Whether a process runs.
pub(crate) fn runs(id: u32) -> bool {
    parent_of(id).is_some()
}

/// Waits until something holds.
pub(crate) fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < LONG, "{what} did not come true");
        thread::sleep(Duration::from_millis(20));
    }
}

/// Standard error of a command that must end with this code.
pub(crate) fn failure(command: &mut Command, code: i32) -> String {
    let Output { status, stderr, .. } = command.output().expect("it starts");
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    assert_eq!(status.code(), Some(code), "{stderr}");
    stderr
}

/// Runs a command to its end, which must be a success.
pub(crate) fn succeeds(command: &mut std::process::Command) {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?} failed: {errors}");
}
