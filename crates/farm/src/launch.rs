//! A constructor and its shaders as children of this process, on this machine.
//!
//! Each child runs with `--supervised` and its standard input held open by us: when we end,
//! even by `kill -9`, the input closes and the child ends too. By the same input it is given its
//! bundle, which so is in no file, argument or environment. A child announces where it
//! listens by a line `listening ADDR`, the only thing it ever prints; its log is passed on
//! line by line.

use std::{
    ffi::OsString,
    path::PathBuf,
    process::{ExitStatus, Stdio},
    sync::Arc,
    time::Duration,
};

use tokio::{
    io::{AsyncBufReadExt, AsyncRead, AsyncWriteExt, BufReader, Lines},
    process::{Child, ChildStdout, Command},
    sync::watch,
    task::JoinSet,
    time::timeout,
};
use tokio_util::sync::CancellationToken;

/// How long a child may take to end by itself, if it has nothing to save.
pub const GRACE: Duration = Duration::from_millis(900);

/// What a child prints before the address at which it listens.
pub const ANNOUNCEMENT: &str = "listening ";

/// Takes a child's name and a line of its log.
pub type LogLine = Arc<dyn Fn(&str, &str) + Send + Sync>;

/// What to start.
#[derive(Clone)]
pub struct LaunchConfig {
    /// The `lie` executable.
    pub program: PathBuf,
    /// The constructor.
    pub constructor: ConstructorSource,
    /// Arguments of every shader, beginning with `shader`; the constructor's address is added.
    pub shader: Vec<OsString>,
    /// How many shaders.
    pub shaders: usize,
    /// What every child gets as its bundle; without one, they use plain connections.
    pub bundle: Option<String>,
    /// How long the constructor may take to end by itself.
    pub constructor_grace: Duration,
    /// Where the children's logs go.
    pub log: LogLine,
}

/// Where a farm's constructor comes from.
#[derive(Clone, Debug)]
pub enum ConstructorSource {
    /// It is started, with these arguments, beginning with `constructor`.
    Started(Vec<OsString>),
    /// It listens at this address already, as `host:port`, and is somebody else's to end.
    Found(String),
}

/// Why the processes are not there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LaunchError {
    /// A child cannot be started.
    #[error("cannot start the {who} ({}): {cause}", program.display())]
    Start {
        /// Which child.
        who: String,
        /// What was to be run.
        program: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A child ended before it was ready; its log says why.
    #[error("the {who} ended before it was ready ({status})")]
    Ended {
        /// Which child.
        who: String,
        /// How it ended.
        status: ExitStatus,
    },
    /// A child said something else than where it listens.
    #[error("the {who} did not say where it listens")]
    Announcement {
        /// Which child.
        who: String,
    },
}

/// The running children. Ended and reaped by [`Self::shutdown`]; killed if just dropped.
pub struct Farm {
    address: String,
    constructor: Children,
    shaders: Children,
}

/// Children that end together.
struct Children {
    /// How long each may take to end by itself.
    grace: Duration,
    stop: CancellationToken,
    watches: JoinSet<()>,
    ids: Vec<u32>,
    addresses: Vec<String>,
    /// How many have come so far and not ended by themselves.
    living: watch::Sender<usize>,
}

impl Farm {
    /// Starts the constructor, if there is none, waits until it listens, and starts the
    /// shaders, which may come when they can.
    ///
    /// # Errors
    /// [`LaunchError`]; nothing is left running then.
    pub async fn start(config: LaunchConfig) -> Result<Self, LaunchError> {
        let mut farm = Self {
            address: String::new(),
            constructor: Children::new(config.constructor_grace),
            shaders: Children::new(GRACE),
        };
        match farm.start_all(&config).await {
            Ok(()) => Ok(farm),
            Err(error) => {
                farm.shutdown().await;
                Err(error)
            }
        }
    }

    /// Where the constructor listens.
    #[must_use]
    pub fn address(&self) -> &str {
        &self.address
    }

    /// The process of the constructor, if it was started here.
    #[must_use]
    pub fn constructor_ids(&self) -> &[u32] {
        &self.constructor.ids
    }

    /// The shaders' processes, those that have ended among them.
    #[must_use]
    pub fn shader_ids(&self) -> &[u32] {
        &self.shaders.ids
    }

    /// Where the shaders listen, in the order of their start.
    #[must_use]
    pub fn shader_addresses(&self) -> &[String] {
        &self.shaders.addresses
    }

    /// How many shaders have not ended, and when that changes.
    #[must_use]
    pub fn living_shaders(&self) -> watch::Receiver<usize> {
        self.shaders.living.subscribe()
    }

    /// Ends all children and waits for them. The shaders go first, so that none misses the
    /// constructor.
    pub async fn shutdown(self) {
        self.shaders.end().await;
        self.constructor.end().await;
    }

