//! Which method to use, by the measured times and errors.
//!
//! ```text
//!     of each way to G:  time t = median over the cases,  digits d = the fewest of a case
//!     f64: the quickest and the one with most digits; f32, double-double: the quickest; the proof: t with / t without
//! ```

use super::in_words;
use crate::accuracy::{CaseStudy, Factorization, Method, Work};

/// Ways in f64 whose digits differ by less count as equal: the last bits are chance.
const SAME_DIGITS: f64 = 0.5;

/// A way to G over all cases.
#[derive(Debug, Clone, Copy)]
struct Way {
    factorization: Factorization,
    time: f64,
    digits: f64,
}

/// One sentence; `None` if no way to G in f64 was measured.
pub(super) fn advice(studies: &[CaseStudy]) -> Option<String> {
    let ways = ways(studies, "f64");
    let quickest = quickest(&ways)?;
    let most_exact = *ways.iter().max_by(|a, b| a.digits.total_cmp(&b.digits))?;
    let least = if studies.len() > 1 { "at least " } else { "" };
    let keeps = |way: Way| format!("{least}{:.1} digits", way.digits);
    let named = |way: Way| in_words(way.factorization);
    let mut parts = vec![if most_exact.digits - quickest.digits < SAME_DIGITS {
        let also = if ways.len() > 1 { ", the quickest way, and none keeps more" } else { "" };
        format!("for G take f64 by {} ({}){also}", named(quickest), keeps(quickest))
    } else {
        let slower = times(most_exact.time / quickest.time);
        format!(
            "for G take f64 by {}, which keeps {} at {slower} times the time of {}, the quickest way, which keeps {}",
            named(most_exact),
            keeps(most_exact),
            named(quickest),
            keeps(quickest),
        )
    }];
    if let Some(short) = self::quickest(&self::ways(studies, "f32")) {
        let part = times(short.time / quickest.time);
        parts.push(format!("f32 takes {part} times the time of the quickest and keeps {}", keeps(short)));
    }
    if let Some(long) = self::quickest(&self::ways(studies, "double-double")) {
        let part = times(long.time / quickest.time);
        parts.push(format!("double-double takes {part} times that and keeps {}", keeps(long)));
    }
    parts.extend(of_the_proof(studies));
    let mut sentence = parts.join("; ");
    sentence.replace_range(..1, "F");
    sentence.push('.');
    Some(sentence)
}

fn quickest(ways: &[Way]) -> Option<Way> {
    ways.iter().copied().min_by(|a, b| a.time.total_cmp(&b.time))
}

/// Every way to G in numbers of one kind that failed in none of its cases.
fn ways(studies: &[CaseStudy], number: &str) -> Vec<Way> {
    let all = [Factorization::SparseLtl, Factorization::DenseCholesky, Factorization::ArticulatedBodies];
    let way = |factorization| {
        let methods: Vec<&Method> = studies
            .iter()
            .flat_map(|study| &study.methods)
            .filter(|method| method.number == number && method.factorization == Some(factorization))
            .collect();
        let errors: Option<Vec<f64>> =
            methods.iter().map(|method| method.error?.delassus.filter(|error| !error.is_nan())).collect();
        let times: Option<Vec<f64>> = methods.iter().map(|method| method.time.map(|time| time.median)).collect();
        let digits = -libm::log10(errors?.into_iter().reduce(f64::max)?);
        Some(Way { factorization, time: median(times?)?, digits: digits.max(0.0) })
    };
    all.into_iter().filter_map(way).collect()
}

/// The cost of the proof, and how often it succeeds.
fn of_the_proof(studies: &[CaseStudy]) -> Option<String> {
    let time = |study: &CaseStudy, number| {
        let mut methods = study.methods.iter();
        let method = methods.find(|method| method.work == Work::Answer && method.number == number)?;
        method.time.map(|time| time.median)
    };
    let ratios: Vec<f64> =
        studies.iter().filter_map(|study| Some(time(study, "f64 with proof")? / time(study, "f64")?)).collect();
    let answers: Vec<bool> =
        studies.iter().filter_map(|study| study.answer.as_ref()).map(|answer| answer.proven).collect();
    let cost = times(median(ratios)?);
    let (proven, all) = (answers.iter().filter(|&&proven| proven).count(), answers.len());
    Some(match (proven, all) {
        (0, _) => format!("the proof takes {cost} times the time of the answer without it and does not succeed here"),
        (1, 1) => format!("the proof takes {cost} times the time of the answer without it, and succeeds"),
        _ => format!(
            "the proof takes {cost} times the time of the answer without it, and proves {proven} of {all} answers"
        ),
    })
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied()
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
        let answer = AnswerSummary { verdict, outcomes: 1, proven, margin: None, index_sum: Some(1), rank: 2 };
        CaseStudy {
            name: String::new(),
            coordinates: None,
            contacts: 1,
            answer: Some(answer),
            refused: None,
            condition: ConditionNumbers::default(),
            methods,
        }
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
            "For G take f64 by articulated bodies (at least 14.0 digits), the quickest way, and none keeps more; f32 takes \
             1.0 times the time of the quickest and keeps at least 5.0 digits; double-double takes 20 times that and keeps \
             at least 29.0 digits; the proof takes 1.5 times the time of the answer without it, and proves 1 of 2 answers."
        );
    }

    #[test]
    fn digits_are_weighed_against_time() {
        let methods = vec![method("f64", LTL, 1e-6, 1e-9), method("f64", BODIES, 3e-6, 1e-14)];
        assert_eq!(
            advice(&[study(true, methods)]).unwrap(),
            "For G take f64 by articulated bodies, which keeps 14.0 digits at 3.0 times the time of sparse LTL, the quickest \
             way, which keeps 9.0 digits."
        );
    }

    #[test]
    fn failed_ways_are_not_recommended() {
        let failing = Method { error: None, ..method("f64", LTL, 1e-9, 0.0) };
        let found = advice(&[study(true, vec![failing, method("f64", BODIES, 1e-6, 1e-14)])]).unwrap();
        assert_eq!(found, "For G take f64 by articulated bodies (14.0 digits).");
        assert_eq!(advice(&[study(true, Vec::new())]), None);
    }
}
