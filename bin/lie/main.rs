//! The `lie` executable: parses arguments, starts what they ask for, and turns an error
//! into a message and an exit code. 0 is success, 1 a failed run, 2 bad arguments or input.

mod args;
mod cmd;
mod failure;
mod process;

use std::{
    io::{IsTerminal, Write},
    process::ExitCode,
};

use clap::{Parser, Subcommand};

/// Renders direct light from many lights at interactive rates, on one machine or a cluster.
///
/// Without a command, renders the walkthrough of the default scene, scenes/gallery, on this
/// machine, and writes its frames to out/, as PNG of 640 x 360 pixels.
#[derive(Parser)]
#[command(version, propagate_version = true, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    /// What to log to standard error: error, warn, info, debug, trace, or a filter such as
    /// `warn,lie_farm=debug`.
    #[arg(
        long,
        global = true,
        default_value = "warn",
        env = "LIE_LOG",
        value_name = "FILTER"
    )]
    log: String,
}

#[derive(Subcommand)]
enum Command {
    Run(cmd::run::Run),
    Constructor(cmd::constructor::Constructor),
    Shader(cmd::shader::Shader),
    View(cmd::view::View),
    Render(cmd::render::Render),
    Inspect(cmd::inspect::Inspect),
    Compare(cmd::compare::Compare),
    #[command(subcommand)]
    Bench(cmd::bench::BenchCommand),
    #[command(subcommand)]
    Scene(cmd::scene::SceneCommand),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match execute(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nothing is left to do if standard error is closed.
            let _ = writeln!(std::io::stderr(), "error: {error:#}");
            ExitCode::from(failure::exit_code(&error))
        }
    }
}

fn execute(arguments: Arguments) -> anyhow::Result<()> {
    start_logging(&arguments.log)?;
    run_command(arguments)
}

fn run_command(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Some(Command::Run(run)) => cmd::run::execute(&run, &arguments.log),
        Some(Command::Constructor(constructor)) => cmd::constructor::execute(&constructor),
        Some(Command::Shader(shader)) => cmd::shader::execute(&shader),
        Some(Command::View(view)) => cmd::view::execute(&view),
        Some(Command::Render(render)) => cmd::render::execute(&render),
        Some(Command::Inspect(inspect)) => cmd::inspect::execute(&inspect),
        Some(Command::Compare(compare)) => cmd::compare::execute(&compare),
        Some(Command::Bench(bench)) => cmd::bench::execute(&bench),
        Some(Command::Scene(scene)) => cmd::scene::execute(&scene),
        None => run_command(Arguments::parse_from([
            "lie",
            "run",
            "--out",
            "out",
            "--format",
            "png",
            "--size",
            "640x360",
            "--frames",
            "24",
            "--log",
            &arguments.log,
        ])),
    }
}

/// Logs go to standard error; standard output is for results.
fn start_logging(filter: &str) -> anyhow::Result<()> {
    use failure::OrUsage;
    let filter = tracing_subscriber::EnvFilter::try_new(filter).or_usage()?;
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .compact()
        .init();
    Ok(())
}
