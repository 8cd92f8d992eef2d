//! Runs every method on a case: errors against the reference, and run times.

use super::computation::{Computation, Factorization};
use super::condition::mass_matrix_condition;
use super::number::Number;
use super::reference::{PRECISION, Reference, distance, relative, with_precision, worst};
use super::suite::CaseSubject;
use super::timing::{Sampling, Spread, time};
use crate::Error;
use crate::impact::enumerate::Tableau;
use crate::impact::{Analysis, AnalysisOptions, ContactProblem, Scratch, Verdict};
use crate::pipeline::assembly::Assembly;
use crate::pipeline::exact::{Contacts, ExactState};
use crate::pipeline::{Options, Pipeline};
use crate::planar::Pair;
use crate::robot::Robot;
use crate::scalar::{DoubleDouble, Interval, Ordered, Real};
use crate::state::State;
use serde::{Serialize, Serializer};
use std::cell::RefCell;

/// Why articulated bodies are left out.
const NOT_ARTICULATED: &str = "mimic joints and loops need M";
/// Why dense factorization is left out.
const NOT_DENSE: &str = "loops are eliminated by the sparse factorization";
/// The greatest number of coordinates for which double-doubles factorize M.
const LONGEST_FACTORIZED: usize = 300;
/// Why double-doubles leave out the factorization.
const TOO_LONG: &str = "with more than 300 coordinates it takes seconds";

/// One case, computed by every method.
#[derive(Debug, Clone, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CaseStudy {
    /// The name of the case.
    pub name: String,
    /// Coordinates of the robot; `None` for a problem given as matrices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<usize>,
    /// Closed contacts.
    pub contacts: usize,
    /// The answer; `None` if the case was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answer: Option<AnswerSummary>,
    /// Why the case was refused.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_text")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<String>"))]
    pub refused: Option<Error>,
    /// Condition numbers, by which rounding errors grow.
    pub condition: ConditionNumbers,
    /// The results of each method; empty for a refused case.
    pub methods: Vec<Method>,
}

/// The answer in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AnswerSummary {
    /// The verdict.
    pub verdict: Verdict,
    /// Number of outcomes.
    pub outcomes: usize,
    /// Whether every sign is shown.
    pub proven: bool,
    /// The smallest margin of an outcome.
    pub margin: Option<f64>,
    /// Sum of indices.
    pub index_sum: Option<i32>,
    /// Rank of G.
    pub rank: Option<usize>,
}

fn as_text<S: Serializer>(refused: &Option<Error>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&refused.as_ref().map(ToString::to_string).unwrap_or_default())
}

/// Condition numbers of matrices scaled to a unit diagonal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ConditionNumbers {
    /// Of M; `None` without a robot.
    pub mass_matrix: Option<f64>,
    /// Of G; `None` if it is singular or not known.
    pub delassus: Option<f64>,
}

/// A method to compute G or the whole answer.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Method {
    /// The kind of number.
    pub number: &'static str,
    /// How G is found; `None` for the whole answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factorization: Option<Factorization>,
    /// What is timed.
    pub work: Work,
    /// Run time; `None` if it was not measured.
    pub time: Option<Spread>,
    /// The distance from the reference; `None` if the method failed.
    pub error: Option<MethodErrors>,
    /// Why the method was not tried, if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<&'static str>,
}

/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Work {
    /// From the f64 state to G.
    Delassus,
    /// From the f64 state, or from given matrices, to the verdict.
    Answer,
    /// From given matrices to the impulses and velocities of the outcomes.
    Outcome,
}

/// Largest errors against the reference, free of units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MethodErrors {
    /// Of M; `None` if the method has none.
    pub mass_matrix: Option<f64>,
    /// Of G; `None` if it was given.
    pub delassus: Option<f64>,
    /// Of the outcomes' impulses and velocities; `None` if there is no outcome, or none that is unique.
    pub outcome: Option<f64>,
}

/// Studies a case of the suite.
pub fn study(name: &str, subject: &CaseSubject, options: &Options, sampling: Sampling) -> CaseStudy {
    match subject {
        CaseSubject::State(case) => of_state(name, &case.0, &case.1, options, sampling),
        CaseSubject::Problem(problem) => of_problem(name, problem, !options.no_proof, sampling),
    }
}

/// Studies a robot's state.
pub fn of_state(name: &str, robot: &Robot, state: &State, options: &Options, sampling: Sampling) -> CaseStudy {
    let coordinates = Some(robot.dofs());
    let mut study = CaseStudy { name: name.to_owned(), coordinates, ..CaseStudy::default() };
    let mut pipeline = Pipeline::new(robot, options.clone());
    let found = pipeline.impact(state).and_then(|impact| Ok((impact, pipeline.prepare(state)?)));
    let (impact, prepared) = match found {
        Ok(found) => found,
        Err(error) => return CaseStudy { refused: Some(error), ..study },
    };
    let exact = pipeline.exact(state, &prepared);
    study.contacts = impact.contacts.len();
    let analysis = impact.analyzed().map_err(|error| study.refused = Some(error)).ok();
    analysis.into_iter().for_each(|analysis| study.answered(analysis));
    with_precision(robot, || {
        let (problem, mut reference) = (&impact.problem, None);
        let time = time(Sampling { samples: 5, ..sampling }, || reference = Some(Reference::new(&exact)));
        let Some(reference) = reference else { return };
        let bench = Bench { state: &exact, problem, reference, analysis, sampling, methods: Vec::new() };
        (study.condition.mass_matrix, study.methods) = bench.every_method(time);
    });
    study.methods.extend(answers(!options.no_proof, |proves| {
        let mut pipeline = Pipeline::new(robot, Options { no_proof: !proves, ..options.clone() });
        time(sampling, || pipeline.impact(state))
    }));
    study
}

