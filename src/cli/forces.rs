//! `heelstrike forces`: every consistent set of contact forces and accelerations of one state, or of a few.

use super::Completion;
use super::impact::StateArgs;
use crate::pipeline::Aspect;

/// Find every consistent set of contact forces and accelerations of a state in sustained contact
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike forces urdf/ramone.urdf examples/ramone_stands.json
  heelstrike forces urdf/block.urdf examples/painleve.json --explain
  heelstrike forces urdf/ramone.urdf - --friction 0.5 --format json < examples/ramone_stands.json")]
pub struct Args {
    #[command(flatten)]
    state: StateArgs,
}

pub(super) fn run(args: &Args) -> Completion {
    args.state.run(Aspect::Forces, false)
}
