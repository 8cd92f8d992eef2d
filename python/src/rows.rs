//! Arrays of states: rows of q and v, answered by pipelines that are reused from call to call.

use crate::answers::{Answers, Table};
use crate::robot::{Model, Robot, friction};
use crate::values::{of_argument, refused, to_json, warn};
use crate::watch::{Call, budget, interrupted, raised, without_python};
use heelstrike::batch::{AHEAD, run};
use heelstrike::budget::TotalBudget;
use heelstrike::cli::threads;
use heelstrike::pipeline::Options;
use heelstrike::state::{Ground, NamedContact};
use heelstrike::write::Arrays;
use heelstrike::write::notes::beyond_budget;
use heelstrike::{Defaults, Error, Friction, Pipeline, Reason, State};
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use self_cell::self_cell;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of rows that a thread takes at once.
const TOGETHER: usize = 256;

self_cell!(
    /// A pipeline with the robot that it borrows.
    struct OwnPipeline {
        owner: Arc<Model>,
        #[covariant]
        dependent: Pipeline,
    }
);

/// A pipeline and the state that it answers, both reused from call to call.
pub struct Kept {
    pipeline: OwnPipeline,
    state: State,
    /// The origin of the state's fields, except for the numbers of a row.
    common: Arc<Common>,
}

/// Answers one kind of question about a robot.
pub struct Asker {
    /// For calls whose rows have no common fields.
    pub plain: Arc<Common>,
    /// Pipelines that no call is using.
    pub kept: Mutex<Vec<Kept>>,
    /// For the last call whose rows had common fields.
    pub last: Mutex<Option<Arc<Common>>>,
}

/// The common part of all rows of a call.
pub struct Common {
    /// The fields as Python gave them.
    fields: Option<Py<PyAny>>,
    state: State,
    pub table: Arc<Table>,
}

/// States as rows of arrays.
pub struct Rows<'py> {
    model: Arc<Model>,
    rows: usize,
    q: Given<'py>,
    v: Given<'py>,
    scene: Scene,
    friction: Option<Given<'py>>,
    restitution: Option<Given<'py>>,
}

/// The common fields of all rows, and the friction and restitution that are given as one number.
struct Scene {
    common: Arc<Common>,
    friction: Option<Friction>,
    restitution: Option<f64>,
}

/// The numbers of all rows as slices, which need no interpreter.
struct Numbers<'a> {
    coordinates: &'a [String],
    q: &'a [f64],
    v: &'a [f64],
    friction: Option<&'a [f64]>,
    restitution: Option<&'a [f64]>,
}

/// The numbers of an array. Small arrays are copied, because NumPy's record of a borrow takes longer.
enum Given<'py> {
    Few(Vec<f64>),
    Many(PyReadonlyArrayDyn<'py, f64>),
}

impl Given<'_> {
    /// Arrays of at most this many numbers are copied.
    const FEW: usize = 256;

    fn numbers(&self) -> PyResult<&[f64]> {
        match self {
            Self::Few(numbers) => Ok(numbers),
            Self::Many(array) => Ok(array.as_slice()?),
        }
    }
}