/// Times the whole answer without its proof and, with `prove`, with it.
fn answers(prove: bool, mut timed: impl FnMut(bool) -> Spread) -> Vec<Method> {
    let ways = [("f64", false), ("f64 with proof", true)].into_iter().filter(|(_, proves)| prove || !proves);
    ways.map(|(number, proves)| Method::new(number, Work::Answer, Some(timed(proves)))).collect()
}

/// Studies a contact problem given as matrices, which are taken as exact.
pub fn of_problem(name: &str, problem: &ContactProblem, prove: bool, sampling: Sampling) -> CaseStudy {
    let contacts = problem.contacts();
    let mut study = CaseStudy { name: name.to_owned(), contacts, ..CaseStudy::default() };
    let mut scratch = Scratch::default();
    let mut analyze =
        |prove| scratch.analyze(problem, problem, AnalysisOptions { prove, ..AnalysisOptions::default() });
    let analysis = match analyze(prove) {
        Ok(analysis) => analysis,
        Err(error) => return CaseStudy { refused: Some(error), ..study },
    };
    study.answered(&analysis);
    Interval::scope(PRECISION, || {
        let exact = problem.map(Interval::from_f64);
        let mut row = |number, outcome| {
            let error = Some(MethodErrors { mass_matrix: None, delassus: None, outcome });
            study.methods.push(Method { error, ..Method::new(number, Work::Outcome, None) });
        };
        row("f32", outcome_error(&analysis, &problem.map(f32::from_f64), &exact));
        row("f64", outcome_error(&analysis, problem, &exact));
        row("double-double", outcome_error(&analysis, &problem.map(DoubleDouble::from_f64), &exact));
    });
    study.methods.extend(answers(prove, |proves| time(sampling, || analyze(proves))));
    study
}

impl CaseStudy {
    fn answered(&mut self, analysis: &Analysis) {
        let margins = analysis.outcomes.iter().filter_map(|outcome| outcome.margin);
        self.answer = Some(AnswerSummary {
            verdict: analysis.verdict,
            outcomes: analysis.outcomes.len(),
            proven: analysis.proven,
            margin: margins.min_by(f64::total_cmp),
            index_sum: analysis.index_sum,
            rank: analysis.rank,
        });
        self.condition.delassus = analysis.condition;
    }
}

impl Method {
    fn new(number: &'static str, work: Work, time: Option<Spread>) -> Self {
        Self { number, factorization: None, work, time, error: None, left_out: None }
    }

    fn delassus(number: &'static str, factorization: Factorization, time: Option<Spread>) -> Self {
        Self { factorization: Some(factorization), ..Self::new(number, Work::Delassus, time) }
    }
}

/// A state on which the methods run one after the other, with their results.
struct Bench<'a> {
    state: &'a ExactState<'a>,
    problem: &'a ContactProblem,
    reference: Reference<'a>,
    analysis: Option<&'a Analysis>,
    sampling: Sampling,
    methods: Vec<Method>,
}

impl<'a> Bench<'a> {
    /// Runs every method, and returns the condition number of M and the results; `time` is the run time of the
    /// reference.
    fn every_method(mut self, time: Spread) -> (Option<f64>, Vec<Method>) {
        use Factorization::{ArticulatedBodies, DenseCholesky, SparseLtl};
        self.method::<f32>("f32", SparseLtl, Computation::by_ltl);
        self.method::<f32>("f32", ArticulatedBodies, Computation::by_articulated_bodies);
        let factorized = self.method::<f64>("f64", SparseLtl, Computation::by_ltl);
        let condition = |Computation { assembly: Assembly { plan, workspace, .. }, .. }: Computation<f64>| {
            mass_matrix_condition(&plan, &workspace)
        };
        let condition = factorized.map(condition);
        self.method::<f64>("f64", DenseCholesky, Computation::by_dense_cholesky);
        self.method::<f64>("f64", ArticulatedBodies, Computation::by_articulated_bodies);
        self.method::<DoubleDouble>("double-double", SparseLtl, Computation::by_ltl);
        self.method::<DoubleDouble>("double-double", ArticulatedBodies, Computation::by_articulated_bodies);
        let error = MethodErrors { mass_matrix: None, delassus: Some(self.reference.own_error()), outcome: None };
        let method = Method::delassus("reference", self.reference.factorization, Some(time));
        self.methods.push(Method { error: Some(error), ..method });
        (condition, self.methods)
    }

