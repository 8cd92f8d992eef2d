//! Notes on an input, in sentences. The tool writes them to standard error; Python raises them as warnings.

use crate::budget::TotalBudget;
use crate::gait::Dropped;
use crate::read::Study;
use crate::read::table::Header;

/// Notes that `count` inputs, each called a `what`, have their own friction, which replaces the common one; `None` if
/// none has.
pub fn own_friction(count: u64, what: &str) -> Option<String> {
    not_used("`friction` is", &format!("a {what} has its own"), count)
}

/// Notes that `count` inputs, each called a `what`, name their contacts, so that the common feet are not used; `None`
/// if none does.
pub fn own_contacts(count: u64, what: &str) -> Option<String> {
    not_used("feet given by `feet` are", &format!("a {what} names its contacts"), count)
}

fn not_used(given: &str, other: &str, count: u64) -> Option<String> {
    let some = if count == 1 { "one does".to_owned() } else { format!("{count} do") };
    (count > 0).then(|| format!("{given} not used where {other}, as {some} here"))
}

/// Notes the least time that an answer had after others exceeded their budget; `None` if each had its full time.
pub fn beyond_budget(total: Option<&TotalBudget>) -> Option<String> {
    let least = total?.least()?.as_secs_f64();
    Some(format!("answers beyond `budget` took so long together that one had {least:.2e} s"))
}

/// Names the coordinates without a column, which are taken as 0; `None` if there are none.
pub fn missing(header: &Header) -> Option<String> {
    match header.missing() {
        [] => None,
        [only] => Some(format!("a column is missing, and taken as 0: {only}")),
        missing => Some(format!("{} columns are missing, and taken as 0: {}", missing.len(), missing.join(", "))),
    }
}

/// Names the columns that were not read, and the motion that the projection of a three-dimensional base leaves out.
pub fn left_out(header: &Header, dropped: &Dropped) -> impl Iterator<Item = String> {
    let ignored: Vec<&str> = header.ignored().collect();
    let not_read = (!ignored.is_empty()).then(|| {
        let names = ignored.join(", ");
        format!("columns of joints without a coordinate are not read (see `heelstrike inspect`): {names}")
    });
    let projected = header.is_spatial().then(|| {
        format!("the base is projected into its plane along the mean heading of each clip; left out: {dropped}")
    });
    not_read.into_iter().chain(projected)
}

/// Notes on odd touchdowns. `counts` are those taken above the ground, of feet whose heights have no noise; those of
/// feet that are already slowed down; those taken far below the ground; those with another one too near; those
/// without an impact.
pub fn odd_touchdowns(counts: [u64; 5]) -> impl Iterator<Item = String> {
    let what = [
        ("taken above the ground, from heights without noise", "if they are of a simulation, give `simulated`"),
        (
            "whose foot has fallen more than twice as fast shortly before",
            "if it sinks into soft ground, theirs is the state after the impact: give `simulated`",
        ),
        (
            "of feet far under z = 0, which were lifted to it",
            "are the base's height and axes right, or does the ground descend?",
        ),
        (
            "so soon after another that no velocity between them is known",
            "theirs is the state before both: give more rows in a second",
        ),
        (
            "without an impact, as their foot does not come down",
            "is theirs the state after it? (see `at`, `simulated`)",
        ),
    ];
    let found = counts.into_iter().zip(what).filter(|(count, _)| *count > 0);
    found.map(|(count, (what, then))| format!("touchdowns {what}: {count}; {then}"))
}

/// Notes that a brief table does not say for `count` states whether their outcomes hold within their uncertainty.
pub fn without_holds(count: u64) -> Option<String> {
    let what = "states with an `uncertainty`, without a word on whether they hold";
    (count > 0).then(|| format!("{what}: {count}; without `brief` it stands in the column notes"))
}

/// Names the parameters that nothing in the state or the robot depends on.
pub fn unused(study: &Study) -> impl Iterator<Item = String> {
    study.unused().into_iter().map(|name| format!("nothing in the state or the robot depends on {name}"))
}
