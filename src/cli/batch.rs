//! `heelstrike batch`: the answers to many states, in order.

use super::complaint::note;
use super::delivery::Delivery;
use super::options::{ContactOptions, DetailOptions, LoopOptions, SceneOptions, from_zero, pipeline_options};
use super::output::{apart, named, spare};
use super::page::PageOptions;
use super::progress::Progress;
use super::robot::RobotOptions;
use super::{Answered, Failure, Outcome, input};
use clap::ValueEnum;
use heelstrike::batch::{self, Batch, Broken, Chunks, Question, Recorded, Recording, Summary};
use heelstrike::draw::page::Gait;
use heelstrike::error::Location;
use heelstrike::error::excerpt::Excerpt;
use heelstrike::gait::{self, At, Difference, Dropped, Thresholds, Touching};
use heelstrike::state::Defaults;
use heelstrike::state::NamedContact;
use heelstrike::{Error, Reason, Robot, write};
use heelstrike::{
    read::table::{Header, Rates},
    write::Columns,
};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread::available_parallelism;

/// Find every outcome of many states: one line of JSON or row of CSV each, answered in order
///
/// A refused state is answered in its place by its `error`, and the rest goes on; blank lines are skipped. A summary goes to
/// standard error.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike batch urdf/ramone.urdf keyframes.ndjson --friction 0.8 -o results.ndjson
  heelstrike batch urdf/ramone.urdf keyframes.csv --friction 0.8 -o results.csv --summary sum.json
  heelstrike batch urdf/ramone.urdf recorded.csv --touchdowns --velocity backward --friction 0.8")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// States, one JSON object per line or as CSV; "-" reads standard input
    #[arg(value_name = "KEYFRAMES")]
    states: PathBuf,
    /// The form of the input [default: csv where its name ends in .csv, else ndjson]
    #[arg(long, value_name = "FORMAT", value_enum)]
    input_format: Option<Form>,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    loops: LoopOptions,
    #[command(flatten)]
    contacts: ContactOptions,
    #[command(flatten)]
    recording: RecordingOptions,
    #[command(flatten)]
    detail: DetailOptions,
    /// Write to this file, which is replaced
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// The form of the results [default: csv where the output's name ends in .csv, else ndjson]
    #[arg(long, alias = "format", value_name = "FORMAT", value_enum, help_heading = "Output")]
    output_format: Option<Form>,
    /// Write the summary to this file as JSON, too
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    summary: Option<PathBuf>,
    #[command(flatten)]
    plot: PageOptions,
    /// What refused states mean for the exit status: 1, or 0 with "ok"
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Refused::Fail, help_heading = "Output")]
    refused: Refused,
    /// How many threads compute; 0 takes one per core
    #[arg(long, value_name = "NUMBER", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,
}

/// How rows that follow each other in time are taken together.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Recordings")]
struct RecordingOptions {
    /// Answer only the moments at which a foot that was above the ground reaches it
    ///
    /// A foot does so where it comes down far enough (--drop), faster than 0.05 m/s, and ends low enough (--ground-height); it
    /// touches when it is 2 mm above the level on which it ends. Of robots smaller than 0.25 m all of these are in proportion;
    /// the size is the greatest distance from the root's origin to a foot or centre of gravity with all joints at zero. The
    /// base is then shifted so that the foot is at z = 0.
    #[arg(long)]
    touchdowns: bool,
    /// Which state of a touchdown is taken
    #[arg(long, value_enum, default_value = "crossing", requires = "touchdowns")]
    at: AtRow,
    /// Which feet take part beside the one that strikes: strike (none), slow:SPEED,HEIGHT or near:HEIGHT
    ///
    /// With slow of every other body the lowest point, if it is slower than SPEED (m/s) and its height differs from the
    /// striking point's by no more than HEIGHT (m): feet that stand. With near every point at such a height, however it
    /// moves.
    #[arg(long, value_name = "WHICH", default_value_t, requires = "touchdowns")]
    touching: Touching,
    /// How far a foot must have come down, in metres [default: 0.012, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    drop: Option<f64>,
    /// How far above z = 0 a foot may come to rest, in metres; recorded feet float [default: 0.02, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    ground_height: Option<f64>,
    /// Compute velocities from positions and the column time
    #[arg(long, value_enum, value_name = "HOW")]
    velocity: Option<Velocity>,
}

