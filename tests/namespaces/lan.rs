//! Several hosts on one machine: each a network namespace, with a cable (a veth pair) to a switch
//! (a bridge in a namespace of its own), so that nothing of the machine's own network changes.

use std::{
    io::Write,
    path::Path,
    process::{Command, id},
    sync::atomic::{AtomicU32, Ordering},
};

use crate::support::{BINARY, unconfigured};

/// Of all our namespaces; the process that made one follows.
const PREFIX: &str = "lie-test";

/// A network; gone when it is dropped.
pub(crate) struct Lan {
    switch: String,
    hosts: Vec<String>,
}

impl Lan {
    /// So many hosts, or why this machine does not let us have them.
    pub(crate) fn new(hosts: usize) -> Result<Self, String> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        clear_away();
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = |host: &str| format!("{PREFIX}-{}-{number}-{host}", id());
        let mut lan = Self {
            switch: name("switch"),
            hosts: vec![],
        };
        ip(&format!("netns add {}", lan.switch))?;
        lan.ip_of_switch("link add br0 type bridge mcast_snooping 0")?;
        lan.ip_of_switch("link set br0 up")?;
        for host in 0..hosts {
            let namespace = name(&host.to_string());
            ip(&format!("netns add {namespace}"))?;
            lan.hosts.push(namespace);
            lan.wire(host)?;
        }
        Ok(lan)
    }

    fn wire(&self, host: usize) -> Result<(), String> {
        let (switch, namespace) = (&self.switch, &self.hosts[host]);
        let at_switch = format!("type veth peer name port{host} netns {switch}");
        ip(&format!("link add eth0 netns {namespace} {at_switch}"))?;
        self.ip_of_switch(&format!("link set port{host} master br0 up"))?;
        let address = self.address(host);
        for command in [
            "link set lo up",
            &format!("address add {address}/24 dev eth0"),
            "link set eth0 up",
        ] {
            ip(&format!("-n {namespace} {command}"))?;
        }
        Ok(())
    }

    /// A host's address, which no other machine has to know.
    pub(crate) fn address(&self, host: usize) -> String {
        format!("10.77.0.{}", host + 1)
    }

    /// The binary, to be started on a host.
    pub(crate) fn lie(&self, host: usize) -> Command {
        let mut command = unconfigured(Command::new("ip"));
        command.args(["netns", "exec", &self.hosts[host], BINARY]);
        command
    }

    /// Pulls out a host's cable: whatever is sent is lost, and nobody is told.
    pub(crate) fn cut(&self, host: usize) {
        self.ip_of_switch(&format!("link set port{host} down"))
            .expect("the cable is there");
    }

    /// Puts it in again.
    pub(crate) fn mend(&self, host: usize) {
        self.ip_of_switch(&format!("link set port{host} up"))
            .expect("the cable is there");
    }

    /// Lets all that goes to and from a host pass through a queue of this kind, such as `tbf rate 5mbit burst 32kb latency
    /// 400ms`; or says why the kernel does not.
    pub(crate) fn shape(&self, host: usize, queue: &str) -> Result<(), String> {
        let (switch, namespace) = (&self.switch, &self.hosts[host]);
        let add = format!("root {queue}");
        tc(&format!("-n {namespace} qdisc add dev eth0 {add}"))?;
        tc(&format!("-n {switch} qdisc add dev port{host} {add}"))
    }

    /// As without [`Self::shape`].
    pub(crate) fn unshape(&self, host: usize) {
        let (switch, namespace) = (&self.switch, &self.hosts[host]);
        for device in [
            format!("{namespace} qdisc del dev eth0"),
            format!("{switch} qdisc del dev port{host}"),
        ] {
            tc(&format!("-n {device} root")).expect("it was there");
        }
    }

    fn ip_of_switch(&self, command: &str) -> Result<(), String> {
        ip(&format!("-n {} {command}", self.switch))
    }
}

impl Drop for Lan {
    fn drop(&mut self) {
        for namespace in self.hosts.iter().chain([&self.switch]) {
            // One that could not be made is not there; the next run clears away what is left.
            let _ = ip(&format!("netns del {namespace}"));
        }
    }
}

/// Removes what processes have left behind that were killed.
fn clear_away() {
    let listed = Command::new("ip").args(["netns", "list"]).output();
    let listed = listed.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    for line in listed.unwrap_or_default().lines() {
        let Some(namespace) = line.split_whitespace().next() else {
            continue;
        };
        let maker = namespace
            .strip_prefix(PREFIX)
            .and_then(|rest| rest.split('-').nth(1));
        if maker.is_some_and(|id| !Path::new("/proc").join(id).exists()) {
            let _ = ip(&format!("netns del {namespace}"));
        }
    }
}

fn ip(arguments: &str) -> Result<(), String> {
    run("ip", arguments)
}

fn tc(arguments: &str) -> Result<(), String> {
    run("tc", arguments)
}

fn run(program: &str, arguments: &str) -> Result<(), String> {
    let output = Command::new(program)
        .args(arguments.split_whitespace())
        .output();
    let output = output.map_err(|error| format!("{program} (iproute2): {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let why = String::from_utf8_lossy(&output.stderr);
    Err(format!("`{program} {arguments}`: {}", why.trim()))
}

/// Says what is not tested, past what catches a test's output.
pub(crate) fn skip(what: &str, why: &str) {
    let line = format!("\n!!\n!! SKIPPED: {what}: {why}\n!!\n");
    let written = std::io::stderr().write_all(line.as_bytes());
    written.expect("standard error is open");
}
