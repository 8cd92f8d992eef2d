//! Runs every method on a case: error against the reference, and run time.

use super::condition::mass_matrix_condition;
use super::number::Number;
use super::pose::{Computation, Factorization, Pose};
use super::reference::{PRECISION, Reference, distance, relative, with_precision, worst};
use super::suite::Subject;
use super::timing::{Budget, Spread, time};
use crate::impact::enumerate::Tableau;
use crate::impact::{Analysis, AnalysisOptions, ContactProblem, Scratch, Verdict};
use crate::pipeline::{Options, Pipeline};
use crate::planar::Pair;
use crate::robot::Robot;
use crate::scalar::{DoubleDouble, Interval, Ordered, Real};
use crate::state::State;
use crate::{Error, Reason};
use serde::{Serialize, Serializer};
use std::cell::RefCell;

/// With more coordinates double-doubles do not factorize M.
const LONGEST_FACTORIZED: usize = 300;
/// Why.
const TOO_LONG: &str = "with more than 300 coordinates it takes seconds";

/// One case, computed by every method.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Study {
    /// What the case is called.
    pub name: String,
    /// Coordinates of the robot; `None` for a problem given as matrices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<usize>,
    /// Closed contacts.
    pub contacts: usize,
    /// The answer; `None` if the case was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answer: Option<Answer>,
    /// Why the case was refused.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_text")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<String>"))]
    pub refused: Option<Error>,
    /// How much rounding grows.
    pub condition: Condition,
    /// The results of each method; empty for a refused case.
    pub methods: Vec<Method>,
}

/// The answer in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Answer {
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
    pub rank: usize,
}

fn as_text<S: Serializer>(refused: &Option<Error>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&refused.as_ref().map(ToString::to_string).unwrap_or_default())
}

/// Condition numbers of matrices scaled to a unit diagonal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Condition {
    /// Of M; `None` without a robot.
    pub mass_matrix: Option<f64>,
    /// Of G; `None` if it is singular or not known.
    pub delassus: Option<f64>,
}

/// One way to G, or to the whole answer.
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
    pub error: Option<Errors>,
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

/// Largest errors, free of units (see [`Reference`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Errors {
    /// Of M; `None` if the method has none.
    pub mass_matrix: Option<f64>,
    /// Of G; `None` if it was given.
    pub delassus: Option<f64>,
    /// Of the outcomes' impulses and velocities; `None` if there is no outcome, or none that is unique.
    pub outcome: Option<f64>,
}

/// Studies a case of the suite.
pub fn study(name: &str, subject: &Subject, options: &Options, budget: Budget) -> Study {
    match subject {
        Subject::State(case) => of_state(name, &case.0, &case.1, options, budget),
        Subject::Problem(problem) => of_problem(name, problem, !options.no_proof, budget),
    }
}

/// Studies a robot's state.
pub fn of_state(name: &str, robot: &Robot, state: &State, options: &Options, budget: Budget) -> Study {
    let mut study = Study::of(name, Some(robot.dofs()));
    if !robot.mimic_joints.is_empty() || !state.scene.loops.is_empty() {
        let reason = Reason::Unsupported("the methods compared here know neither loops nor mimic joints".into());
        return study.refuse(
            Error::new(reason).hint("leave the loops out; remove <mimic> to let a joint move freely, or make it fixed"),
        );
    }
    let mut pipeline = Pipeline::new(robot, options.clone());
    let impact = match pipeline.impact(state) {
        Ok(impact) => impact,
        Err(error) => return study.refuse(error),
    };
    let pose = Pose::new(robot, state, &impact);
    study.contacts = impact.contacts.len();
    let analysis = match impact.analysed() {
        Ok(analysis) => study.answered(analysis),
        Err(error) => {
            study = study.refuse(error);
            None
        }
    };
    with_precision(robot, || {
        let mut bench = Bench { pose: &pose, reference: Reference::new(&pose), analysis, budget, methods: Vec::new() };
        let computation = pose.computed();
        study.condition.mass_matrix = Some(mass_matrix_condition(computation.plan(), computation.workspace()));
        bench.every_method();
        study.methods = bench.methods;
    });
    for (number, proves) in answers(!options.no_proof) {
        let mut pipeline = Pipeline::new(robot, Options { no_proof: !proves, ..options.clone() });
        let whole = time(budget, || {
            std::hint::black_box(&pipeline.impact(state));
        });
        study.methods.push(Method::new(number, Work::Answer, Some(whole)));
    }
    study
}