/// The form of an input or output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// One JSON object per line
    #[value(alias = "json", alias = "jsonl")]
    Ndjson,
    /// A table with a header
    Csv,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Refused {
    /// The exit status is 1
    Fail,
    /// The exit status is 0
    Ok,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum AtRow {
    /// Positions and velocities at the moment of contact, carried there from the rows before the impact
    Crossing,
    /// The last row before it, shifted in z
    Row,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Velocity {
    /// From the rows before and after
    Central,
    /// From the row before
    Backward,
}

impl Form {
    fn of(path: &Path) -> Self {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) { Self::Csv } else { Self::Ndjson }
    }
}

impl RecordingOptions {
    fn touchdowns(&self) -> Option<(At, Touching)> {
        let at = match self.at {
            AtRow::Crossing => At::Crossing,
            AtRow::Row => At::Row,
        };
        self.touchdowns.then_some((at, self.touching))
    }

    fn thresholds(&self, robot: &Robot, feet: &[NamedContact]) -> Thresholds {
        let usual = Thresholds::of(robot, feet);
        let (drop, ground) = (self.drop.unwrap_or(usual.drop), self.ground_height.unwrap_or(usual.ground));
        Thresholds { drop, ground, ..usual }
    }

    fn difference(&self) -> Option<Difference> {
        self.velocity.map(|velocity| match velocity {
            Velocity::Central => Difference::Central,
            Velocity::Backward => Difference::Backward,
        })
    }
}

pub(super) fn run(args: &Args) -> Outcome {
    args.plot.check()?;
    let inputs = [Some(&args.robot.robot), Some(&args.states), args.loops.loops.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    spare(args.output.as_deref(), &inputs)?;
    args.summary.as_deref().map_or(Ok(()), |summary| spare(Some(summary), &inputs))?;
    if args.summary.as_deref() == Some(Path::new("-")) {
        let reason =
            "standard output holds the results alone, and standard error has the summary for people".to_owned();
        return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).at("--summary").hint("name a file")));
    }
    let (output, summary) = (args.output.as_deref(), args.summary.as_deref());
    apart([("results", output), ("summary", summary)], "--summary")?;
    if summary.is_some() {
        apart([("summary", summary), ("picture", args.plot.path())], "--plot")?;
    }
    args.plot.claim(&inputs, output)?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let name = input::name(&args.states);
    let progress = Progress::over(&args.states, args.output.is_some());
    let states = progress.watch(input::stream(&args.states)?);
    let mut chunks = match args.input_format.unwrap_or_else(|| Form::of(&args.states)) {
        Form::Ndjson => Chunks::of_lines(states),
        Form::Csv => Chunks::of_table(states),
    };
    let foreign = chunks.foreign().map_err(|error| input::cannot_read(&args.states, &error))?;
    foreign.map_or(Ok(()), |error| Err(error.in_file(&name)))?;
    let header = args.header(&robot, &mut chunks)?;
    let output_form = args.output_format.unwrap_or_else(|| args.output.as_deref().map_or(Form::Ndjson, Form::of));
    let detail = args.detail.detail();
    if output_form == Form::Csv && (detail.explain || detail.matrices || detail.brief) {
        let reason = "a table has a row per outcome and no room for --explain, --matrices or --brief".to_owned();
        let hint = "write JSON: --output-format ndjson, or -o with that ending";
        return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).hint(hint)));
    }
    let touchdowns = args.recording.touchdowns();
    if let Some((at, touching)) = touchdowns {
        // Before any file is replaced: does this robot have feet to look for?
        let none = std::iter::empty::<gait::Sampled<()>>();
        let refused = gait::find(none, &robot, &feet, at, touching).err();
        refused.map_or(Ok(()), |error| Err(error.in_file(input::name(&args.robot.robot))))?;
    }
    let thresholds = args.recording.thresholds(&robot, &feet);
    let columns = || Columns::new(&robot, &feet, header.as_ref(), touchdowns.is_some());
    let columns = (output_form == Form::Csv).then(columns);
    let question = Question {
        robot: &robot,
        options: pipeline_options(&args.contacts, feet, args.detail, &args.robot.reductions),
        defaults: Defaults { loops: args.loops.load(&robot)?, ..args.scene.defaults() },
        detail,
        header: header.as_ref(),
        columns: columns.as_ref(),
        touchdowns,
        keyframes: args.plot.is_asked(),
    };
    // Created before the work, so that it is not in vain.
    let summary = args.summary.as_deref().map(|path| File::create(path).map_err(|error| named(path, error)));
    let summary = summary.transpose()?;

    let mut delivery = Delivery::new(args.open()?, &name, &progress);
    if let Some(columns) = &columns {
        let mut line = Vec::new();
        columns.append_header(&mut line);
        delivery.write(&line)?;
    }
    let dropped = Mutex::new(Dropped::default());
    args.answer(&question, chunks, thresholds, &dropped, &mut delivery)?;
    let told = std::mem::take(&mut delivery.summary);
    let gait = std::mem::take(&mut delivery.gait);
    drop(delivery);
    drop(progress);
    header.as_ref().inspect(|header| tell_of_columns(header, &dropped));
    args.tell(&told, summary, thresholds)?;
    args.draw(&gait, &robot)?;
    Ok(if told.refused == 0 || args.refused == Refused::Ok { Answered::All } else { Answered::NotAll })
}

