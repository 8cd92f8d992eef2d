//! The results of the accuracy study: error against run time.
//!
//! ```text
//!     CaseStudy, Comparison --> Accuracy --> JSON (its own fields), advice, text.rs, picture.rs
//! for each way to compute G:  time t = median over the cases,  digits d = the fewest of any case
//! f64: the fastest way and the most exact; f32, double-double: the fastest; the proof: t with it / t without it
//! ```

mod text;

use crate::accuracy::compliant::Comparison;
use crate::accuracy::{CaseStudy, Factorization, Method, Work, quantile};
use serde::Serialize;

/// The results of every method on some cases.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Accuracy {
    /// The cases.
    pub studies: Vec<CaseStudy>,
    /// Compliant contact next to the rigid outcomes of one state.
    pub compliant: Option<Compliant>,
    /// Which method to use, by the times and errors of these cases; `None` if nothing was measured.
    pub advice: Option<String>,
}

/// Compliant contact, and the state that it was tried on.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compliant {
    /// The name of the state.
    pub name: String,
    /// The results.
    #[serde(flatten)]
    pub comparison: Comparison,
}

impl Accuracy {
    /// Creates the record, with the advice that follows from it.
    pub fn new(studies: Vec<CaseStudy>, compliant: Option<Compliant>) -> Self {
        Self { advice: advice(&studies), studies, compliant }
    }
}

pub(crate) fn name_of(method: &Method) -> String {
    match method.factorization {
        Some(factorization) => format!("{}, {}", method.number, in_words(factorization)),
        None => method.number.to_owned(),
    }
}

fn in_words(factorization: Factorization) -> &'static str {
    match factorization {
        Factorization::SparseLtl => "sparse LTL",
        Factorization::DenseCholesky => "dense Cholesky",
        Factorization::ArticulatedBodies => "articulated bodies",
    }
}

/// Methods in f64 whose digits differ by less than this count as equally exact, because the last bits are random.
const SAME_DIGITS: f64 = 0.5;

#[derive(Debug, Clone, Copy)]
struct Way {
    factorization: Factorization,
    time: f64,
    digits: f64,
}

/// Returns the advice in one sentence; `None` if no way to compute G in f64 was measured.
fn advice(studies: &[CaseStudy]) -> Option<String> {
    let ways = ways(studies, "f64");
    let quickest = quickest(&ways)?;
    let most_exact = *ways.iter().max_by(|a, b| a.digits.total_cmp(&b.digits))?;
    let least = if studies.len() > 1 { "at least " } else { "" };
    let keeps = |way: Way| format!("{least}{:.1} digits", way.digits);
    let [(exact, much), (quick, few)] = [most_exact, quickest].map(|way| (in_words(way.factorization), keeps(way)));
    let mut parts = vec![if most_exact.digits - quickest.digits < SAME_DIGITS {
        let also = if ways.len() > 1 { ", the quickest way in f64, and none there keeps more" } else { "" };
        format!("For G take f64 by {quick} ({few}){also}")
    } else {
        let slower = times(most_exact.time / quickest.time);
        let than = format!("at {slower} times the time of {quick}, the quickest way in f64, which keeps {few}");
        format!("For G take f64 by {exact}, which keeps {much} {than}")
    }];
    for (number, than) in [("f32", "the time of the quickest"), ("double-double", "that")] {
        let Some(way) = self::quickest(&self::ways(studies, number)) else { continue };
        parts.push(format!("{number} takes {} times {than} and keeps {}", times(way.time / quickest.time), keeps(way)));
    }
    parts.extend(of_the_proof(studies));
    Some(parts.join("; ") + ".")
}

fn quickest(ways: &[Way]) -> Option<Way> {
    ways.iter().copied().min_by(|a, b| a.time.total_cmp(&b.time))
}

/// Returns every way to compute G that failed in no case with contacts. It keeps no more digits than the numbers have.
fn ways(studies: &[CaseStudy], number: &str) -> Vec<Way> {
    let most = match number {
        "f32" => f64::from(f32::MANTISSA_DIGITS),
        "f64" => f64::from(f64::MANTISSA_DIGITS),
        _ => 2.0 * f64::from(f64::MANTISSA_DIGITS),
    } * std::f64::consts::LOG10_2;

    let all = [Factorization::SparseLtl, Factorization::DenseCholesky, Factorization::ArticulatedBodies];
    let way = |factorization| {
        let every = studies.iter().filter(|study| study.contacts > 0).flat_map(|study| &study.methods);
        let is_asked = |method: &&Method| method.number == number && method.factorization == Some(factorization);
        let measured =
            |method: &Method| Some((method.time?.median, method.error?.delassus.filter(|error| !error.is_nan())?));
        let (times, errors): (Vec<f64>, Vec<f64>) = every.filter(is_asked).map(measured).collect::<Option<_>>()?;
        let digits = -libm::log10(errors.into_iter().reduce(f64::max)?);
        Some(Way { factorization, time: median(times)?, digits: digits.clamp(0.0, most) })
    };
    all.into_iter().filter_map(way).collect()
}

