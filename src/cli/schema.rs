//! `heelstrike schema`: JSON Schema of what is read and written.

use super::output::Output;
use super::{Answered, Outcome};
use heelstrike::write::schema;
use std::io::Write;

/// Write the JSON Schema of a state, a result, a problem, a study, its sweep or a report on accuracy
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike schema state
  heelstrike schema result > result.schema.json")]
pub struct Args {
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

pub(super) fn run(args: &Args) -> Outcome {
    let schema = match args.of {
        Document::State => schema::state(),
        Document::Result => schema::result(),
        Document::Problem => schema::problem(),
        Document::Study => schema::study(),
        Document::Sweep => schema::sweep(),
        Document::Accuracy => schema::accuracy(),
    };
    let mut output = Output::open(None)?;
    writeln!(output, "{schema:#}")?;
    output.flush()?;
    Ok(Answered::All)
}