/// The number of rows, and the array as f64 in C order with a number per coordinate in each row, or one number per row
/// without `coordinates`. A large array is copied only if it has another type or order.
fn array<'py>(what: &str, value: &Bound<'py, PyAny>, coordinates: Option<&[String]>) -> PyResult<(usize, Given<'py>)> {
    let columns = coordinates.map(<[String]>::len);
    let py = value.py();
    let is_masked = value.cast_exact::<PyArrayDyn<f64>>().is_err() && value.hasattr("filled")?;
    let filled = || value.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,));
    let value = &if is_masked { filled()? } else { value.clone() };
    let own = value.cast::<PyArrayDyn<f64>>().ok().filter(|own| own.is_c_contiguous() && own.is_aligned()).cloned();
    let own = match own {
        Some(own) => own,
        None => {
            check_order(what, value, coordinates.unwrap_or_default())?;
            let numpy = py.import("numpy")?;
            let keywords = PyDict::new(py);
            keywords.set_item("dtype", "float64")?;
            keywords.set_item("requirements", ["C", "A"])?;
            let kind: String = numpy.call_method1("asarray", (value,))?.getattr("dtype")?.getattr("kind")?.extract()?;
            if !["f", "i", "u"].contains(&&*kind) {
                let hint = "numbers are needed: give float64, as by numpy.ascontiguousarray(..., dtype=float)";
                return Err(PyTypeError::new_err(format!("{what} has the dtype kind '{kind}'; {hint}")));
            }
            numpy.call_method("require", (value,), Some(&keywords))?.cast_into::<PyArrayDyn<f64>>()?
        }
    };
    let fits = match columns {
        Some(columns) => own.ndim() == 2 && own.shape()[1] == columns,
        None => own.ndim() == 1,
    };
    if !fits {
        let wanted = columns.map_or("(n,), a number per state".to_owned(), |nq| {
            format!("(n, {nq}): a row per state, in the order of robot.coordinates")
        });
        let hint = if own.ndim() == 1 && columns == Some(own.len()) { "; one state is q[None, :]" } else { "" };
        return Err(PyValueError::new_err(format!("{what} has the shape {:?}, not {wanted}{hint}", own.shape())));
    }
    let few = own.len() <= Given::FEW;
    Ok((own.shape()[0], if few { Given::Few(own.to_vec()?) } else { Given::Many(own.readonly()) }))
}

/// Refuses a table whose columns are named as coordinates, or as in the tool's own tables, but are in another order.
fn check_order(what: &str, value: &Bound<'_, PyAny>, coordinates: &[String]) -> PyResult<()> {
    let names = value.getattr("column_names").or_else(|_| value.getattr("columns")).and_then(|names| names.try_iter());
    let names = names.into_iter().flatten().map(|name| name?.extract::<String>()).collect::<PyResult<Vec<_>>>();
    let known = |name: &str| coordinates.iter().position(|own| own == name);
    let of_tables = |name: &str| {
        let name = name.strip_prefix(what)?.strip_prefix('_')?;
        known(name).or_else(|| known(name.strip_prefix("base_")?))
    };
    let place = |name: &str| known(name).or_else(|| of_tables(name));
    let is_elsewhere = |(at, name): (usize, &String)| place(name).is_some_and(|place| place != at);
    let is_mixed = |names: &Vec<String>| names != coordinates && names.iter().enumerate().any(is_elsewhere);
    let Some(names) = names.ok().filter(is_mixed) else { return Ok(()) };
    let remedy = match coordinates.iter().all(|name| names.contains(name)) {
        true => format!("give {what}[robot.coordinates]"),
        false => format!("give {}", coordinates.join(", ")),
    };
    let order = names.join(", ");
    let refused = format!("{what} has the columns {order}, not in the order of robot.coordinates");
    Err(PyValueError::new_err(format!("{refused}: {remedy}")))
}

impl Asker {
    pub fn new(robot: &heelstrike::Robot, table: Table) -> Self {
        let plain = Common { fields: None, state: State::zero(robot), table: Arc::new(table) };
        Self { plain: Arc::new(plain), kept: Mutex::default(), last: Mutex::default() }
    }