    async fn start_all(&mut self, config: &LaunchConfig) -> Result<(), LaunchError> {
        self.address = match &config.constructor {
            ConstructorSource::Found(address) => address.clone(),
            ConstructorSource::Started(arguments) => {
                let children = &mut self.constructor;
                children.start("constructor", config, arguments).await?
            }
        };
        let mut arguments = config.shader.clone();
        arguments.extend(["--constructor".into(), self.address.clone().into()]);
        for number in 1..=config.shaders {
            let who = format!("shader {number}");
            self.shaders.start(&who, config, &arguments).await?;
        }
        Ok(())
    }
}

impl Children {
    fn new(grace: Duration) -> Self {
        Self {
            grace,
            stop: CancellationToken::new(),
            watches: JoinSet::new(),
            ids: vec![],
            addresses: vec![],
            living: watch::Sender::default(),
        }
    }

    /// Asks all to end, and waits until they have.
    async fn end(mut self) {
        self.stop.cancel();
        while self.watches.join_next().await.is_some() {}
    }

    /// Starts a child and waits for its announcement; then it is watched.
    async fn start(
        &mut self,
        who: &str,
        config: &LaunchConfig,
        arguments: &[OsString],
    ) -> Result<String, LaunchError> {
        let started = spawn(config, arguments).await;
        let mut child = started.map_err(|cause| LaunchError::Start {
            who: who.to_owned(),
            program: config.program.clone(),
            cause,
        })?;
        if let Some(stderr) = child.stderr.take() {
            let (who, log) = (who.to_owned(), config.log.clone());
            tokio::spawn(pass_on(who, BufReader::new(stderr).lines(), log));
        }
        self.ids.extend(child.id());
        let said = first_line(child.stdout.take()).await;
        let Some(line) = said else {
            let status = child.wait().await;
            return Err(match status {
                Ok(status) => LaunchError::Ended {
                    who: who.to_owned(),
                    status,
                },
                Err(_) => LaunchError::Announcement {
                    who: who.to_owned(),
                },
            });
        };
        let address = line.strip_prefix(ANNOUNCEMENT).map(str::to_owned);
        self.living.send_modify(|living| *living += 1);
        let (stop, living) = (self.stop.clone(), self.living.clone());
        let (who_is_it, grace) = (who.to_owned(), self.grace);
        self.watches.spawn(async move {
            see_to_its_end(who_is_it, child, stop, grace).await;
            living.send_modify(|living| *living -= 1);
        });
        self.addresses.extend(address.clone());
        address.ok_or_else(|| LaunchError::Announcement {
            who: who.to_owned(),
        })
    }
}

async fn spawn(config: &LaunchConfig, arguments: &[OsString]) -> std::io::Result<Child> {
    let mut command = Command::new(&config.program);
    command
        .args(arguments)
        .arg("--supervised")
        // These are for us; the children get what we decide.
        .env_remove("LIE_BUNDLE")
        .env_remove("LIE_INSECURE")
        .env_remove("LIE_METRICS")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .kill_on_drop(true);
    // An interrupt from the terminal is for us; we end the children in order.
    #[cfg(unix)]
    command.process_group(0);
    let Some(bundle) = &config.bundle else {
        return command.spawn();
    };
    let mut child = command.args(["--bundle", "-"]).spawn()?;
    if let Some(input) = &mut child.stdin {
        match input.write_all(bundle.as_bytes()).await {
            // It has ended already: its log and its status say why.
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => return Err(error),
            _ => {}
        }
    }
    Ok(child)
}

async fn first_line(stdout: Option<ChildStdout>) -> Option<String> {
    let mut lines = BufReader::new(stdout?).lines();
    lines.next_line().await.ok().flatten()
}

async fn pass_on<R: AsyncRead + Unpin>(who: String, mut lines: Lines<BufReader<R>>, log: LogLine) {
    while let Ok(Some(line)) = lines.next_line().await {
        log(&who, &line);
    }
}

/// Waits for a child's end: its own, which is worth a word, or the one that we ask for.
async fn see_to_its_end(who: String, mut child: Child, stop: CancellationToken, grace: Duration) {
    // Waiting for a child would close the input that it still has.
    let input = child.stdin.take();
    let status = tokio::select! {
        status = child.wait() => status,
        () = stop.cancelled() => {
            // The closed input is the request.
            drop(input);
            if timeout(grace, child.wait()).await.is_err()
                && let Err(error) = child.kill().await
            {
                tracing::warn!("the {who} cannot be ended: {error}");
            }
            return;
        }
    };
    match status {
        Ok(status) => tracing::warn!("the {who} has ended ({status})"),
        Err(error) => tracing::warn!("the {who} is lost: {error}"),
    }
}
