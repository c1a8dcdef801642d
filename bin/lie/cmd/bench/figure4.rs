use clap::Args;
use lie_bench::{
    Lineup, Panel, Stage,
    figure4::{self, SceneCosts},
};

use super::{
    Learning,
    output::{Output, progress_bar, teller},
    subject::Subject,
};
use crate::{args::say, process};

/// The paper's Figure 4: pictures of what each pixel costs, without masking and with it.
///
/// Costs are counted and weighed, not timed: the same on every machine. The standard's stand
/// beside them. Masking goes by samples: --trust 0 or --no-proofs compares like with like.
#[derive(Args)]
pub(crate) struct Figure4 {
    #[command(flatten)]
    subject: Subject,
    /// Threads; 0 is one for each core. Costs do not depend on them.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    #[command(flatten)]
    learning: Learning,
    #[command(flatten)]
    output: Output,
}

impl Figure4 {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let threads = process::threads(self.threads)?;
        let mut rows = vec![];
        let mut panels: Vec<Panel> = vec![];
        for scene in self.subject.load()? {
            let stage = scene.stage();
            let lineup = self.learning.construct(&stage, figure4::CONTENDERS)?;
            let costs = measure(&stage, &lineup, threads)?;
            panels.push(figure4::panel(&stage, &costs));
            rows.extend(costs.rows);
            self.output.write_json(&[("rows", figure4::json(&rows))])?;
            self.output.write_report("figure4", "Figure 4", || {
                Ok(vec![figure4::section(&rows, panels.clone())])
            })?;
        }
        say(figure4::table(&rows).text())?;
        self.output.announce("figure4")
    }
}

/// Counts costs, with a bar.
pub(super) fn measure(
    stage: &Stage,
    lineup: &Lineup,
    threads: usize,
) -> anyhow::Result<SceneCosts> {
    let bar = progress_bar();
    let costs = figure4::measure(stage, lineup, threads, &teller(&bar))?;
    bar.finish_and_clear();
    Ok(costs)
}