/// Describes the cost of the proof, and how often it succeeds.
fn of_the_proof(studies: &[CaseStudy]) -> Option<String> {
    let time = |study: &CaseStudy, number| {
        let mut methods = study.methods.iter();
        let method = methods.find(|method| method.work == Work::Answer && method.number == number)?;
        method.time.map(|time| time.median)
    };
    let ratio = |study: &CaseStudy| Some(time(study, "f64 with proof")? / time(study, "f64")?);
    let cost = times(median(studies.iter().filter_map(ratio).collect())?);
    let answers = || studies.iter().filter_map(|study| study.answer.as_ref());
    let success = match (answers().filter(|answer| answer.proven).count(), answers().count()) {
        (0, _) => " and does not succeed here".to_owned(),
        (1, 1) => ", and succeeds".to_owned(),
        (proven, all) => format!(", and proves {proven} of {all} answers"),
    };
    Some(format!("the proof takes {cost} times the time of the answer without it{success}"))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    (!values.is_empty()).then(|| quantile(&values, 0.5))
}

/// A ratio in two digits.
fn times(ratio: f64) -> String {
    if ratio < 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{AnswerSummary, ConditionNumbers, MethodErrors, Spread};
    use crate::impact::Verdict;

    fn method(number: &'static str, factorization: Option<Factorization>, time: f64, error: f64) -> Method {
        let work = if factorization.is_some() { Work::Delassus } else { Work::Answer };
        let time = Some(Spread { lower_quartile: time, median: time, upper_quartile: time, samples: 1 });
        let error = factorization.map(|_| MethodErrors { mass_matrix: None, delassus: Some(error), outcome: None });
        Method { number, factorization, work, time, error, left_out: None }
    }

    fn study(proven: bool, methods: Vec<Method>) -> CaseStudy {
        let verdict = Verdict::Unique;
        let answer =
            Some(AnswerSummary { verdict, outcomes: 1, proven, margin: None, index_sum: Some(1), rank: Some(2) });
        let (name, condition) = (String::new(), ConditionNumbers::default());
        CaseStudy { name, coordinates: None, contacts: 1, answer, refused: None, condition, methods }
    }

    const LTL: Option<Factorization> = Some(Factorization::SparseLtl);
    const BODIES: Option<Factorization> = Some(Factorization::ArticulatedBodies);

    #[test]
    fn quickest_with_as_many_digits_is_recommended() {
        let methods = |digits: i32| {
            vec![
                method("f32", LTL, 1e-6, 1e-5),
                method("f64", LTL, 2e-6, 10f64.powi(-digits)),
                method("f64", BODIES, 1e-6, 1e-14),
                method("double-double", BODIES, 2e-5, 1e-29),
                method("f64", None, 2e-6, 0.0),
                method("f64 with proof", None, 3e-6, 0.0),
            ]
        };
        assert_eq!(
            advice(&[study(true, methods(13)), study(false, methods(9))]).unwrap(),
            "For G take f64 by articulated bodies (at least 14.0 digits), the quickest way in f64, and none there keeps more; f32 takes \
             1.0 times the time of the quickest and keeps at least 5.0 digits; double-double takes 20 times that and keeps \
             at least 29.0 digits; the proof takes 1.5 times the time of the answer without it, and proves 1 of 2 answers."
        );
    }

    #[test]
    fn digits_are_weighed_and_failed_ways_left_out() {
        let methods = vec![method("f64", LTL, 1e-6, 1e-9), method("f64", BODIES, 3e-6, 1e-14)];
        assert_eq!(
            advice(&[study(true, methods)]).unwrap(),
            "For G take f64 by articulated bodies, which keeps 14.0 digits at 3.0 times the time of sparse LTL, the quickest \
             way in f64, which keeps 9.0 digits."
        );
        let failing = Method { error: None, ..method("f64", LTL, 1e-9, 0.0) };
        let found = advice(&[study(true, vec![failing, method("f64", BODIES, 1e-6, 1e-14)])]).unwrap();
        assert_eq!(found, "For G take f64 by articulated bodies (14.0 digits).");
        assert_eq!(advice(&[study(true, Vec::new())]), None);
        // Whole numbers lose no digit, whatever the method; without a contact there is no G.
        let exact = || vec![method("f64", LTL, 1e-6, 1e-97), method("f64", BODIES, 3e-6, 1e-17)];
        let found = advice(&[study(true, exact())]).unwrap();
        assert!(found.starts_with("For G take f64 by sparse LTL (16.0 digits), the quickest way"), "{found}");
        assert_eq!(advice(&[CaseStudy { contacts: 0, ..study(true, exact()) }]), None);
    }
}
