//! `heelstrike schema`, `completions` and `man`: descriptions of the tool and its data.

use super::output::Output;
use super::{Cli, Completion, Failure};
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use heelstrike::write::schema;
use heelstrike::{Error, Reason};

/// Write the JSON Schema of a state, a result, a problem, a study, its sweep or a report on accuracy
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike schema state
  heelstrike schema result > result.schema.json")]
pub struct SchemaArgs {
    /// What the schema is of
    #[arg(value_enum)]
    of: Document,
}

/// What there are schemas of.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Document {
    /// What `impact` and `batch` read
    State,
    /// A line of what `impact`, `batch` and `solve` write as JSON
    Result,
    /// What `solve` reads
    Problem,
    /// What `sweep` reads
    Study,
    /// What `sweep` writes as JSON
    Sweep,
    /// What `accuracy` writes as JSON
    Accuracy,
}

pub(super) fn schema(args: &SchemaArgs) -> Completion {
    let schema = match args.of {
        Document::State => schema::state(),
        Document::Result => schema::result(),
        Document::Problem => schema::problem(),
        Document::Study => schema::study(),
        Document::Sweep => schema::sweep(),
        Document::Accuracy => schema::accuracy(),
    };
    Output::open(None)?.finish(format!("{schema:#}\n").as_bytes())
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
        Some(page) => tool.find_subcommand(page).ok_or_else(|| unknown(page, &tool))?,
    };
    let title = command.get_display_name().unwrap_or("heelstrike").to_owned();
    let mut page = Vec::new();
    Man::new(command.clone()).title(title.to_uppercase()).render(&mut page)?;
    Output::open(None)?.finish(&page)
}

fn unknown(page: &str, tool: &Command) -> Failure {
    let reason = Reason::Inconsistent(format!("there is no command \"{page}\""));
    Failure::Usage(Error::new(reason).did_you_mean(page, tool.get_subcommands().map(Command::get_name)))
}
