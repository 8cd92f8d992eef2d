//! Options of the analysis.

use super::Failure;
use super::clock::work_time;
use super::input::InputFile;
use crate::budget::{SharedBudget, TotalBudget};
use crate::law::Friction;
use crate::read::loops_from_json;
use crate::reductions::Reductions;
use crate::robot::Base;
use crate::state::{Defaults, NamedContact, PLACED_BY_JOINTS};
use crate::{Budget, Detail, Robot, pipeline};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use std::thread::available_parallelism;
use std::time::Duration;

/// Friction for inputs that have none.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct FrictionOption {
    /// Friction where the input gives none: a number from 0 on, or "infinite"
    #[arg(long, value_name = "MU", value_parser = str::parse::<Friction>, allow_hyphen_values = true)]
    pub friction: Option<Friction>,
}

impl FrictionOption {
    pub fn defaults(&self) -> Defaults {
        Defaults { friction: self.friction, ..Defaults::default() }
    }
}

/// What states may leave open: friction, closed loops of the robot, contacts.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct SceneOptions {
    #[command(flatten)]
    friction: FrictionOption,
    /// Loops of the robot, which its URDF cuts open: a JSON list like "loops" in a state, for states without their own
    #[arg(long, value_name = "LOOPS.json")]
    pub loops: Option<PathBuf>,
    #[command(flatten)]
    pub contacts: ContactOptions,
}

impl SceneOptions {
    /// Returns the defaults for states of `robot`.
    pub fn defaults(&self, robot: &Robot) -> Result<Defaults, Failure> {
        let read = |path| {
            let input = InputFile::read(path, InputFile::SMALL)?;
            input.text().and_then(|text| loops_from_json(text, robot)).map_err(|error| input.refuse(error))
        };
        let loops = self.loops.as_deref().map(read).transpose()?.unwrap_or_default();
        Ok(Defaults { loops, place_lowest: self.contacts.place_lowest(robot)?, ..self.friction.defaults() })
    }
}

/// How contacts are found.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct ContactOptions {
    /// How far from the ground a foot may be and still touch it, in meters [default: 1e-6 of the robot's size]
    #[arg(long, value_name = "DISTANCE", value_parser = from_zero, allow_hyphen_values = true)]
    pub contact_tolerance: Option<f64>,
    /// Refuse states with joints outside the limits of the robot's file; otherwise they are noted
    #[arg(long)]
    pub strict_limits: bool,
    /// How high the base is, unless the state says so
    #[arg(long, value_name = "WHERE", value_parser = choice(PLACES), default_value = "given")]
    place: PlaceLowest,
    /// Treat contacts slower than this before the impact, in m/s, as exactly at rest; 0 turns this off
    /// [default: the rounding of each, and half a unit in the last place of numbers with 6 to 15 digits]
    #[arg(long, value_name = "SPEED", value_parser = from_zero, allow_hyphen_values = true)]
    pub resting_speed: Option<f64>,
}

/// Whether the lowest foot is put on the ground.
type PlaceLowest = bool;

const PLACES: Choices<PlaceLowest> = &[
    ("given", "At the z of the state", false),
    ("lowest", "Such that the lowest foot is on the ground; the foot moves as it does", true),
];

impl ContactOptions {
    /// Returns whether the lowest foot of `robot` is put on the ground.
    ///
    /// # Errors
    /// Returns an error if it is, but the base is fixed.
    pub fn place_lowest(&self, robot: &Robot) -> Result<bool, Failure> {
        if self.place && robot.base == Base::Fixed {
            let bolted = "the robot is bolted to the world, it cannot be placed";
            return Err(Failure::usage("--place", bolted, PLACED_BY_JOINTS));
        }
        Ok(self.place)
    }
}

/// How tables are written.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct CsvOptions {
    /// Put an apostrophe before CSV cells of text that a spreadsheet would read as a formula
    ///
    /// These begin with =, +, -, @, a tab or a carriage return, as an id or a name of the input may. Numbers stay
    /// numbers.
    #[arg(long)]
    pub csv_safe: bool,
}

