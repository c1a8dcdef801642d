//! Logs go to standard error; standard output is for results.

use std::io::{IsTerminal, Write};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use tracing_subscriber::EnvFilter;

use crate::failure::{self, OrUsage};

/// What is logged, and how.
#[derive(Args, Clone, Debug)]
pub(crate) struct Logging {
    /// What to log to standard error: error, warn, info, debug, trace, or a filter such as
    /// `warn,lie_farm=debug`.
    #[arg(
        long,
        global = true,
        default_value = "warn",
        env = "LIE_LOG",
        value_name = "FILTER"
    )]
    pub(crate) log: String,
    /// How to log: for people, or one JSON object on each line.
    #[arg(
        long,
        global = true,
        value_enum,
        default_value = "text",
        env = "LIE_LOG_FORMAT",
        value_name = "FORMAT"
    )]
    pub(crate) log_format: LogFormat,
}

/// How a line of the log is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    /// For people.
    Text,
    /// For machines.
    Json,
}

impl LogFormat {
    /// Its name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Json => "json",
        }
    }

    /// A line of another process's log as one of ours, which says whose it is.
    pub(crate) fn passed_on(self, who: &str, line: &str) -> String {
        if self == Self::Text {
            return format!("{who:>11} | {line}");
        }
        let mut value = match serde_json::from_str(line) {
            Ok(Value::Object(fields)) => fields,
            // A panic, or what a library prints by itself.
            _ => serde_json::Map::from_iter([
                ("level".to_owned(), json!("ERROR")),
                ("message".to_owned(), json!(line)),
            ]),
        };
        value.insert("process".to_owned(), json!(who));
        Value::Object(value).to_string()
    }
}

/// Starts logging.
pub(crate) fn start(logging: &Logging) -> anyhow::Result<()> {
    let filter = EnvFilter::try_new(&logging.log).or_usage()?;
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr);
    match logging.log_format {
        LogFormat::Text => log
            .with_ansi(std::io::stderr().is_terminal())
            .with_target(false)
            .compact()
            .init(),
        LogFormat::Json => log.json().flatten_event(true).with_span_list(false).init(),
    }
    Ok(())
}

/// Says why a command failed: the last line, whatever is logged.
pub(crate) fn fail(error: &anyhow::Error, format: LogFormat) {
    if format == LogFormat::Json && tracing::enabled!(tracing::Level::ERROR) {
        tracing::error!(exit_code = failure::exit_code(error), "{error:#}");
    } else {
        // Nothing is left to do if standard error is closed.
        let _ = writeln!(std::io::stderr(), "error: {error:#}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_passed_on_says_whose_it_is() {
        let text = LogFormat::Text.passed_on("shader 1", "WARN it is late");
        assert_eq!(text, "   shader 1 | WARN it is late");
        for (line, message) in [
            (
                r#"{"level":"WARN","message":"it is \"late\""}"#,
                "it is \"late\"",
            ),
            ("thread panicked", "thread panicked"),
            ("[1]", "[1]"),
        ] {
            let line = LogFormat::Json.passed_on("shader 1", line);
            let value: Value = serde_json::from_str(&line).unwrap();
            assert_eq!(value["message"], message);
            assert_eq!(value["process"], "shader 1");
            assert!(!line.contains('\n'));
        }
    }
}
