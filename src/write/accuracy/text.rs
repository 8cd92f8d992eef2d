//! The results of the accuracy study as text for people.

use super::{Accuracy, Compliant, name_of};
use crate::accuracy::compliant::{GREATEST_FRICTION, NEAR};
use crate::accuracy::{CaseStudy, Factorization, Method, MethodErrors, Spread, Work, quantile};
use crate::write::Palette;
use crate::write::table::{Table, number};
use crate::write::words::{counted, grouped};
use std::fmt::Write;

impl Accuracy {
    /// Returns the results as tables for people.
    pub fn text(&self, palette: &Palette) -> String {
        let mut out = String::new();
        match self.studies.as_slice() {
            [study] => one(&mut out, study, palette),
            studies => many(&mut out, studies, palette),
        }
        if let Some(advice) = &self.advice {
            let _ = writeln!(out, "\n{advice}");
        }
        if let Some(compliant) = &self.compliant {
            compare(&mut out, compliant, palette);
        }
        out
    }
}

/// Writes one case, with a line per method.
fn one(out: &mut String, study: &CaseStudy, Palette { strong, plain, .. }: &Palette) {
    let _ = writeln!(out, "{strong}{}{plain}: {}", study.name, ending(study));
    let _ = writeln!(out, "Condition: {}.\n", conditions(study));
    let methods = &study.methods;
    let error = |pick: fn(&MethodErrors) -> Option<f64>| {
        methods.iter().map(move |method| method.error.as_ref().and_then(pick).map_or("-".into(), digits))
    };
    Table::default()
        .text("method", methods.iter().map(name_of))
        .text("from state to", methods.iter().map(|method| work(method.work)))
        .text("time", methods.iter().map(|method| method.time.map_or("-".into(), span)))
        .text("digits of M", error(|error| error.mass_matrix))
        .text("of G", error(|error| error.delassus))
        .text("of the outcomes", error(|error| error.outcome))
        .write(out);
    out.push_str("  time: median [quartiles]; digits: -log10 of the largest error, free of units\n");
    list_left_out(out, std::slice::from_ref(study));
}

fn work(work: Work) -> &'static str {
    match work {
        Work::Delassus => "G",
        Work::Answer => "verdict",
        Work::Outcome => "outcomes",
    }
}