/// The ways to the whole answer, and whether they prove it.
fn answers(prove: bool) -> impl Iterator<Item = (&'static str, bool)> {
    [("f64", false), ("f64 with proof", true)].into_iter().filter(move |(_, proves)| prove || !proves)
}

/// Studies a contact problem given as matrices, which are taken as exact.
pub fn of_problem(name: &str, problem: &ContactProblem, prove: bool, budget: Budget) -> Study {
    let mut study = Study::of(name, None);
    study.contacts = problem.contacts();
    let mut scratch = Scratch::default();
    let mut analyse =
        |prove| scratch.analyse(problem, problem, AnalysisOptions { prove, ..AnalysisOptions::default() });
    let analysis = match analyse(prove) {
        Ok(analysis) => analysis,
        Err(error) => return study.refuse(error),
    };
    study.answered(&analysis);
    Interval::scope(PRECISION, || {
        let exact = problem.map(Interval::from_f64);
        let mut row = |number, outcome| {
            let error = Some(Errors { mass_matrix: None, delassus: None, outcome });
            study.methods.push(Method { error, ..Method::new(number, Work::Outcome, None) });
        };
        row("f32", outcome_error(&analysis, &problem.map(f32::from_f64), &exact));
        row("f64", outcome_error(&analysis, problem, &exact));
        row("double-double", outcome_error(&analysis, &problem.map(DoubleDouble::from_f64), &exact));
    });
    for (number, proves) in answers(prove) {
        let whole = time(budget, || {
            std::hint::black_box(&analyse(proves));
        });
        study.methods.push(Method::new(number, Work::Answer, Some(whole)));
    }
    study
}

impl Study {
    fn of(name: &str, coordinates: Option<usize>) -> Self {
        Self {
            name: name.to_owned(),
            coordinates,
            contacts: 0,
            answer: None,
            refused: None,
            condition: Condition::default(),
            methods: Vec::new(),
        }
    }

    fn refuse(self, error: Error) -> Self {
        Self { refused: Some(error), ..self }
    }

    fn answered<'a>(&mut self, analysis: &'a Analysis) -> Option<&'a Analysis> {
        let margins = analysis.outcomes.iter().filter_map(|outcome| outcome.margin);
        self.answer = Some(Answer {
            verdict: analysis.verdict,
            outcomes: analysis.outcomes.len(),
            proven: analysis.proven,
            margin: margins.min_by(f64::total_cmp),
            index_sum: analysis.index_sum,
            rank: analysis.rank,
        });
        self.condition.delassus = analysis.condition;
        Some(analysis)
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

/// A pose on which one method after the other is run.
struct Bench<'a> {
    pose: &'a Pose<'a>,
    reference: Reference,
    analysis: Option<&'a Analysis>,
    budget: Budget,
    methods: Vec<Method>,
}

