use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lie_bench::{Machine, Report, Section};
use serde_json::Value;

use crate::args;

/// What is written beside the table on the screen.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct Output {
    /// Write the rows to this file as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a report to this folder: Markdown with plots and pictures.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

impl Output {
    /// What can be checked and made before minutes of work.
    pub(crate) fn prepare(&self) -> anyhow::Result<()> {
        prepare(self.json.as_deref(), self.report.as_deref())
    }

    /// Writes these parts and what they were measured on.
    pub(crate) fn write_json(&self, parts: &[(&str, Value)]) -> anyhow::Result<()> {
        match &self.json {
            Some(path) => args::write_json(path, &envelope(parts)),
            None => Ok(()),
        }
    }

    /// Writes a report of this name.
    pub(crate) fn write_report(
        &self,
        name: &str,
        title: &str,
        sections: impl FnOnce() -> anyhow::Result<Vec<Section>>,
    ) -> anyhow::Result<()> {
        match &self.report {
            Some(folder) => write_report(&report_path(folder, name), title, sections()?),
            None => Ok(()),
        }
    }

    /// Says that the report of this name is there, if it is.
    pub(crate) fn announce(&self, name: &str) -> anyhow::Result<()> {
        match &self.report {
            Some(folder) => announce(&report_path(folder, name)),
            None => Ok(()),
        }
    }
}

fn report_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("md")
}

/// Makes the report's folder; the JSON's must be there.
pub(crate) fn prepare(json: Option<&Path>, report: Option<&Path>) -> anyhow::Result<()> {
    let folder = json
        .and_then(Path::parent)
        .filter(|folder| !folder.as_os_str().is_empty());
    if let (Some(json), Some(folder)) = (json, folder.filter(|folder| !folder.is_dir())) {
        anyhow::bail!(
            "{}: there is no folder {}",
            json.display(),
            folder.display()
        );
    }
    match report.filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display())),
        None => Ok(()),
    }
}

/// Parts of a measurement as one JSON object, with machine and command line.
pub(crate) fn envelope(parts: &[(&str, Value)]) -> Value {
    let mut object: serde_json::Map<String, Value> = parts
        .iter()
        .map(|(key, value)| ((*key).to_owned(), value.clone()))
        .collect();
    object.insert("machine".to_owned(), Machine::here().json());
    object.insert("command".to_owned(), command_line().into());
    Value::Object(object)
}

pub(crate) fn write_report(path: &Path, title: &str, sections: Vec<Section>) -> anyhow::Result<()> {
    rewrite_report(path, title, sections, &[])
}

/// Writes a report, but leaves in it what other commands wrote under these headings.
pub(crate) fn rewrite_report(
    path: &Path,
    title: &str,
    sections: Vec<Section>,
    keep: &[&str],
) -> anyhow::Result<()> {
    let report = Report {
        title: title.to_owned(),
        command_line: command_line(),
        machine: Machine::here(),
        sections,
    };
    report.rewrite(path, keep)?;
    Ok(())
}

/// Puts a section into a report that another command wrote, with what it was measured by and on.
pub(crate) fn put_into_report(path: &Path, mut section: Section) -> anyhow::Result<()> {
    let machine = Machine::here();
    let measured = format!(
        "Measured by `{}`, on {} with {} cores, commit {}.",
        command_line(),
        machine.cpu,
        machine.cores,
        machine.commit.as_deref().unwrap_or("unknown")
    );
    section.paragraphs.insert(0, measured);
    section.put_into(path)?;
    Ok(())
}

/// Says that a report is there.
pub(crate) fn announce(path: &Path) -> anyhow::Result<()> {
    args::say(format_args!("{}: written", path.display()))
}

/// What was typed, wherever the program lies.
fn command_line() -> String {
    let quoted = |argument: String| {
        if argument.is_empty() || argument.contains(char::is_whitespace) {
            format!("'{argument}'")
        } else {
            argument
        }
    };
    let arguments = std::env::args_os().skip(1);
    let arguments = arguments.map(|argument| quoted(argument.to_string_lossy().into_owned()));
    let words: Vec<String> = std::iter::once("lie".to_owned()).chain(arguments).collect();
    words.join(" ")
}

/// A bar on standard error; nothing where that is not a terminal.
pub(crate) fn progress_bar() -> ProgressBar {
    let template = "{msg} [{wide_bar}] {percent:>3} %";
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(LENGTH).with_style(style.progress_chars("=> "))
}

/// Shows on a bar what is being done.
pub(crate) fn teller(bar: &ProgressBar) -> impl Fn(&str, f32) + Sync {
    |what, share| {
        if bar.message() != what {
            bar.set_message(what.to_owned());
        }
        bar.set_position((LENGTH as f32 * share) as u64);
    }
}

/// Steps of a bar.
const LENGTH: u64 = 1000;
