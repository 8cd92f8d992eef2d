//! The arrays of a batch, made for Python when they are first asked for.

use crate::values::as_keywords;
use heelstrike::pipeline::Aspect;
use heelstrike::state::NamedContact;
use heelstrike::{
    Mode, Verdict,
    write::{Arrays, Columns, Layout, Texts},
};
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyAttributeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyList};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An object of Python that is made when it is first asked for.
type Made = PyOnceLock<Py<PyAny>>;

/// The lists of [`Arrays`] that become NumPy arrays.
macro_rules! lists {
    ($($name:ident: $entry:ty),*) => {
        struct Lists {
            $($name: Made),*
        }

        impl Lists {
            fn new() -> Self {
                Self { $($name: Made::new()),* }
            }

            /// Copies the lists that became NumPy arrays back into `arrays`.
            fn copy(&self, py: Python<'_>, arrays: &mut Arrays) -> PyResult<()> {
                $(if let Some(array) = self.$name.get(py) {
                    arrays.$name = array.bind(py).cast::<PyArrayDyn<$entry>>()?.to_vec()?;
                })*
                Ok(())
            }
        }
    };
}

lists! {
    verdict: u8, all_proven: bool, offsets: i64, modes: i8, impulse: f64, velocity_after: f64, margin: f64, index: i8,
    proven: bool, family: bool
}

/// The answers to many states: arrays with an entry per state or per outcome.
#[pyclass(frozen, module = "heelstrike")]
pub struct Answers {
    table: Arc<Table>,
    states: usize,
    outcomes: usize,
    /// `None` only after the answers are dropped.
    arrays: Mutex<Option<Box<Arrays>>>,
    lists: Lists,
    texts: [Made; 4],
}

/// The common part of the answers to all states.
#[derive(Serialize, Deserialize)]
pub struct Table {
    pub aspect: Aspect,
    pub coordinates: Vec<String>,
    columns: Columns,
    /// Arrays without any answer.
    pub empty: Arrays,
    /// Memory of dropped answers to few states, for reuse.
    #[serde(skip)]
    spare: Mutex<Option<Box<Arrays>>>,
}

/// Memory is kept for reuse if it had answers to at most this many states.
const FEW: usize = 16;

impl Table {
    /// The table for a robot's feet and for contacts that states name.
    pub fn new(aspect: Aspect, robot: &heelstrike::Robot, feet: &[NamedContact], named: &[&str]) -> Self {
        let layout = Layout { aspect, ..Layout::default() };
        let columns = Columns::without_lines(robot, feet, named, &[], layout);
        let coordinates = robot.coordinates().map(str::to_owned).collect();
        Self { aspect, coordinates, empty: Arrays::new(&columns), columns, spare: Mutex::default() }
    }

    /// Arrays without any answer, with room for those to `states` states.
    pub fn arrays(&self, states: usize) -> Box<Arrays> {
        let spare = if states <= FEW { locked(&self.spare).take() } else { None };
        spare.unwrap_or_else(|| Box::new(self.empty.for_states(states)))
    }

