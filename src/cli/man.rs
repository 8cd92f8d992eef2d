//! `heelstrike man`: the man pages, for those who package the tool.

use super::output::Output;
use super::{Answered, Cli, Failure, Outcome};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use heelstrike::{Error, Reason};
use std::io::Write;

/// Write a man page in roff
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike man > heelstrike.1
  heelstrike man impact > heelstrike-impact.1")]
pub struct Args {
    /// The command that the page is about [default: the whole tool]
    #[arg(value_name = "COMMAND")]
    page: Option<String>,
}

pub(super) fn run(args: &Args) -> Outcome {
    let mut tool = Cli::command();
    // Subcommands learn their full names and the common version here.
    tool.build();
    let command = match &args.page {
        None => &tool,
        Some(page) => tool.find_subcommand(page).ok_or_else(|| unknown(page, &tool))?,
    };
    let title = command.get_display_name().unwrap_or("heelstrike").to_owned();
    let mut page = Vec::new();
    Man::new(command.clone()).title(title.to_uppercase()).render(&mut page)?;
    let mut output = Output::open(None)?;
    output.write_all(&page)?;
    output.flush()?;
    Ok(Answered::All)
}

fn unknown(page: &str, tool: &Command) -> Failure {
    let reason = Reason::Inconsistent(format!("there is no command \"{page}\""));
    Failure::Usage(Error::new(reason).did_you_mean(page, tool.get_subcommands().map(Command::get_name)))
}