    /// The common part of rows with these `fields`. It is computed again only if they differ from those of the last
    /// call.
    fn common(&self, model: &Model, fields: &Bound<'_, PyDict>) -> PyResult<Arc<Common>> {
        let py = fields.py();
        // No lock is held below, because Python code runs there and may let another thread ask.
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let is_last = |last: &Arc<Common>| last.fields.as_ref().is_some_and(|known| same(known.bind(py), fields));
        if let Some(last) = last.filter(is_last) {
            return Ok(last);
        }
        for name in ["position", "velocity", "id", "uncertainty"] {
            if fields.contains(name)? {
                return Err(PyTypeError::new_err(format!("rows have no common \"{name}\"")));
            }
        }
        let wrong = |error: Error| match error.reason() {
            Reason::UnknownField(name) if error.place() == Some(name) => {
                let error = error.clone().did_you_mean(name, ["friction", "restitution", "contacts", "threads"]);
                let hint = error.remedy().filter(|hint| hint.starts_with("did you mean"));
                let hint = hint.map_or(String::new(), |hint| format!("; {hint}"));
                PyTypeError::new_err(format!("there is no argument '{name}'{hint}"))
            }
            // Without line and column, because no one wrote the text.
            _ => refused(error.nowhere()),
        };
        let state = State::from_json(&to_json(fields)?, &model.robot, &Defaults::default()).map_err(wrong)?;
        let of_contacts = |contacts: &[NamedContact]| {
            let named = names(&model.robot, contacts);
            let named: Vec<&str> = named.iter().map(String::as_str).collect();
            Arc::new(Table::new(self.plain.table.aspect, &model.robot, &model.options.feet, &named))
        };
        // On a profile every foot may touch twice, as in a notch.
        let twice = |link: usize| [(); 2].map(|()| NamedContact { link, offset: [0.0; 3], radius: 0.0 });
        let on_profile =
            || (0..model.robot.links().len()).filter(|&link| has_foot(model, link)).flat_map(twice).collect::<Vec<_>>();
        let table = match (&state.scene.contacts, &state.scene.ground) {
            (Some(contacts), _) => of_contacts(contacts),
            (None, Ground::Profile(_)) => of_contacts(&on_profile()),
            (None, Ground::Slope(_)) => Arc::clone(&self.plain.table),
        };
        let fields = Some(py.import("copy")?.call_method1("deepcopy", (fields,))?.unbind());
        let common = Arc::new(Common { fields, state, table });
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&common));
        Ok(common)
    }
}

/// Whether a link has a shape in the file, or a foot was added to it.
fn has_foot(model: &Model, link: usize) -> bool {
    !model.robot.links()[link].shapes.is_empty() || model.options.feet.iter().any(|foot| foot.link == link)
}

/// Whether both values are equal and of Python's own types.
fn same(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> bool {
    // Copies share objects that cannot change.
    if a.is(b) {
        return true;
    }
    if !a.get_type().is(b.get_type()) {
        return false;
    }
    if let (Ok(a), Ok(b)) = (a.cast_exact::<PyDict>(), b.cast_exact::<PyDict>()) {
        let is_in = |(name, own)| b.get_item(name).ok().flatten().is_some_and(|other| same(&own, &other));
        return a.len() == b.len() && a.iter().all(is_in);
    }
    if let (Ok(a), Ok(b)) = (a.cast_exact::<PyList>(), b.cast_exact::<PyList>()) {
        return a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(&a, &b));
    }
    let plain = a.is_exact_instance_of::<PyString>()
        || a.is_exact_instance_of::<PyFloat>()
        || a.is_exact_instance_of::<PyInt>()
        || a.is_exact_instance_of::<PyBool>();
    plain && a.eq(b).unwrap_or(false)
}

/// An argument with a number per row, or with one value for all rows. A dictionary by link becomes one of the state's
/// `fields` instead.
type Argument<'py> = (Option<Given<'py>>, Option<Bound<'py, PyAny>>);

fn argument<'py>(
    what: &str,
    value: Option<&Bound<'py, PyAny>>,
    rows: usize,
    fields: &mut Option<Bound<'py, PyDict>>,
) -> PyResult<Argument<'py>> {
    let Some(value) = value else { return Ok((None, None)) };
    // Dictionaries come first, because asking one whether it is a number takes a microsecond.
    if value.is_instance_of::<PyDict>() {
        fields.get_or_insert_with(|| PyDict::new(value.py())).set_item(what, value)?;
        return Ok((None, None));
    }
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    // Whether it can be read as a number does not tell: in some versions of NumPy an array of one entry can.
    let is_array = || Ok::<_, PyErr>(is_list || value.hasattr("shape")? && !value.getattr("shape")?.is_empty()?);
    if value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>() || !is_array()? {
        return Ok((None, Some(value.clone())));
    }
    match array(what, value, None)? {
        (entries, given) if entries == rows => Ok((Some(given), None)),
        (entries, _) => Err(PyValueError::new_err(format!("{what} has {entries} entries for {rows} states"))),
    }
}