/// Writes many cases: a line per case, then a line per method.
fn many(out: &mut String, studies: &[CaseStudy], Palette { strong, plain, .. }: &Palette) {
    let columns = [
        ("f32", Factorization::SparseLtl, "f32 LTL"),
        ("f64", Factorization::SparseLtl, "LTL"),
        ("f64", Factorization::DenseCholesky, "Cholesky"),
        ("f64", Factorization::ArticulatedBodies, "artic."),
        ("double-double", Factorization::ArticulatedBodies, "dd artic."),
    ];
    let _ = writeln!(out, "{strong}{} stiff and extreme cases{plain}, digits of G by each method:\n", studies.len());
    let mut table = Table::default()
        .text("case", studies.iter().map(|study| study.name.as_str()))
        .text("verdict", studies.iter().map(brief_ending))
        .text("cond. M", studies.iter().map(|study| power(study.condition.mass_matrix)))
        .text("G", studies.iter().map(|study| power(study.condition.delassus)));
    for (number, factorization, head) in columns {
        let cell = |study: &CaseStudy| {
            let is_asked = |m: &&Method| m.number == number && m.factorization == Some(factorization);
            study.methods.iter().find(is_asked).and_then(|m| m.error?.delassus).map_or("-".into(), digits)
        };
        table = table.text(head, studies.iter().map(cell));
    }
    table.write(out);
    for (study, error) in studies.iter().filter_map(|study| Some((study, study.refused.as_ref()?))) {
        let _ = writeln!(out, "  {}: {error}", study.name);
    }
    let _ = writeln!(out, "\n{strong}By method{plain}, over all cases:\n");
    let every = || studies.iter().flat_map(|study| &study.methods);
    let mut methods: Vec<&Method> = Vec::new();
    for method in every().filter(|method| method.time.is_some()) {
        if !methods.iter().any(|known| name_of(known) == name_of(method) && known.work == method.work) {
            methods.push(method);
        }
    }
    let sorted = |of: &Method, pick: fn(&Method) -> Option<f64>| {
        let alike = every().filter(|other| other.work == of.work && name_of(other) == name_of(of));
        let mut values: Vec<f64> = alike.filter_map(pick).filter(|value| !value.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let times = |method: &&Method| span(Spread::of(sorted(method, |method| Some(method.time?.median))));
    let errors = |method: &&Method, share: f64| {
        let errors = sorted(method, |method| method.error?.delassus);
        if errors.is_empty() { "-".into() } else { digits(quantile(&errors, share)) }
    };
    Table::default()
        .text("method", methods.iter().map(|method| name_of(method)))
        .text("from state to", methods.iter().map(|method| work(method.work)))
        .text("time", methods.iter().map(times))
        .text("digits of G", methods.iter().map(|method| errors(method, 0.5)))
        .text("fewest", methods.iter().map(|method| errors(method, 1.0)))
        .write(out);
    out.push_str("  time: median [quartiles] of the cases; digits: -log10 of the largest error, free of units\n");
    list_left_out(out, studies);
}

fn list_left_out(out: &mut String, studies: &[CaseStudy]) {
    let methods = studies.iter().flat_map(|study| &study.methods);
    for (name, reasons) in grouped(methods.filter_map(|method| Some((name_of(method), method.left_out?)))) {
        let cases = reasons.iter().filter(|reason| **reason == reasons[0]).count();
        let of = if studies.len() > 1 { format!(" of {cases} of these cases") } else { String::new() };
        let _ = writeln!(out, "  {name} is left out{of}: {}", reasons[0]);
    }
}

fn ending(study: &CaseStudy) -> String {
    match (&study.answer, &study.refused) {
        (Some(answer), _) => {
            let proven = if answer.proven { "proven" } else { "not proven" };
            format!("{}, {}, {proven}.", answer.verdict, counted(answer.outcomes, "outcome"))
        }
        (None, Some(error)) => format!("refused: {error}."),
        (None, None) => "no answer.".to_owned(),
    }
}

fn brief_ending(study: &CaseStudy) -> String {
    match (&study.answer, &study.refused) {
        (Some(answer), _) => format!("{}{}", answer.verdict, if answer.proven { "" } else { " (not proven)" }),
        (None, Some(_)) => "refused".to_owned(),
        (None, None) => "-".to_owned(),
    }
}

fn conditions(study: &CaseStudy) -> String {
    let matrices =
        [("mass matrix", study.condition.mass_matrix), ("Delassus matrix", study.condition.delassus)].into_iter();
    let known: Vec<String> = matrices.filter_map(|(of, value)| Some(format!("{of} {}", number(value?)))).collect();
    if known.is_empty() { "not known".into() } else { known.join(", ") }
}

fn power(condition: Option<f64>) -> String {
    condition.map_or("-".into(), |value| if value < 1e3 { format!("{value:.0}") } else { format!("{value:.0e}") })
}

/// Errors below this come from the uncertainty of the reference itself; every other kind of number has larger ones.
const NO_ERROR: f64 = 1e-40;

fn digits(error: f64) -> String {
    match error {
        error if error.is_nan() => "none".to_owned(),
        error if error < NO_ERROR => "all".to_owned(),
        error => format!("{:.1}", (-libm::log10(error)).max(0.0)),
    }
}

fn span(time: Spread) -> String {
    let (factor, unit) = match time.median {
        median if median < 1e-6 => (1e9, "ns"),
        median if median < 1e-3 => (1e6, "µs"),
        median if median < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    let [low, median, high] = [time.lower_quartile, time.median, time.upper_quartile].map(|value| {
        let value = value * factor;
        if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") }
    });
    format!("{median} {unit} [{low}, {high}]")
}

fn compare(out: &mut String, compliant: &Compliant, Palette { strong, plain, .. }: &Palette) {
    let Compliant { name, comparison } = compliant;
    let _ = writeln!(out, "\n{strong}Compliant contact{plain} next to the rigid outcomes of {name}:\n");
    for (at, outcome) in comparison.outcomes.iter().enumerate() {
        let modes: Vec<String> = outcome.modes.iter().map(ToString::to_string).collect();
        let index = outcome.index.map_or("none".into(), |index| format!("{index:+}"));
        let (modes, nearest, near) = (modes.join(", "), outcome.nearest, outcome.near);
        let _ = write!(out, "  {}  {modes} (index {index}): nearest of {nearest} runs, ", at + 1);
        let _ = writeln!(out, "within {} % of {near}", 100.0 * NEAR);
    }
    if comparison.unsettled > 0 {
        let _ = writeln!(out, "  {} runs did not come to an end and count nowhere", comparison.unsettled);
    }
    out.push('\n');
    let groups = &comparison.groups;
    let distance = |part: usize| groups.iter().map(move |group| share(group.distance[part]));
    let value = |value: Option<f64>| value.map_or("infinite".into(), number);
    Table::default()
        .text("parameter", groups.iter().map(|group| group.parameter.unwrap_or("all runs")))
        .text("value", groups.iter().map(|group| group.parameter.map_or(String::new(), |_| value(group.value))))
        .text("runs", groups.iter().map(|group| group.runs.to_string()))
        .text("distance: least", distance(0))
        .text("median", distance(1))
        .text("greatest", distance(2))
        .text("near none", groups.iter().map(|group| share(group.near_none)))
        .write(out);
    out.push('\n');
    let rows = &comparison.tolerances;
    Table::default()
        .text("tolerance", rows.iter().map(|row| format!("{:e}", row.tolerance)))
        .text("steps", rows.iter().map(|row| row.steps.to_string()))
        .text("change", rows.iter().map(|row| share(row.change)))
        .text("distance", rows.iter().map(|row| share(row.distance)))
        .write(out);
    out.push('\n');
    let rows = &comparison.stiffnesses;
    if rows.is_empty() {
        out.push_str("  the moving robot is left out: its loops are closed by impulses alone\n");
    } else {
        Table::default()
            .text("k_n of the moving robot", rows.iter().map(|row| format!("{:e} N/m", row.stiffness)))
            .text("change", rows.iter().map(|row| row.change.map_or("-".into(), share)))
            .text("distance", rows.iter().map(|row| row.distance.map_or("-".into(), share)))
            .write(out);
        if rows.iter().any(|row| row.change.is_none()) {
            out.push_str("  -: the integrator takes too many steps\n");
        }
    }
    let _ = writeln!(
        out,
        "  distance: to the nearest outcome, change: from the finest tolerance, or from the configuration frozen;\n  \
         both in the energy norm, in parts of the speed before. Infinite friction is taken as {GREATEST_FRICTION:e}.\n\n\
         Stiffness changes nothing while the configuration is frozen; damping and the ratios decide where it ends."
    );
}

fn share(part: f64) -> String {
    match part {
        part if part.is_nan() => "-".to_owned(),
        part if part < 1e-9 => "0".to_owned(),
        part if part < 1e-3 => format!("{part:.1e}"),
        part => format!("{part:.3}"),
    }
}
