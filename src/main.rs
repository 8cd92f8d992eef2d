//! The command-line tool.

use std::process::ExitCode;

fn main() -> ExitCode {
    heelstrike::cli::main(std::env::args_os()).into()
}