    /// Whether arrays that were read back have the lengths and the indices that answers have.
    fn fits(&self, arrays: &Arrays) -> bool {
        let (states, outcomes) = (arrays.verdict.len(), arrays.margin.len());
        let entries = |each: usize| outcomes.checked_mul(each);
        let contacts = self.columns.contacts().len();
        let matrices = [
            (arrays.modes.len(), entries(contacts)),
            (arrays.impulse.len(), entries(2 * contacts)),
            (arrays.velocity_after.len(), entries(self.coordinates.len())),
        ];
        let lists = [arrays.index.len(), arrays.proven.len(), arrays.family.len()];
        let offsets = &arrays.offsets;
        let texts = |texts: &Texts, count: usize| {
            texts.at.iter().all(|&(entry, text)| entry < count && text < texts.known.len())
        };
        matrices.into_iter().all(|(length, expected)| Some(length) == expected)
            && lists == [outcomes; 3]
            && arrays.all_proven.len() == states
            && arrays.verdict.iter().all(|verdict| *verdict <= Arrays::REFUSED)
            && arrays.modes.iter().all(|mode| (Arrays::OPEN..Mode::ALL.len() as i8).contains(mode))
            && (offsets.len(), offsets.first(), offsets.last()) == (states + 1, Some(&0), Some(&(outcomes as i64)))
            && offsets.is_sorted()
            && texts(&arrays.error, states)
            && texts(&arrays.notes, states)
            && texts(&arrays.border, outcomes)
            && texts(&arrays.families, outcomes)
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Answers {
    fn drop(&mut self) {
        let own = self.arrays.get_mut().unwrap_or_else(PoisonError::into_inner);
        let Some(mut arrays) = own.take().filter(|_| self.states <= FEW) else { return };
        arrays.clear();
        *locked(&self.table.spare) = Some(arrays);
    }
}

impl Answers {
    pub fn new(table: Arc<Table>, arrays: Box<Arrays>) -> Self {
        let (states, outcomes) = (arrays.verdict.len(), arrays.margin.len());
        let (lists, texts) = (Lists::new(), [const { Made::new() }; 4]);
        Self { table, states, outcomes, arrays: Some(arrays).into(), lists, texts }
    }

    /// Runs `work` on the lists that are not NumPy arrays yet, and on the texts. `work` must not run Python code.
    fn with<R>(&self, work: impl FnOnce(&mut Arrays) -> R) -> R {
        work(locked(&self.arrays).get_or_insert_default())
    }

    /// A copy of all lists and texts.
    fn copy(&self, py: Python<'_>) -> PyResult<Arrays> {
        let mut arrays = self.with(|arrays| arrays.clone());
        self.lists.copy(py, &mut arrays)?;
        Ok(arrays)
    }

    /// A list as a NumPy array, without a copy.
    fn array<T: Element>(
        &self,
        py: Python<'_>,
        made: &Made,
        list: fn(&mut Arrays) -> &mut Vec<T>,
        shape: &[usize],
    ) -> PyResult<Py<PyAny>> {
        let make = || {
            let array = PyArray1::from_vec(py, self.with(|arrays| std::mem::take(list(arrays))));
            // Arrays are read-only, because tables and copies are made from them later.
            array.getattr("flags")?.setattr("writeable", false)?;
            let array = if shape.len() == 1 { array.into_any() } else { array.reshape(shape.to_vec())?.into_any() };
            Ok::<_, PyErr>(array.unbind())
        };
        made.get_or_try_init(py, make).map(|array| array.clone_ref(py))
    }

    /// Raises AttributeError if `name` belongs to answers to the other question.
    fn of(&self, aspect: Aspect, name: &str) -> PyResult<()> {
        let other = if aspect == Aspect::Impact { "forces" } else { "impacts" };
        let wrong = || PyAttributeError::new_err(format!("the answers of {other} have no '{name}'"));
        if self.table.aspect == aspect { Ok(()) } else { Err(wrong()) }
    }

    /// A list with a text or `None` for each of `count` entries.
    fn texts<'py>(
        &self,
        py: Python<'py>,
        made: &Made,
        texts: fn(&Arrays) -> &Texts,
        count: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let make = || {
            let Texts { at, known, .. } = self.with(|arrays| texts(arrays).clone());
            let known: Vec<_> =
                known.iter().map(|text| as_keywords(text).into_pyobject(py)).collect::<Result<_, _>>()?;
            let list = PyList::new(py, std::iter::repeat_n(None::<&str>, count))?;
            for (entry, text) in at {
                list.set_item(entry, &known[text])?;
            }
            Ok::<_, PyErr>(list.into_any().unbind())
        };
        made.get_or_try_init(py, make).map(|list| list.bind(py).clone())
    }
}

#[pymethods]
impl Answers {
    /// Names of q's entries: columns of `velocity_after`.
    #[getter]
    fn coordinates(&self) -> &[String] {
        &self.table.coordinates
    }

    /// Names of the contacts that the robot's feet can make: columns of `modes` and `impulse`.
    #[getter]
    fn contacts(&self) -> &[String] {
        self.table.columns.contacts()
    }

    /// Names of the columns of `to_arrow` and `to_pandas`.
    #[getter]
    fn columns(&self) -> &[String] {
        self.table.columns.names()
    }

    /// The `Verdict` of each state, (n,) of uint8.
    #[getter]
    fn verdict(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.verdict, |arrays| &mut arrays.verdict, &[self.states])
    }