impl<'py> Rows<'py> {
    pub fn read(
        robot: &Robot,
        asker: &Asker,
        [q, v]: [&Bound<'py, PyAny>; 2],
        mu: Option<&Bound<'py, PyAny>>,
        restitution: Option<&Bound<'py, PyAny>>,
        contacts: Option<&Bound<'py, PyAny>>,
        scene: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let model = &robot.model;
        let coordinates = Some(&*asker.plain.table.coordinates);
        let mut fields = scene.cloned();
        if let Some(contacts) = contacts {
            fields.get_or_insert_with(|| PyDict::new(q.py())).set_item("contacts", contacts)?;
        }
        let ((rows, q), (others, v)) = (array("q", q, coordinates)?, array("v", v, coordinates)?);
        if rows != others {
            return Err(PyValueError::new_err(format!("q has {rows} rows and v {others}")));
        }
        let (friction_rows, mu) = argument("friction", mu, rows, &mut fields)?;
        let (restitution_rows, own) = argument("restitution", restitution, rows, &mut fields)?;
        let common = match &fields {
            None => Arc::clone(&asker.plain),
            Some(fields) => asker.common(model, fields)?,
        };
        let scene = Scene {
            common,
            friction: mu.as_ref().map(friction).transpose()?,
            restitution: own
                .map(|own| restituted(own.extract().map_err(of_argument("restitution"))?).map_err(refused))
                .transpose()?,
        };
        let model = Arc::clone(model);
        Ok(Self { model, rows, q, v, scene, friction: friction_rows, restitution: restitution_rows })
    }

    /// Answers all rows.
    pub fn answer(self, py: Python<'py>, asker: &Asker, count: Option<usize>) -> PyResult<Answers> {
        let Self { model, rows, q, v, scene, friction, restitution } = self;
        let table = &scene.common.table;
        let threads = if rows <= TOGETHER { 1 } else { threads(count.unwrap_or(0)).min(rows.div_ceil(TOGETHER)) };
        let numbers = Numbers {
            coordinates: &table.coordinates,
            q: q.numbers()?,
            v: v.numbers()?,
            friction: friction.as_ref().map(Given::numbers).transpose()?,
            restitution: restitution.as_ref().map(Given::numbers).transpose()?,
        };
        // A single row has no others to share a total with.
        let total = model.budget.filter(|_| rows > 1).map(|each| TotalBudget::new(budget(Some(each)), None));
        let arrays = without_python(py, || {
            let (numbers, total, call) = (&numbers, total.as_ref(), Call::current());
            let mut all = table.arrays(rows);
            if threads <= 1 {
                // One thread writes directly to the result.
                let mut worker = Worker::new(&model, asker, &scene);
                for row in 0..rows {
                    worker.row(numbers, row, total, &mut all);
                    // Within a long row the budget's clock checks for signals.
                    if raised() || row % TOGETHER == TOGETHER - 1 && interrupted() {
                        break;
                    }
                }
                return all;
            }
            let answerer = || {
                call.join();
                let mut worker = Worker::new(&model, asker, &scene);
                move |rows: Range<usize>| {
                    let mut block = table.empty.for_states(rows.len());
                    rows.take_while(|_| !raised()).for_each(|row| worker.row(numbers, row, total, &mut block));
                    interrupted();
                    block
                }
            };
            let mut ranges = (0..rows).step_by(TOGETHER).map(|start| start..rows.min(start + TOGETHER));
            let append = |block| {
                all.append(block);
                if raised() { Err(Reason::BeyondBudget.into()) } else { Ok(()) }
            };
            // Only a signal ends the run early, and its exception is then raised.
            let _ = run(|| Ok(ranges.next()), threads, AHEAD, answerer, append);
            all
        })?;
        warn(py, beyond_budget(total.as_ref()))?;
        Ok(Answers::new(Arc::clone(table), arrays))
    }
}

/// A pipeline at work; it returns to the pool when dropped.
struct Worker<'p> {
    kept: Option<Kept>,
    pool: &'p Mutex<Vec<Kept>>,
}