impl Bench<'_> {
    fn every_method(&mut self) {
        use Factorization::{ArticulatedBodies, SparseLtl};
        self.method::<f32>("f32", SparseLtl);
        self.method::<f32>("f32", ArticulatedBodies);
        self.method::<f64>("f64", SparseLtl);
        self.dense_cholesky();
        self.method::<f64>("f64", ArticulatedBodies);
        if self.pose.robot.dofs() <= LONGEST_FACTORIZED {
            self.method::<DoubleDouble>("double-double", SparseLtl);
        } else {
            let method = Method::delassus("double-double", SparseLtl, None);
            self.methods.push(Method { left_out: Some(TOO_LONG), ..method });
        }
        self.method::<DoubleDouble>("double-double", ArticulatedBodies);
        let reference = time(Budget { samples: 5, ..self.budget }, || {
            with_precision(self.pose.robot, || {
                std::hint::black_box(&Reference::new(self.pose));
            })
        });
        let error = Errors { mass_matrix: None, delassus: Some(self.reference.own_error()), outcome: None };
        let method = Method::delassus("reference", ArticulatedBodies, Some(reference));
        self.methods.push(Method { error: Some(error), ..method });
    }

    fn method<T: Number>(&mut self, number: &'static str, factorization: Factorization) {
        let mut computation = Computation::<T>::new(self.pose);
        let spread = time(self.budget, || {
            computation.place(self.pose);
            match factorization {
                Factorization::ArticulatedBodies => computation.by_articulated_bodies(),
                Factorization::SparseLtl | Factorization::DenseCholesky => computation.by_ltl(self.pose),
            }
            std::hint::black_box(computation.workspace());
        });
        self.take(number, factorization, spread, &mut computation);
    }

    fn dense_cholesky(&mut self) {
        let mut computation = Computation::<f64>::new(self.pose);
        let mut succeeds = true;
        let spread = time(self.budget, || {
            computation.place(self.pose);
            succeeds &= computation.by_cholesky(self.pose);
        });
        if succeeds {
            return self.take("f64", Factorization::DenseCholesky, spread, &mut computation);
        }
        self.methods.push(Method::delassus("f64", Factorization::DenseCholesky, Some(spread)));
    }

    fn take<T: Number>(
        &mut self,
        number: &'static str,
        factorization: Factorization,
        time: Spread,
        computation: &mut Computation<T>,
    ) {
        let delassus = self.reference.delassus_error(&computation.workspace().delassus);
        let mass_matrix = match factorization {
            Factorization::ArticulatedBodies => None,
            Factorization::SparseLtl => Some(self.reference.mass_matrix_error(&computation.workspace().mass_matrix)),
            // The same M.
            Factorization::DenseCholesky => {
                self.methods.iter().find(|method| method.number == number).and_then(|method| method.error?.mass_matrix)
            }
        };
        computation.velocities(self.pose);
        let outcome = self.outcome_error(computation);
        let error = Some(Errors { mass_matrix, delassus: Some(delassus), outcome });
        self.methods.push(Method { error, ..Method::delassus(number, factorization, Some(time)) });
    }

    /// The error of the outcomes; `None` with applied impulses, which need more than G, or with restitution.
    fn outcome_error<T: Number>(&self, computation: &Computation<T>) -> Option<f64> {
        let analysis = self.analysis.filter(|_| self.pose.state.scene.impulses.is_empty())?;
        let shape = Some(self.pose.problem).filter(|shape| shape.restitution().iter().all(|&e| e == 0.0))?;
        let problem = filled(shape, &computation.workspace().delassus, &computation.workspace().contact_velocity);
        let exact = filled(shape, self.reference.delassus(), self.reference.velocity());
        outcome_error(analysis, &problem, &exact)
    }
}

/// A problem of the friction of `shape` with these matrices.
fn filled<T: Number>(shape: &ContactProblem, delassus: &[T], velocity: &[Pair<T>]) -> ContactProblem<T> {
    let speeds = velocity.iter().flatten();
    // `map` takes G by rows, the velocities with and without applied impulses, and their normal parts.
    let normal = velocity.iter().map(|c| &c[1]);
    let numbers = RefCell::new(delassus.iter().chain(speeds.clone()).chain(speeds).chain(normal));
    shape.map(|zero| numbers.borrow_mut().next().copied().unwrap_or(T::from_f64(zero)))
}

/// The largest error of the unique outcomes' impulses and velocities by their modes, free of units.
fn outcome_error<T: Number>(
    analysis: &Analysis,
    problem: &ContactProblem<T>,
    exact: &ContactProblem<Interval>,
) -> Option<f64> {
    let contacts = problem.contacts();
    let size = |row: usize| exact.delassus(row, row).to_f64().sqrt();
    let speeds = (0..2 * contacts).map(|row| exact.velocity_free()[row / 2][row % 2].to_f64().abs() / size(row));
    let scale = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let (mut tableau, mut reference) = (Tableau::<T>::new(), Tableau::<Interval>::new());
    tableau.load(problem);
    reference.load(exact);
    let mut errors = Vec::new();
    for outcome in analysis.outcomes.iter().filter(|outcome| outcome.decided && outcome.impulse_unique) {
        let (found, truth) = (tableau.leaf(&outcome.modes), reference.leaf(&outcome.modes));
        let known = |vector: Pair<Interval>| vector.iter().all(|entry| entry.radius().is_finite());
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