type Input = Chunks<Box<dyn Read + Send>>;

impl Args {
    /// The columns of a table; none of lines and of an empty table.
    fn header(&self, robot: &Robot, chunks: &mut Input) -> Result<Option<Header>, Failure> {
        let in_order = self.recording.touchdowns || self.recording.velocity.is_some();
        if !chunks.is_table() {
            if in_order {
                let reason = "touchdowns and velocities over time are sought in tables alone".to_owned();
                let hint = "give CSV with a column time, or say --input-format csv";
                return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).hint(hint)));
            }
            return Ok(None);
        }
        let name = input::name(&self.states);
        let first = chunks.first().map_err(|error| input::cannot_read(&self.states, &error))?;
        // A table without any line has no states, like lines of JSON.
        let Some(first) = first else { return Ok(None) };
        let (line, record) = first.map_err(|error| error.in_file(&name))?;
        let rates = if self.recording.velocity.is_some() { Rates::Time } else { Rates::Columns };
        let header = Header::read(&record, robot, rates).map_err(|error| {
            let place = error.location().unwrap_or(Location { line: 1, column: 1 });
            let place = Location { line: line + place.line - 1, ..place };
            let excerpt = Excerpt::around(&record, line, place);
            Failure::RefusedAt(error.on(place.line, place.column).in_file(&name), excerpt)
        })?;
        if in_order && !header.has_time() {
            let missing = Error::new(Reason::Missing("a column \"time\"".into())).on(line, 1);
            return Err(missing.in_file(name).hint("touchdowns are sought over the time").into());
        }
        Ok(Some(header))
    }

    /// Opens the output without a buffer; blocks of results are large enough.
    fn open(&self) -> io::Result<Box<dyn Write>> {
        match self.output.as_ref().filter(|path| path.as_os_str() != "-") {
            Some(path) => Ok(Box::new(File::create(path).map_err(|error| named(path, error))?)),
            None => standard_output(),
        }
    }

    fn answer<W: Write>(
        &self,
        question: &Question,
        chunks: Input,
        thresholds: Thresholds,
        dropped: &Mutex<Dropped>,
        delivery: &mut Delivery<W>,
    ) -> Result<(), Failure> {
        let threads = match self.threads {
            0 => available_parallelism().map_or(1, usize::from),
            threads => usize::from(threads),
        };
        let form = || Batch::new(question);
        let ended = match (question.header, self.recording.difference(), question.touchdowns) {
            (Some(header), difference, touchdowns) if difference.is_some() || touchdowns.is_some() => {
                let samples = batch::samples(chunks, header, question.robot, &question.defaults);
                let samples: Box<dyn Iterator<Item = _> + Send> = match header.is_spatial() {
                    true => Box::new(gait::sagittal(samples, dropped)),
                    false => Box::new(samples),
                };
                let samples: Box<dyn Iterator<Item = _> + Send> = match difference {
                    Some(difference) => Box::new(gait::rates(samples, difference)),
                    None => samples,
                };
                let states: Box<dyn Iterator<Item = Recorded> + Send> = match touchdowns {
                    Some((at, touching)) => {
                        let feet = &question.options.feet;
                        let found = gait::find(samples, question.robot, feet, at, touching);
                        let found = found.map_err(|error| error.in_file(input::name(&self.robot.robot)))?;
                        Box::new(found.with(thresholds).map(Recorded::from))
                    }
                    None => Box::new(samples.map(Recorded::from)),
                };
                batch::run(Recording::new(states), threads, form, delivery)
            }
            _ => batch::run(chunks, threads, form, delivery),
        };
        ended.map_err(|broken| match broken {
            Broken::Input(error) => Failure::Refused(input::cannot_read(&self.states, &error)),
            Broken::Output(error) => Failure::Output(error),
        })
    }

    /// Draws the margins or writes the page, if that is asked for.
    fn draw(&self, gait: &Gait, robot: &Robot) -> Result<(), Failure> {
        if !self.plot.is_asked() {
            return Ok(());
        }
        let page = |rendered| gait.page(&robot.name, rendered);
        self.plot.draw(&gait.picture(&robot.name), "the input holds no states", page)
    }

    /// Writes the summary: for people where there is more than one state or it is asked for, and to its file.
    fn tell(&self, summary: &Summary, file: Option<File>, thresholds: Thresholds) -> io::Result<()> {
        if self.recording.touchdowns && summary.states == 0 {
            let Thresholds { drop, slow, ground, .. } = thresholds;
            // Where nobody reads standard error there is nobody to tell that it cannot be written.
            let _ = writeln!(
                io::stderr(),
                "no touchdown found: one counts where a foot comes down {drop:.4} m or more, faster than {slow:.4} m/s, to at \
                 most {ground:.4} m above the ground (see --drop, --ground-height)",
            );
        } else if summary.states > 1 || file.is_some() {
            let _ = write!(io::stderr(), "{summary}");
        }
        if let (Some(mut file), Some(path)) = (file, &self.summary) {
            let mut line = Vec::new();
            write::append_line(&mut line, summary);
            file.write_all(&line).map_err(|error| named(path, error))?;
        }
        Ok(())
    }
}

/// What of the table did not enter the analysis.
fn tell_of_columns(header: &Header, dropped: &Mutex<Dropped>) {
    let ignored: Vec<&str> = header.ignored().collect();
    if !ignored.is_empty() {
        let (count, names) = (ignored.len(), ignored.join(", "));
        note(&format!(
            "{count} column{} not read, whose joints have no coordinate of their own (inspect tells why): {names}",
            if count == 1 { "" } else { "s" },
        ));
    }
    if let (true, Ok(dropped)) = (header.is_spatial(), dropped.lock()) {
        note(&format!("the base is projected into its plane along the mean heading of each clip; left out: {dropped}"));
    }
}

/// Standard output without the line buffer of std, which would take more than is written to a full disk.
#[cfg(unix)]
fn standard_output() -> io::Result<Box<dyn Write>> {
    use std::os::fd::AsFd;
    Ok(Box::new(File::from(io::stdout().as_fd().try_clone_to_owned()?)))
}

#[cfg(not(unix))]
fn standard_output() -> io::Result<Box<dyn Write>> {
    Ok(Box::new(io::stdout()))
}
