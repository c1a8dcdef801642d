use std::{path::PathBuf, time::Instant};

use clap::{Args, ValueEnum};
use glam::UVec2;
use lie_bench::{
    FramesConfig,
    growth::{self, Step},
};

use super::{
    Learning,
    output::{self, Output, progress_bar},
    race,
    threads::thread_counts,
};
use crate::{
    args::{self, Accel, say},
    failure::OrUsage,
};

/// Time of a frame over the number of lights, and over that of triangles, by the standard and with
/// LIEs.
///
/// Scenes are made for it: closed rooms with ten lights in each, of which a point sees its own
/// room's however many there are; and the mosque, carved more and more finely. Sixteen
/// million triangles take 3.5 GB of memory, and 6.5 GB while their hierarchy is built.
#[derive(Args)]
pub(crate) struct Growth {
    /// What grows, in turn.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "lights,triangles",
        value_name = "WHAT,WHAT"
    )]
    axes: Vec<Axis>,
    /// Numbers of lights, each about; k and M are thousands and millions.
    #[arg(
        long,
        value_delimiter = ',',
        value_parser = count,
        default_value = "100,1000,10000",
        value_name = "N,N,…"
    )]
    lights: Vec<u64>,
    /// Numbers of triangles, each about.
    #[arg(
        long,
        value_delimiter = ',',
        value_parser = count,
        default_value = "1M,4M,16M",
        value_name = "N,N,…"
    )]
    triangles: Vec<u64>,
    /// Size of the pictures in pixels.
    #[arg(long, default_value = "256x256", value_parser = args::size, value_name = "WxH")]
    size: UVec2,
    /// What finds hits in the scenes.
    #[arg(long, value_enum, default_value = "bvh")]
    accel: Accel,
    /// Frames of each integrator, in turn; times are medians.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    /// Numbers of threads, one measurement for each; 0 is one for each core.
    #[arg(long, value_delimiter = ',', default_value = "0", value_name = "N,N,…")]
    threads: Vec<usize>,
    #[command(flatten)]
    learning: Learning,
    /// Put table and plots into this report, in the place of those that are there:
    /// docs/results.md, say. `lie bench report` leaves them there.
    #[arg(long, value_name = "FILE.md")]
    into: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// What grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Axis {
    /// Lights, as the rooms do that they are in.
    Lights,
    /// Triangles of one building.
    Triangles,
}

impl Growth {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        output::prepare(None, self.into.as_ref().and_then(|path| path.parent()))?;
        let steps = self.steps();
        for &(axis, count) in &steps {
            Step::check(axis, count).or_usage()?;
        }
        let config = FramesConfig {
            threads: thread_counts(&self.threads)?,
            repeat: self.repeat,
        };
        let mut rows = vec![];
        for (index, &(axis, count)) in steps.iter().enumerate() {
            let clock = Instant::now();
            let bar = progress_bar();
            bar.set_message(format!("{count} {}: make the scene", axis.name()));
            bar.tick();
            let step = Step::make(axis, count, self.size, self.accel.into()).or_usage()?;
            bar.finish_and_clear();
            let lineup = self.learning.construct(step.stage(), growth::CONTENDERS)?;
            let frames = race(step.stage(), &lineup, &config)?;
            rows.extend(step.rows(frames.rows));
            self.output.write_json(&[("rows", growth::json(&rows))])?;
            self.output
                .write_report("growth", "Growth", || Ok(vec![growth::section(&rows)?]))?;
            say(format_args!(
                "{} of {}: {}, in {:.0} s",
                index + 1,
                steps.len(),
                step.stage().name(),
                clock.elapsed().as_secs_f64()
            ))?;
        }
        say(growth::table(&rows).text())?;
        self.output.announce("growth")?;
        // Not before all of it is there: what the report had is then as old as the rest of it.
        let Some(path) = &self.into else {
            return Ok(());
        };
        output::put_into_report(path, growth::section(&rows)?)?;
        output::announce(path)
    }

    /// Each step once, in order.
    fn steps(&self) -> Vec<(growth::Axis, u64)> {
        let mut steps = vec![];
        for axis in &self.axes {
            let (axis, counts) = match axis {
                Axis::Lights => (growth::Axis::Lights, &self.lights),
                Axis::Triangles => (growth::Axis::Triangles, &self.triangles),
            };
            for &count in counts {
                if !steps.contains(&(axis, count)) {
                    steps.push((axis, count));
                }
            }
        }
        steps
    }
}

/// Parses a whole number, such as 250, 10k or 16M.
fn count(text: &str) -> Result<u64, String> {
    let (digits, factor) = match text.strip_suffix(['k', 'M']) {
        Some(digits) if text.ends_with('k') => (digits, 1_000),
        Some(digits) => (digits, 1_000_000),
        None => (text, 1),
    };
    let number = digits.parse::<u64>().ok();
    let number = number.and_then(|number| number.checked_mul(factor));
    number.ok_or_else(|| "expected a whole number such as 250, 10k or 16M".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_may_be_thousands_and_millions() {
        let expected = [("250", 250), ("10k", 10_000), ("16M", 16_000_000)];
        for (text, number) in expected {
            assert_eq!(count(text), Ok(number));
        }
        for wrong in ["", "k", "-1", "1.5M", "1G", "99999999999999M"] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
