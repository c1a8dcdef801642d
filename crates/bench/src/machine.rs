use std::fs;

/// What a measurement ran on, as far as it can be known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The processor's model.
    pub cpu: String,
    /// Cores at hand.
    pub cores: usize,
    /// Operating system and kernel.
    pub os: String,
    /// The compiler of this program.
    pub rustc: String,
    /// The commit that this program was built from, changes that were not committed aside.
    pub commit: Option<String>,
    /// This program's version.
    pub version: String,
}

impl Machine {
    /// This one.
    #[must_use]
    pub fn here() -> Self {
        let commit = env!("LIE_COMMIT");
        Self {
            cpu: cpu().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: operating_system(),
            rustc: env!("LIE_RUSTC").to_owned(),
            commit: (!commit.is_empty()).then(|| commit.to_owned()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// What there is to say, with a name for each.
    pub(crate) fn facts(&self) -> Vec<(&'static str, String)> {
        let optimised = if cfg!(debug_assertions) {
            "with debug assertions: not for comparison"
        } else {
            "release"
        };
        vec![
            ("processor", self.cpu.clone()),
            ("cores", self.cores.to_string()),
            ("system", self.os.clone()),
            ("compiler", self.rustc.clone()),
            ("version", self.version.clone()),
            (
                "commit",
                self.commit.clone().unwrap_or_else(|| "unknown".to_owned()),
            ),
            ("build", optimised.to_owned()),
        ]
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "cpu": self.cpu,
            "cores": self.cores,
            "os": self.os,
            "rustc": self.rustc,
            "commit": self.commit,
            "version": self.version,
        })
    }
}

fn cpu() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    value_of(&text, "model name", ':')
}

fn operating_system() -> String {
    let release = fs::read_to_string("/etc/os-release").ok();
    let name = release.and_then(|text| value_of(&text, "PRETTY_NAME", '='));
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").ok();
    let kernel = kernel.map(|kernel| format!("{} {}", std::env::consts::OS, kernel.trim()));
    match (name, kernel) {
        (Some(name), Some(kernel)) => format!("{name}, {kernel}"),
        (Some(only), None) | (None, Some(only)) => only,
        (None, None) => std::env::consts::OS.to_owned(),
    }
}

/// The value of the first line with this key.
fn value_of(text: &str, key: &str, separator: char) -> Option<String> {
    let pairs = text.lines().filter_map(|line| line.split_once(separator));
    let mut values = pairs.filter(|(name, _)| name.trim() == key);
    let value = values.next()?.1.trim().trim_matches('"');
    (!value.is_empty()).then(|| value.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facts_are_found_and_never_empty() {
        let text = "processor\t: 0\nmodel name\t: A: fast one\nmodel name\t: other\n";
        assert_eq!(
            value_of(text, "model name", ':').as_deref(),
            Some("A: fast one")
        );
        assert_eq!(
            value_of("NAME=\"x\"\nPRETTY_NAME=\"Some 1\"", "PRETTY_NAME", '=').as_deref(),
            Some("Some 1")
        );
        assert_eq!(value_of("PRETTY_NAME=\"\"", "PRETTY_NAME", '='), None);
        let here = Machine::here();
        assert!(here.cores > 0 && here.rustc.contains("rustc"), "{here:?}");
        assert!(here.facts().iter().all(|(_, value)| !value.is_empty()));
    }
}