impl<'p> Worker<'p> {
    fn new(model: &Arc<Model>, asker: &'p Asker, Scene { common, friction, restitution }: &Scene) -> Self {
        let known = asker.kept.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let new = || {
            let asked = |model: &Arc<Model>| Options { aspect: common.table.aspect, ..model.options.clone() };
            let pipeline = OwnPipeline::new(Arc::clone(model), |model| Pipeline::new(&model.robot, asked(model)));
            Kept { pipeline, state: common.state.clone(), common: Arc::clone(common) }
        };
        let mut kept = known.unwrap_or_else(new);
        if !Arc::ptr_eq(&kept.common, common) {
            kept.state.clone_from(&common.state);
            kept.common = Arc::clone(common);
        }
        let (own, given) = (&mut kept.state.scene, &common.state.scene);
        own.friction.default = friction.or(given.friction.default);
        own.restitution.default = restitution.or(given.restitution.default);
        Self { kept: Some(kept), pool: &asker.kept }
    }

    /// Answers a row and appends the answer to `out`.
    fn row(&mut self, numbers: &Numbers, row: usize, total: Option<&TotalBudget>, out: &mut Arrays) {
        let Some(Kept { pipeline, state, .. }) = &mut self.kept else { return };
        let answer = set(state, numbers, row).and_then(|is_placed_twice| {
            let answer = pipeline.with_dependent_mut(|model, pipeline| match total {
                Some(total) => total.within(|| pipeline.answer(state)),
                None => budget(model.budget).within(|| pipeline.answer(state)),
            });
            answer.map(|mut impact| {
                impact.notes.extend(is_placed_twice.then(|| PLACED_TWICE.to_owned()));
                impact
            })
        });
        out.push(answer.as_deref().map_err(Error::clone));
        if let Ok(impact) = answer {
            pipeline.with_dependent_mut(|_, pipeline| pipeline.recycle(impact));
        }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        self.pool.lock().unwrap_or_else(PoisonError::into_inner).extend(self.kept.take());
    }
}

/// The note of a row that places the base although the stance does.
const PLACED_TWICE: &str = "x and z of q and v are not used: the stance places the base";

/// Sets the numbers of a row. Returns whether the row places the base although a stance does.
fn set(state: &mut State, numbers: &Numbers, row: usize) -> heelstrike::Result<bool> {
    let nq = numbers.coordinates.len();
    let range = row * nq..(row + 1) * nq;
    let placed = if state.scene.stance.is_some() { 2 } else { 0 };
    let mut is_placed_twice = false;
    for (what, entries, own) in
        [("q", &numbers.q[range.clone()], &mut state.position), ("v", &numbers.v[range], &mut state.velocity)]
    {
        if let Some(at) = (placed..nq).find(|&at| !entries[at].is_finite()) {
            let what = format!("{what} of {}", numbers.coordinates[at]);
            return Err(Reason::NotFinite { what, value: entries[at] }.into());
        }
        own[placed..].copy_from_slice(&entries[placed..]);
        is_placed_twice |= entries[..placed].iter().any(|entry| entry.abs() > 0.0);
    }
    if let Some(friction) = numbers.friction {
        state.scene.friction.default = Some(rough(friction[row])?);
    }
    if let Some(restitution) = numbers.restitution {
        state.scene.restitution.default = Some(restituted(restitution[row])?);
    }
    Ok(is_placed_twice)
}

/// Friction with the coefficient `mu`.
pub fn rough(mu: f64) -> heelstrike::Result<Friction> {
    let refused = || Reason::OutOfRange { what: "friction".into(), allowed: "0 or more", value: mu };
    if mu >= 0.0 { Ok(mu.into()) } else { Err(refused().into()) }
}

fn restituted(value: f64) -> heelstrike::Result<f64> {
    let refused = || Reason::OutOfRange { what: "restitution".into(), allowed: "between 0 and 1", value };
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err(refused().into()) }
}

/// The names of contacts that a state lists.
fn names(robot: &heelstrike::Robot, contacts: &[NamedContact]) -> Vec<String> {
    let of = |link: usize| contacts.iter().filter(move |contact| contact.link == link).count();
    let all = contacts.iter().enumerate().map(|(at, contact)| {
        let name = &robot.links()[contact.link].name;
        let before = contacts[..at].iter().filter(|other| other.link == contact.link).count();
        if of(contact.link) == 1 { name.clone() } else { format!("{name}/{before}") }
    });
    all.collect()
}
