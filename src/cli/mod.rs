//! The commands of the tool, one file each. This is the only user of clap.
//!
//! Standard output carries only results; standard error carries errors with hints, and notes. Exit status: 0 if all
//! inputs were answered, 1 if an input was refused or the output could not be written, 2 for wrong usage.

mod diagnostic;
mod clock;
mod progress;
mod input;
mod output;
mod format;
mod picture;
mod options;
mod meshes;
mod robot;
mod stream;
mod origin;
mod resume;
mod sink;
mod recording;
mod inspect;
mod impact;
mod batch;
mod solve;
mod sweep;
mod accuracy;
mod reference;

pub use clock::work_time;
pub use format::records;
pub use meshes::Meshes;
pub use options::{Choices, Seconds, from_zero, named, seconds, threads};
pub use recording::{DIFFERENCES, ROWS, RecordingOptions};
pub use robot::{BASES, PLANES};

use crate::error::excerpt::Excerpt;
use crate::error::visible;
use crate::pipeline::Aspect;
use crate::{Error, Reason};
use anstream::{AutoStream, ColorChoice};
use clap::error::{ContextKind, ContextValue};
use clap::{Parser, Subcommand};
use diagnostic::{report, report_with};
use options::choice;
use output::Output;
use std::borrow::Cow;
use std::ffi::OsString;
use std::io::{self, Write};

/// The version of the crate, and the commit if it is known.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("HEELSTRIKE_COMMIT"));

/// Every rigid frictional impact outcome of a planar legged robot: which contact sticks, slides or lifts off, and
/// whether that is the only possibility.
#[derive(Debug, Parser)]
#[command(name = "heelstrike", version = VERSION, propagate_version = true, arg_required_else_help = true)]
#[command(after_help = "Example:\n  heelstrike impact urdf/ramone.urdf examples/ramone.json")]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Write no notes, no summary and no progress to standard error, only errors
    #[arg(long, global = true, help_heading = "Messages")]
    quiet: bool,
    /// When text is colored; the variable NO_COLOR also turns colors off
    #[arg(long, value_name = "WHEN", value_parser = choice(COLORS), default_value = "auto", global = true)]
    #[arg(help_heading = "Messages")]
    color: ColorChoice,
}

const COLORS: Choices<ColorChoice> = &[
    ("auto", "On a terminal", ColorChoice::Auto),
    ("always", "Everywhere", ColorChoice::Always),
    ("never", "Nowhere", ColorChoice::Never),
];

#[derive(Debug, Subcommand)]
enum Command {
    Inspect(inspect::Args),
    Impact(impact::Args),
    /// Find every consistent set of contact forces and accelerations of a state in sustained contact
    #[command(after_help = "\
Examples:
  heelstrike forces urdf/ramone.urdf examples/ramone_stands.json
  heelstrike forces urdf/block.urdf examples/painleve.json --explain
  heelstrike forces urdf/ramone.urdf - --friction 0.5 --format json < examples/ramone_stands.json")]
    Forces(impact::StateArgs),
    Batch(batch::Args),
    Solve(solve::Args),
    Sweep(sweep::Args),
    Accuracy(accuracy::Args),
    Schema(reference::SchemaArgs),
    Completions(reference::CompletionsArgs),
    Man(reference::ManArgs),
}

/// The reason why a command ended early.
enum Failure {
    /// An input that the command needs was refused, such as the robot's file; with an excerpt of the line in question.
    Refused(Error, Option<Excerpt>),
    /// The value of an option is wrong or does not fit the robot.
    Usage(Error),
    /// The output could not be written.
    Output(io::Error),
}

impl Failure {
    /// Creates the failure for a wrong use of `option`; it is empty if several do not fit together.
    fn usage(option: &str, reason: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage(Error::new(Reason::Inconsistent(reason.into())).at(option).hint(hint))
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Refused(error, None)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

/// Whether every input was answered, or why the command ended early.
type Completion = Result<Answered, Failure>;

/// Whether a command that read all of its inputs answered all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answered {
    All,
    NotAll,
}

/// Runs the tool with these arguments, the first of which is its name, and returns the exit status. The buffer of
/// standard output is flushed.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let exit = match Cli::try_parse_from(arguments) {
        Ok(cli) => run(cli),
        Err(message) => usage(&with_tip(message)),
    };
    match io::stdout().flush() {
        Err(error) if exit == 0 => status(Failure::Output(error)),
        _ => exit,
    }
}

fn run(cli: Cli) -> u8 {
    cli.color.write_global();
    diagnostic::set_quiet(cli.quiet);
    let completion = match cli.command {
        Command::Inspect(args) => inspect::run(&args),
        Command::Impact(args) => impact::run(&args),
        Command::Forces(args) => args.run(Aspect::Forces, false),
        Command::Batch(args) => batch::run(&args),
        Command::Solve(args) => solve::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Schema(args) => reference::schema(&args),
        Command::Completions(args) => reference::completions(&args),
        Command::Man(args) => reference::man(&args),
    };
    match completion {
        Ok(Answered::All) => 0,
        Ok(Answered::NotAll) => 1,
        Err(failure) => status(failure),
    }
}

/// Adds a tip to clap's message if the names of files show what was probably meant.
fn with_tip(mut message: clap::Error) -> clap::Error {
    let given = |kind| if let Some(ContextValue::String(given)) = message.get(kind) { given } else { "" };
    let (command, argument) = (given(ContextKind::InvalidSubcommand), given(ContextKind::InvalidArg));
    let usage = message.get(ContextKind::Usage).map_or(String::new(), ContextValue::to_string);
    let tip = if command.ends_with(".urdf") {
        format!("name a command first: heelstrike impact {command} STATE.json")
    } else if argument.ends_with(".json") && usage.contains(" inspect ") {
        format!("a state is an option here: --state {argument} --plot pose.svg")
    } else {
        return message;
    };
    message.remove(ContextKind::SuggestedSubcommand);
    message.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    message
}

/// Writes clap's message, such as the version or an error about an option, and returns the exit status.
fn usage(message: &clap::Error) -> u8 {
    let styled = message.render();
    if !message.use_stderr() {
        // Not by clap: std ignores the error of writing to a descriptor that is not open for writing.
        let plain = AutoStream::choice(&io::stdout()) == ColorChoice::Never;
        let text = if plain { styled.to_string() } else { styled.ansi().to_string() };
        let written = Output::open(None).map_err(Failure::Output).and_then(|output| output.finish(text.as_bytes()));
        return written.map_or_else(status, |_| 0);
    }
    let text = styled.to_string();
    let shown: Vec<_> = text.split('\n').map(visible).collect();
    // A failure to write to standard error cannot be reported anywhere.
    let _ = match shown.iter().any(|line| matches!(line, Cow::Owned(_))) {
        // The arguments contain characters that would control the terminal.
        true => write!(anstream::stderr(), "{}", shown.join("\n")),
        false => message.print(),
    };
    u8::try_from(message.exit_code()).unwrap_or(2)
}

/// Reports why a command ended early, and returns the exit status.
fn status(failure: Failure) -> u8 {
    match failure {
        // The reader closed the pipe, as `| head` does.
        Failure::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => return 0,
        Failure::Output(error) => {
            report(&Reason::Io(format!("the output cannot be written: {error}")).into());
        }
        Failure::Refused(error, excerpt) => report_with(&error, excerpt.as_ref()),
        Failure::Usage(error) => {
            report(&error);
            return 2;
        }
    }
    1
}
