use std::{path::PathBuf, sync::Arc};

use clap::Args;
use lie_bench::{
    BenchError, Stage,
    peers::{self, Harness, Opponent, PeersConfig, SIDE_STEP, SceneContest, Show, Version},
};

use super::{
    Learning,
    output::{Output, progress_bar, teller},
    subject::{LoadedScene, Subject},
    threads::Threads,
};
use crate::{
    args::say,
    failure::{OrUsage, usage},
};

/// Ours beside another program that renders the same plain scene with Intel Embree, in turn.
///
/// That program is separate, and reads a flat file: docs/guide.md says what it gets and what it must
/// print. The plain scene is matt, flat and of one colour for each material; ours render it as well as
/// the scene as it is.
#[derive(Args)]
pub(crate) struct Peers {
    #[command(flatten)]
    subject: Subject,
    /// The program that renders with Embree.
    #[arg(long, value_name = "PATH")]
    embree: PathBuf,
    /// Its variants, by its own names.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "prim16,occ1,lights16,pix16,pix16rev",
        value_name = "NAME,NAME,…"
    )]
    variants: Vec<String>,
    /// Leave out of the plain scene the lights that the program cannot render.
    #[arg(long)]
    skip_unsupported: bool,
    /// Rounds, in each of which every one renders a frame; ratios are medians.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeat: u32,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    learning: Learning,
    #[command(flatten)]
    output: Output,
}

impl Peers {
    pub(super) fn execute(&self) -> anyhow::Result<()> {
        self.output.prepare()?;
        let config = self.config()?;
        config.harness.check().or_usage()?;
        if self.subject.size() % SIDE_STEP != glam::UVec2::ZERO {
            let message = format!("--size: expected two multiples of {SIDE_STEP}");
            return Err(usage(message).into());
        }
        let scenes = self.subject.load()?;
        let pairs: Vec<_> = scenes
            .into_iter()
            .map(|scene| self.with_plain(scene))
            .collect::<Result<_, _>>()?;
        let mut all = SceneContest::default();
        for (scene, plain) in pairs {
            let contest = self.contest(&config, &plain.stage(), &scene.stage())?;
            all.rows.extend(contest.rows);
            all.ratios.extend(contest.ratios);
            self.output.write_json(&[
                ("rows", peers::json(&all.rows)),
                ("ratios", peers::ratios_json(&all.ratios)),
            ])?;
            self.output.write_report("peers", "Beside Embree", || {
                Ok(vec![peers::section(&all.rows, &all.ratios)?])
            })?;
        }
        say(peers::table(&all.rows).text())?;
        say(peers::ratio_table(&all.ratios).text())?;
        self.output.announce("peers")
    }

    fn config(&self) -> anyhow::Result<PeersConfig> {
        let mut variants: Vec<String> = vec![];
        for variant in &self.variants {
            let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
            if variant.is_empty() || !variant.chars().all(is_name) {
                return Err(usage(format!("--variants: '{variant}' is no variant")).into());
            }
            if !variants.contains(variant) {
                variants.push(variant.clone());
            }
        }
        Ok(PeersConfig {
            harness: Harness {
                program: self.embree.clone(),
            },
            variants,
            threads: self.threads.counts()?,
            repeat: self.repeat,
        })
    }

    /// The scene, and its plain copy.
    fn with_plain(&self, scene: LoadedScene) -> anyhow::Result<(LoadedScene, LoadedScene)> {
        let plain = peers::plain(scene.scene())?;
        let left_out = plain.left_out.join(", ");
        let path = scene.path();
        if !plain.left_out.is_empty() {
            if !self.skip_unsupported {
                let message = format!(
                    "{path}: the other program cannot render {left_out}; --skip-unsupported leaves \
                     that out"
                );
                return Err(usage(message).into());
            }
            tracing::warn!("{path}: left out of the plain scene: {left_out}");
        }
        let plain = scene.with_scene(Arc::new(plain.scene));
        Ok((scene, plain))
    }

    fn contest(
        &self,
        config: &PeersConfig,
        plain: &Stage,
        as_it_is: &Stage,
    ) -> anyhow::Result<SceneContest> {
        let bar = progress_bar();
        let opponent = Opponent::new(plain, config, &teller(&bar)).map_err(blamed)?;
        bar.finish_and_clear();
        let plain_lineup = self.learning.construct(plain, peers::CONTENDERS)?;
        let lineup = self.learning.construct(as_it_is, peers::CONTENDERS)?;
        let show = |version, stage, lineup| Show {
            version,
            stage,
            lineup,
        };
        let bar = progress_bar();
        let contest = opponent.measure(
            show(Version::Plain, plain, &plain_lineup),
            show(Version::AsItIs, as_it_is, &lineup),
            &teller(&bar),
        );
        bar.finish_and_clear();
        contest.map_err(blamed)
    }
}

/// A program that is none of this kind is the user's to mend.
fn blamed(error: BenchError) -> anyhow::Error {
    match error {
        BenchError::Peer(error) => usage(error).into(),
        other => other.into(),
    }
}
