//! The `lie` executable: parses arguments, starts what they ask for, and turns an error
//! into a message and an exit code. 0 is success, 1 a failed run, 2 bad arguments or input.

mod args;
mod cmd;
mod failure;
mod logging;
mod process;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use logging::Logging;

/// Renders direct light from many lights at interactive rates, on one machine or a cluster.
///
/// Without a command, renders the walkthrough of the default scene, scenes/gallery, on this
/// machine, and writes its frames to out/, as PNG of 640 x 360 pixels.
#[derive(Parser)]
#[command(version, propagate_version = true, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    logging: Logging,
}

#[derive(Subcommand)]
enum Command {
    Run(cmd::run::Run),
    Constructor(cmd::constructor::Constructor),
    Shader(cmd::shader::Shader),
    View(cmd::view::View),
    Status(cmd::status::Status),
    Render(cmd::render::Render),
    Inspect(cmd::inspect::Inspect),
    Compare(cmd::compare::Compare),
    #[command(subcommand)]
    Bench(cmd::bench::BenchCommand),
    #[command(subcommand)]
    Scene(cmd::scene::SceneCommand),
    #[command(subcommand)]
    Key(cmd::key::KeyCommand),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let format = arguments.logging.log_format;
    match execute(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            logging::fail(&error, format);
            ExitCode::from(failure::exit_code(&error))
        }
    }
}

fn execute(arguments: Arguments) -> anyhow::Result<()> {
    logging::start(&arguments.logging)?;
    run_command(arguments)
}

fn run_command(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Some(Command::Run(run)) => cmd::run::execute(&run, &arguments.logging),
        Some(Command::Constructor(constructor)) => cmd::constructor::execute(&constructor),
        Some(Command::Shader(shader)) => cmd::shader::execute(&shader),
        Some(Command::View(view)) => cmd::view::execute(&view),
        Some(Command::Status(status)) => cmd::status::execute(&status),
        Some(Command::Render(render)) => cmd::render::execute(&render),
        Some(Command::Inspect(inspect)) => cmd::inspect::execute(&inspect),
        Some(Command::Compare(compare)) => cmd::compare::execute(&compare),
        Some(Command::Bench(bench)) => cmd::bench::execute(&bench),
        Some(Command::Scene(scene)) => cmd::scene::execute(&scene),
        Some(Command::Key(key)) => cmd::key::execute(&key),
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
            &arguments.logging.log,
            "--log-format",
            arguments.logging.log_format.name(),
        ])),
    }
}
