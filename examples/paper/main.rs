//! Every figure and table of the paper that shows collisions, drawn again and compared with what the paper says of it:
//! `cargo run --example paper [DIRECTORY]`.
//!
//! ```text
//!     figures: study or state, robot, claims --[exhibit]--> regions or outcomes --[along, map, cases]--> findings, printed
//!                                                                             --[picture]--> DIRECTORY/NAME.svg
//! ```

mod along;
mod cases;
mod exhibit;
mod figures;
mod map;
mod picture;

use exhibit::Exhibit;
use figures::FIGURES;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args_os().nth(1).map_or_else(|| PathBuf::from(exhibit::HERE), PathBuf::from);
    std::fs::create_dir_all(&directory)?;
    for figure in FIGURES {
        let exhibit = Exhibit::read(figure)?;
        let found = exhibit.found()?;
        println!("{}  ({}.json, {}.urdf)", figure.title, figure.input.name(), figure.robot);
        for claim in figure.claims {
            let finding = (claim.check)(&found)?;
            println!("  paper:      {}", claim.words);
            println!("  heelstrike: {}", finding.words);
            println!("  {}", agreement(finding.agrees));
        }
        println!();
        if let Some(svg) = picture::of(&exhibit, &found)?.and_then(|picture| picture.svg()) {
            std::fs::write(directory.join(format!("{}.svg", figure.name)), svg)?;
        }
    }
    Ok(())
}

fn agreement(agrees: Option<bool>) -> &'static str {
    match agrees {
        Some(true) => "They agree.",
        Some(false) => "They differ.",
        None => "The paper's numbers are lost: nothing to compare.",
    }
}
