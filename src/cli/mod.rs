//! The commands, one file each; the only user of clap.
//!
//! Standard output carries results alone, standard error what is wrong and how to mend it. Exit status: 0 all answered,
//! 1 some input was refused, 2 wrong usage.

mod accuracy;
mod batch;
mod complaint;
mod completions;
mod delivery;
mod impact;
mod input;
mod inspect;
mod man;
mod meshes;
mod options;
mod output;
mod picture;
mod page;
mod progress;
mod robot;
mod schema;
mod solve;
mod stream;
mod sweep;

use clap::{Parser, Subcommand};
use complaint::{complain, complain_at};
use heelstrike::error::excerpt::Excerpt;
use std::io::{self, Write};
use std::process::ExitCode;

/// The crate's version, and the commit where it is known.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("HEELSTRIKE_COMMIT"));

/// Every rigid frictional impact outcome of a planar legged robot: which contact sticks, slides or lifts off, and whether
/// that is the only possibility.
#[derive(Debug, Parser)]
#[command(name = "heelstrike", version = VERSION, propagate_version = true, arg_required_else_help = true)]
#[command(after_help = "Example:\n  heelstrike impact urdf/ramone.urdf examples/ramone.json")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Inspect(inspect::Args),
    Impact(impact::Args),
    Batch(batch::Args),
    Solve(solve::Args),
    Sweep(sweep::Args),
    Accuracy(accuracy::Args),
    Schema(schema::Args),
    Completions(completions::Args),
    #[command(hide = true)]
    Man(man::Args),
}

/// Why a command ended early.
enum Failure {
    /// Input that nothing can be done without, such as the robot's file.
    Refused(heelstrike::Error),
    /// The same, and the line that the place is in.
    RefusedAt(heelstrike::Error, Option<Excerpt>),
    /// An option's value that does not fit the robot.
    Usage(heelstrike::Error),
    /// The output could not be written.
    Output(io::Error),
}

impl From<heelstrike::Error> for Failure {
    fn from(error: heelstrike::Error) -> Self {
        Self::Refused(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

/// Whether every input was answered, or why the command ended early.
type Outcome = Result<Answered, Failure>;

/// How a command ended that went through all of its input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answered {
    All,
    NotAll,
}

/// Runs the command and tells the exit status.
pub fn run(cli: Cli) -> ExitCode {
    let outcome = match cli.command {
        Command::Inspect(args) => inspect::run(&args),
        Command::Impact(args) => impact::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::Solve(args) => solve::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Schema(args) => schema::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    };
    match outcome {
        Ok(Answered::All) => ExitCode::SUCCESS,
        Ok(Answered::NotAll) => ExitCode::from(1),
        Err(failure) => ExitCode::from(status(failure)),
    }
}

/// Writes what clap has to say, such as the version or what is wrong with an option, and gives the exit status.
pub fn usage(told: &clap::Error) -> ExitCode {
    let written = told.print().and_then(|()| io::stdout().flush());
    match written {
        Err(error) if !told.use_stderr() => ExitCode::from(status(Failure::Output(error))),
        _ => ExitCode::from(u8::try_from(told.exit_code()).unwrap_or(2)),
    }
}

/// Tells why a command ended early; gives the exit status.
fn status(failure: Failure) -> u8 {
    match failure {
        // Whoever reads has seen enough, as with `| head`.
        Failure::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => return 0,
        Failure::Output(error) => {
            complain(&heelstrike::Reason::Io(format!("the output cannot be written: {error}")).into());
        }
        Failure::Refused(error) => complain(&error),
        Failure::RefusedAt(error, excerpt) => complain_at(&error, excerpt.as_ref()),
        Failure::Usage(error) => {
            complain(&error);
            return 2;
        }
    }
    1
}
