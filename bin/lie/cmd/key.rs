//! Cluster bundles: who has one belongs to the cluster.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lie_farm::secure::{Bundle, BundleError, Cluster, Flaw, MAX_DAYS};

use crate::{
    args::say,
    failure::{OrUsage, Usage},
};

/// Makes and shows cluster bundles, which let processes on several machines trust each other.
#[derive(Subcommand)]
pub(crate) enum KeyCommand {
    New(New),
    Show(Show),
    Trust(TrustOthers),
}

/// Makes a new cluster: writes its bundle, for all of its processes, into one file.
///
/// Give the file to every machine, by a way on which nobody else can read it, and name it with
/// `--bundle`. Whoever has it belongs to the cluster.
#[derive(Args)]
pub(crate) struct New {
    #[command(flatten)]
    output: Output,
    /// Days for which it holds. Connections that are there stay; no new ones are made after that.
    #[arg(long, default_value_t = 365, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_DAYS)), value_name = "N")]
    days: u32,
}

/// Says of a bundle which cluster it is of, whom it trusts and how long it holds.
///
/// The private key is not shown. Ends with code 2 if the bundle cannot be used now.
#[derive(Args)]
pub(crate) struct Show {
    /// The bundle.
    file: PathBuf,
}

/// Writes a bundle as the first one, which trusts the clusters of the others as well.
///
/// To replace a bundle while the farm works: `lie key trust OLD NEW --out BOTH`, restart the
/// processes with BOTH, one after the other; `lie key trust NEW OLD --out BOTH2`, the same with it;
/// then the same with NEW.
#[derive(Args)]
pub(crate) struct TrustOthers {
    /// The bundle whose certificate is kept.
    bundle: PathBuf,
    /// Bundles of clusters to trust as well.
    #[arg(required = true)]
    others: Vec<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// Where a bundle goes.
#[derive(Args)]
struct Output {
    /// Where to write it, readable by its owner alone.
    #[arg(long, default_value = "cluster.pem", value_name = "FILE")]
    out: PathBuf,
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
}

pub(crate) fn execute(command: &KeyCommand) -> anyhow::Result<()> {
    match command {
        KeyCommand::New(new) => new.output.write(&Bundle::issue(new.days)?),
        KeyCommand::Show(show) => show.execute(),
        KeyCommand::Trust(trust) => trust.execute(),
    }
}

impl Show {
    fn execute(&self) -> anyhow::Result<()> {
        let bundle = Bundle::read(&self.file).or_usage()?;
        describe(&bundle)?;
        Cluster::new(&bundle).or_usage()?;
        Ok(())
    }
}

impl TrustOthers {
    fn execute(&self) -> anyhow::Result<()> {
        let read = |path: &PathBuf| Bundle::read(path).or_usage();
        let others: Vec<Bundle> = self.others.iter().map(read).collect::<Result<_, _>>()?;
        let bundle = read(&self.bundle)?.trusting(&others).or_usage()?;
        self.output.write(&bundle)
    }
}

impl Output {
    fn write(&self, bundle: &Bundle) -> anyhow::Result<()> {
        usable(bundle)?;
        match bundle.write(&self.out, self.force) {
            Err(error @ BundleError::Exists(_)) => Err(error).or_usage()?,
            written => written?,
        }
        say(format_args!("bundle: {}", self.out.display()))?;
        describe(bundle)
    }
}

/// One that has expired may be written: it is the user's to know.
fn usable(bundle: &Bundle) -> Result<(), Usage> {
    match Cluster::new(bundle) {
        Err(BundleError::Flaw {
            flaw: Flaw::Expired(_) | Flaw::NotYetValid(_),
            ..
        })
        | Ok(_) => Ok(()),
        Err(error) => Err(error).or_usage(),
    }
}

fn describe(bundle: &Bundle) -> anyhow::Result<()> {
    let own = bundle.fingerprint();
    say(format_args!("cluster: {own}"))?;
    for other in bundle.trusted().filter(|other| *other != own) {
        say(format_args!("trusts as well: {other}"))?;
    }
    say(format_args!("valid: {}", bundle.validity()))
}