impl CsvOptions {
    /// Refuses the option if the output is not CSV.
    pub fn check(self, is_csv: bool) -> Result<(), Failure> {
        if !self.csv_safe || is_csv {
            return Ok(());
        }
        let hint = "write to a file that ends in .csv, or leave it out";
        Err(Failure::usage("--csv-safe", "it is for CSV, and the output is something else", hint))
    }
}

/// How much of each result is shown.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct DetailOptions {
    /// Show why every other combination of modes fails, and beta, gamma and region of each contact
    #[arg(long)]
    pub explain: bool,
    /// Show the mass matrix, the contact Jacobian and the Delassus matrix
    #[arg(long)]
    pub matrices: bool,
    /// Show only the verdict and each outcome's modes, index and margin
    #[arg(long, conflicts_with_all = ["explain", "matrices"])]
    pub brief: bool,
    /// Compute no error bounds: a little faster, but nothing is proven
    #[arg(long)]
    pub no_proof: bool,
}

impl DetailOptions {
    pub fn detail(self) -> Detail {
        Detail { explain: self.explain, matrices: self.matrices, brief: self.brief }
    }

    /// Refuses details that a table cannot contain. `option` is the option that chooses another format.
    pub fn check_table(self, option: &str) -> Result<(), Failure> {
        if !(self.explain || self.matrices) {
            return Ok(());
        }
        let reason = "a table has a row per outcome and no room for --explain or --matrices";
        Err(Failure::usage("", reason, format!("write JSON: {option} ndjson, or -o with that ending")))
    }

    /// Refuses details that a text of regions does not show. `explain` is allowed if a picture is `plotted`.
    pub fn check_regions(self, plotted: bool) -> Result<(), Failure> {
        if !(self.brief || self.matrices || self.explain && !plotted) {
            return Ok(());
        }
        let reason = "text lists regions, and --brief, --explain and --matrices are for the results at samples";
        let hint = "write JSON: --format json, or -o with that ending; --explain is also for --plot";
        Err(Failure::usage("", reason, hint))
    }
}

/// Whether impacts are followed.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct NextOption {
    /// Also find the contact forces just after each outcome, at the contacts that stay on the ground
    #[arg(long, help_heading = "Output")]
    pub next: bool,
}

/// Which computations are skipped if the scene does not need them.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct ReductionOptions {
    /// Also run computations that the scene does not need, all or the listed ones; outcomes stay the same
    #[arg(long, value_name = "WHICH", value_parser = choice(REDUCTIONS), num_args = 0.., require_equals = true)]
    #[arg(value_delimiter = ',')]
    no_reduction: Option<Vec<fn(&mut Reductions)>>,
}

const REDUCTIONS: Choices<fn(&mut Reductions)> = &[
    ("weld", "Links on fixed and frozen joints are merged into their parents", |all| all.weld = false),
    ("massless", "Massless links without shapes on such joints are removed", |all| all.massless = false),
    ("held", "Joints that a state brakes are left out of the mass matrix", |all| all.held = false),
    ("reach", "Shapes too high to reach the ground are skipped", |all| all.reach = false),
    ("merge", "Points between the outer two of a body act through these", |all| all.merge = false),
    ("frictionless", "The modes of a contact without friction share one elimination", |all| all.frictionless = false),
    ("lone", "The condition number of a single contact is computed in closed form", |all| all.lone = false),
];

impl ReductionOptions {
    pub fn reductions(&self) -> Reductions {
        let mut reductions = Reductions::ALL;
        match self.no_reduction.as_deref() {
            Some([]) => return Reductions::NONE,
            parts => parts.into_iter().flatten().for_each(|skip| skip(&mut reductions)),
        }
        reductions
    }
}

/// The possible values of an option: name, help and meaning of each. Aliases follow the name after `|`.
pub type Choices<T> = &'static [(&'static str, &'static str, T)];

/// Returns a parser for the names of `choices`.
pub(super) fn choice<T: Copy + Send + Sync + 'static>(choices: Choices<T>) -> impl TypedValueParser<Value = T> {
    let values = choices.iter().map(|(names, help, _)| {
        let mut names = names.split('|');
        PossibleValue::new(names.next().unwrap_or_default()).aliases(names).help(help)
    });
    PossibleValuesParser::new(values).try_map(move |given| named(choices, &given))
}

