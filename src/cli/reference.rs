//! `heelstrike schema`, `completions` and `man`: descriptions of the tool and its data.

use super::options::{Choices, choice};
use super::output::Output;
use super::{Cli, Completion, Failure};
use crate::write::schema;
use crate::{Error, Reason};
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use serde_json::Value;

/// Write the JSON Schema of a state, a result, forces, a problem, a study, its sweep or a report on accuracy
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike schema state
  heelstrike schema result > result.schema.json")]
pub struct SchemaArgs {
    /// What the schema is of
    #[arg(value_parser = choice(SCHEMAS))]
    of: fn() -> Value,
}

const SCHEMAS: Choices<fn() -> Value> = &[
    ("state", "What `impact`, `forces` and `batch` read", schema::state),
    ("result", "A line of what `impact`, `batch` and `solve` write as JSON", schema::result),
    ("forces", "A line of what `forces` writes as JSON", schema::forces),
    ("problem", "What `solve` reads", schema::problem),
    ("study", "What `sweep` reads", schema::study),
    ("sweep", "What `sweep` writes as JSON", schema::sweep),
    ("accuracy", "What `accuracy` writes as JSON", schema::accuracy),
];

pub(super) fn schema(args: &SchemaArgs) -> Completion {
    Output::open(None)?.finish(format!("{:#}\n", (args.of)()).as_bytes())
}

/// Write a shell's completions of commands and options
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike completions bash > ~/.local/share/bash-completion/completions/heelstrike
  heelstrike completions zsh > ~/.zfunc/_heelstrike
  heelstrike completions fish > ~/.config/fish/completions/heelstrike.fish")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(super) fn completions(args: &CompletionsArgs) -> Completion {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "heelstrike", &mut script);
    Output::open(None)?.finish(&script)
}

/// Write a man page in roff
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike man > heelstrike.1
  heelstrike man impact > heelstrike-impact.1")]
pub struct ManArgs {
    /// The command that the page is about [default: the whole tool]
    #[arg(value_name = "COMMAND")]
    page: Option<String>,
}

pub(super) fn man(args: &ManArgs) -> Completion {
    let mut tool = Cli::command();
    // Subcommands get their full names and the common version here.
    tool.build();
    let command = match &args.page {
        None => &tool,
        Some(page) => tool.find_subcommand(page).ok_or_else(|| {
            let reason = Reason::Inconsistent(format!("there is no command \"{page}\""));
            Failure::Usage(Error::new(reason).did_you_mean(page, tool.get_subcommands().map(Command::get_name)))
        })?,
    };
    let title = command.get_display_name().unwrap_or("heelstrike").to_owned();
    let mut page = Vec::new();
    Man::new(command.clone()).title(title.to_uppercase()).render(&mut page)?;
    Output::open(None)?.finish(&page)
}
