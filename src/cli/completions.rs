//! `heelstrike completions`: what a shell needs to complete commands and options.

use super::output::Output;
use super::{Answered, Cli, Outcome};
use clap::CommandFactory;
use clap_complete::Shell;
use std::io::Write;

/// Write a shell's completions of commands and options
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike completions bash > ~/.local/share/bash-completion/completions/heelstrike
  heelstrike completions zsh > ~/.zfunc/_heelstrike
  heelstrike completions fish > ~/.config/fish/completions/heelstrike.fish")]
pub struct Args {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(super) fn run(args: &Args) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "heelstrike", &mut script);
    let mut output = Output::open(None)?;
    output.write_all(&script)?;
    output.flush()?;
    Ok(Answered::All)
}