    /// Runs one method; `delassus` computes G, or returns false if it cannot. Returns the computation of G; `None` if
    /// there is none.
    fn method<T: Number>(
        &mut self,
        number: &'static str,
        factorization: Factorization,
        delassus: fn(&mut Computation<'a, T>) -> bool,
    ) -> Option<Computation<'a, T>> {
        let mut computation = Computation::<T>::new(self.state);
        let assembly = &computation.assembly;
        let left_out = match factorization {
            Factorization::ArticulatedBodies => (!assembly.has_articulated_bodies()).then_some(NOT_ARTICULATED),
            Factorization::DenseCholesky => assembly.is_constrained().then_some(NOT_DENSE),
            Factorization::SparseLtl => {
                let is_long = number == "double-double" && self.state.position.len() > LONGEST_FACTORIZED;
                is_long.then_some(TOO_LONG)
            }
        };
        if left_out.is_some() {
            self.methods.push(Method { left_out, ..Method::delassus(number, factorization, None) });
            return None;
        }
        let mut succeeds = true;
        let spread = time(self.sampling, || {
            computation.place();
            succeeds &= delassus(&mut computation);
        });
        let error = succeeds.then(|| self.errors(number, factorization, &mut computation));
        self.methods.push(Method { error, ..Method::delassus(number, factorization, Some(spread)) });
        error.map(|_| computation)
    }

    fn errors<T: Number>(&self, number: &str, by: Factorization, computation: &mut Computation<T>) -> MethodErrors {
        let workspace = &computation.assembly.workspace;
        let delassus = Some(self.reference.delassus_error(&workspace.delassus));
        let mass_matrix = match by {
            Factorization::ArticulatedBodies => {
                computation.velocities();
                None
            }
            Factorization::SparseLtl => Some(self.reference.mass_matrix_error(&workspace.mass_matrix)),
            // Dense Cholesky factorizes the same M.
            Factorization::DenseCholesky => {
                self.methods.iter().find(|method| method.number == number).and_then(|method| method.error?.mass_matrix)
            }
        };
        let outcome = self.analysis.and_then(|analysis| {
            let problem = filled(self.problem, &computation.collect());
            outcome_error(analysis, &problem, &filled(self.problem, &self.reference.contacts))
        });
        MethodErrors { mass_matrix, delassus, outcome }
    }
}

/// Returns the problem `shape` with its numbers replaced by `contacts`.
fn filled<T: Real>(shape: &ContactProblem, contacts: &Contacts<T>) -> ContactProblem<T> {
    let Contacts { delassus, before, free } = contacts;
    // `map` visits G by rows, c without and with applied impulses, and the normal velocities of approaching contacts.
    let approach = |(c, given): (&Pair<T>, &Pair<f64>)| if given[1] < 0.0 { c[1] } else { T::zero() };
    let approach: Vec<T> = before.iter().zip(shape.velocity_before()).map(approach).collect();
    let numbers =
        RefCell::new(delassus.iter().chain(before.iter().flatten()).chain(free.iter().flatten()).chain(&approach));
    shape.map(|zero| numbers.borrow_mut().next().copied().unwrap_or(T::from_f64(zero)))
}

/// Returns the largest error of impulses and velocities that follow from the modes of outcomes with unique impulses,
/// free of units; `None` if no outcome can be compared.
fn outcome_error<T: Number>(
    analysis: &Analysis,
    problem: &ContactProblem<T>,
    exact: &ContactProblem<Interval>,
) -> Option<f64> {
    let contacts = problem.contacts();
    let size = |row: usize| exact.delassus(row, row).to_f64().sqrt();
    let speeds = (0..2 * contacts).map(|row| exact.velocity_free()[row / 2][row % 2].to_f64().abs() / size(row));
    let scale = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let (mut tableau, mut reference) = (Tableau::<T>::default(), Tableau::<Interval>::default());
    tableau.load(problem);
    reference.load(exact);
    let mut errors = Vec::new();
    for outcome in analysis.outcomes.iter().filter(|outcome| outcome.decided && outcome.impulse_unique) {
        let (found, truth) = (tableau.leaf(&outcome.modes), reference.leaf(&outcome.modes));
        let known = |vector: Pair<Interval>| vector.iter().all(|entry| entry.error().is_finite());
        if !(0..contacts).all(|contact| known(truth.impulse(contact)) && known(truth.velocity(contact))) {
            continue;
        }
        for (contact, axis) in (0..contacts).flat_map(|contact| [(contact, 0), (contact, 1)]) {
            let size = size(2 * contact + axis);
            let impulse = distance(found.impulse(contact)[axis], truth.impulse(contact)[axis]);
            let velocity = distance(found.velocity(contact)[axis], truth.velocity(contact)[axis]);
            errors.extend([relative(impulse * size, scale), relative(velocity, size * scale)]);
        }
    }
    (!errors.is_empty()).then(|| worst(errors))
}