    /// Whether every combination of each state is decided by an error bound, (n,).
    #[getter]
    fn all_proven(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.all_proven, |arrays| &mut arrays.all_proven, &[self.states])
    }

    /// Offsets of the outcomes, (n + 1,): state k has those from offsets[k] up to, but not including, offsets[k + 1].
    #[getter]
    fn offsets(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.offsets, |arrays| &mut arrays.offsets, &[self.states + 1])
    }

    /// The `Mode` of each contact in each outcome, (m, contacts) of int8; OPEN if the contact is not closed.
    #[getter]
    fn modes(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let contacts = self.table.columns.contacts().len();
        self.array(py, &self.lists.modes, |arrays| &mut arrays.modes, &[self.outcomes, contacts])
    }

    /// The impulse [tangential, normal] of each contact in each outcome [N s], (m, contacts, 2); NaN if the contact is
    /// not closed or the outcome is not decided.
    #[getter]
    fn impulse(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.of(Aspect::Impact, "impulse")?;
        let contacts = self.table.columns.contacts().len();
        self.array(py, &self.lists.impulse, |arrays| &mut arrays.impulse, &[self.outcomes, contacts, 2])
    }

    /// The force [tangential, normal] of each contact in each outcome [N], (m, contacts, 2); NaN if the contact is not
    /// closed or the outcome is not decided.
    #[getter]
    fn force(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.of(Aspect::Forces, "force")?;
        let contacts = self.table.columns.contacts().len();
        self.array(py, &self.lists.impulse, |arrays| &mut arrays.impulse, &[self.outcomes, contacts, 2])
    }

    /// The velocity v after the impact of each outcome, (m, nq) in the order of `coordinates` [m/s, rad/s]; NaN if the
    /// outcome is not decided.
    #[getter]
    fn velocity_after(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.of(Aspect::Impact, "velocity_after")?;
        let shape = [self.outcomes, self.table.coordinates.len()];
        self.array(py, &self.lists.velocity_after, |arrays| &mut arrays.velocity_after, &shape)
    }

    /// The acceleration dv/dt of each outcome, (m, nq) in the order of `coordinates` [m/s^2, rad/s^2]; NaN if the
    /// outcome is not decided.
    #[getter]
    fn acceleration(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.of(Aspect::Forces, "acceleration")?;
        let shape = [self.outcomes, self.table.coordinates.len()];
        self.array(py, &self.lists.velocity_after, |arrays| &mut arrays.velocity_after, &shape)
    }

    /// The smallest slack of each outcome, free of units, (m,); NaN if the outcome has no inequality.
    #[getter]
    fn margin(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.margin, |arrays| &mut arrays.margin, &[self.outcomes])
    }

    /// The index of each outcome, the sign of det A, (m,) of int8; 0 if it is not defined, as on a border.
    #[getter]
    fn index(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.index, |arrays| &mut arrays.index, &[self.outcomes])
    }

    /// Whether an error bound shows every sign of each outcome, (m,).
    #[getter]
    fn proven(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.proven, |arrays| &mut arrays.proven, &[self.outcomes])
    }

    /// Whether each outcome is a corner of a family of outcomes, (m,).
    #[getter]
    fn family(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.array(py, &self.lists.family, |arrays| &mut arrays.family, &[self.outcomes])
    }

    /// A list with the reason why each state was refused, or None.
    #[getter]
    fn error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, &self.texts[0], |arrays| &arrays.error, self.states)
    }

    /// A list with the notes on each state, or None.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, &self.texts[1], |arrays| &arrays.notes, self.states)
    }

    /// A list with what is exactly zero in each outcome that is on a border, else None.
    #[getter]
    fn border<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, &self.texts[2], |arrays| &arrays.border, self.outcomes)
    }

    /// A list with the modes of the families of which each outcome is a corner, or None.
    #[getter]
    fn families<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, &self.texts[3], |arrays| &arrays.families, self.outcomes)
    }

    /// The number of states.
    fn __len__(&self) -> usize {
        self.states
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut counts = [0; Arrays::REFUSED as usize + 1];
        let verdicts = self.verdict(py)?.bind(py).cast::<PyArrayDyn<u8>>()?.to_vec()?;
        verdicts.into_iter().for_each(|verdict| counts[usize::from(verdict)] += 1);
        let refused = counts[Arrays::REFUSED as usize];
        let names = Verdict::ALL.map(Verdict::name).into_iter().chain(["refused"]);
        let verdicts = counts.into_iter().zip(names).filter(|(count, _)| *count > 0);
        let verdicts: Vec<String> = verdicts.map(|(count, name)| format!("{count} {name}")).collect();
        let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let contacts = list(self.table.columns.contacts());
        let mut first = String::new();
        // The list of errors has an entry per state, so it is made only if it is needed.
        if refused > 0 {
            let mut errors = self.error(py)?.try_iter()?.filter_map(Result::ok).filter(|error| !error.is_none());
            first = errors.next().map_or(first, |error| format!("; first refusal: {error}"));
        }
        Ok(format!("Answers({} states: {}; contacts {contacts}{first})", self.states, list(&verdicts)))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bytes = postcard::to_stdvec(&(&*self.table, self.copy(py)?));
        let bytes = bytes.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let again = py.import("heelstrike._values")?.getattr("answers")?;
        Ok((again, (PyBytes::new(py, &bytes),)).into_pyobject(py)?.into_any())
    }

    #[staticmethod]
    fn _again(bytes: &[u8]) -> PyResult<Self> {
        let read: Result<(Table, Arrays), _> = postcard::from_bytes(bytes);
        let (table, arrays) = read.map_err(|error| PyValueError::new_err(error.to_string()))?;
        if !table.fits(&arrays) {
            return Err(PyValueError::new_err("these pickled answers are damaged"));
        }
        Ok(Self::new(Arc::new(table), Box::new(arrays)))
    }

    /// A pyarrow.Table with a row per outcome, and a row for each state without outcome. Its columns are those that
    /// `heelstrike batch` writes as CSV, without `line`. `id` has an entry per state, by default its number from 0.
    #[pyo3(signature = (id = None))]
    fn to_arrow<'py>(slf: &Bound<'py, Self>, id: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("heelstrike._tables")?.call_method1("to_arrow", (slf, id))
    }

    /// The table of `to_arrow` as a pandas.DataFrame.
    #[pyo3(signature = (id = None))]
    fn to_pandas<'py>(slf: &Bound<'py, Self>, id: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("heelstrike._tables")?.call_method1("to_pandas", (slf, id))
    }
}