/// Returns the value with this name.
///
/// # Errors
/// Returns a text with all names if there is no such name.
pub fn named<T: Copy>(choices: Choices<T>, name: &str) -> Result<T, String> {
    let found = choices.iter().find(|(names, ..)| names.split('|').any(|known| known == name));
    found.map(|(.., value)| *value).ok_or_else(|| {
        let known: Vec<&str> = choices.iter().filter_map(|(names, ..)| names.split('|').next()).collect();
        format!("one of {}", known.join(", "))
    })
}

/// How many threads compute.
#[derive(Debug, clap::Args)]
pub(super) struct ThreadOptions {
    /// How many threads compute; 0 means one per core
    #[arg(long, value_name = "NUMBER", default_value_t = 0, allow_hyphen_values = true, value_parser = clap::value_parser!(u16).range(..=MOST_THREADS))]
    threads: u16,
}

impl ThreadOptions {
    pub fn count(&self) -> usize {
        threads(self.threads.into())
    }
}

const MOST_THREADS: i64 = 1024;

/// Returns the number of threads: `count`, but at most 1,024, or one per core for 0.
pub fn threads(count: usize) -> usize {
    if count == 0 { available_parallelism().map_or(1, usize::from) } else { count.min(MOST_THREADS as usize) }
}

/// How much time the work may take: per state or problem, or a whole `STUDY`.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct BudgetOptions<const STUDY: bool> {
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    #[arg(default_value = if STUDY { "60" } else { "10" })]
    #[arg(help = if STUDY {
        "How many seconds of processor time the study may take, or \"infinite\"; a study that takes longer is refused"
    } else {
        "How many seconds of processor time each answer may take, or \"infinite\"; what is not decided by then is reported as undecided"
    })]
    budget: Seconds,
}

/// A duration; `None` if it is infinite.
pub type Seconds = Option<Duration>;

/// Parses a number of seconds that is not negative, or "infinite".
///
/// # Errors
/// Returns a text about the expected values if `text` is none of them.
pub fn seconds(text: &str) -> Result<Seconds, String> {
    let seconds = |text: &str| Duration::try_from_secs_f64(text.parse().ok()?).ok().map(Some);
    let seconds = if text == "infinite" { Some(None) } else { seconds(text) };
    seconds.ok_or_else(|| "expected a number of seconds from 0 on, or \"infinite\"".to_owned())
}

impl<const STUDY: bool> BudgetOptions<STUDY> {
    /// Returns the budget in processor time; `None` if it is infinite.
    pub fn budget(self) -> Option<Budget> {
        self.budget.map(of_work)
    }
}

fn of_work(time: Duration) -> Budget {
    Budget { time, clock: work_time }
}

impl BudgetOptions<false> {
    /// Returns the budget of many states. Beyond their own budgets they may take `total` together. `None` if infinite.
    pub fn of_many(self, total: Option<Seconds>) -> Option<TotalBudget> {
        let budget = self.budget().or(total.flatten().map(of_work))?;
        (total != Some(None)).then(|| TotalBudget::new(budget, total.flatten()))
    }
}

impl BudgetOptions<true> {
    /// Returns the budget that all threads of a study share.
    pub fn shared(self) -> SharedBudget {
        SharedBudget::new(of_work(self.budget.unwrap_or(Duration::MAX)))
    }
}

pub(super) fn pipeline_options(
    contacts: &ContactOptions,
    feet: Vec<NamedContact>,
    detail: DetailOptions,
    reductions: &ReductionOptions,
    budget: Option<Budget>,
) -> pipeline::Options {
    pipeline::Options {
        feet,
        contact_tolerance: contacts.contact_tolerance,
        resting_speed: contacts.resting_speed,
        strict_limits: contacts.strict_limits,
        explain_up_to: if detail.explain { usize::MAX } else { 0 },
        matrices: detail.matrices,
        no_proof: detail.no_proof,
        reductions: reductions.reductions(),
        budget,
        ..pipeline::Options::default()
    }
}

/// Parses a finite number that is not negative.
///
/// # Errors
/// Returns a text about the expected values if `text` is none of them.
pub fn from_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| (0.0..f64::INFINITY).contains(number));
    number.ok_or_else(|| "expected a number from 0 on".to_owned())
}
