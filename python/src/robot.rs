//! Robots, and the answer to one state.

use crate::answers::{Answers, Table};
use crate::rows::{Asker, Rows, rough};
use crate::study::limit;
use crate::values::{choice, from_json, of_argument, refused, refused_in, to_json, warn};
use crate::watch::{budget, without_python};
use crate::{picture, study};
use heelstrike::cli::{BASES, DIFFERENCES, Meshes, PLANES, ROWS, RecordingOptions, Seconds, from_zero};
use heelstrike::gait::Touching;
use heelstrike::pipeline::{Aspect, Options};
use heelstrike::read::documents::utf8;
use heelstrike::reductions::Reductions;
use heelstrike::robot::{FreezeReason, Reduction};
use heelstrike::state::NamedContact;
use heelstrike::write::{append_line, notes};
use heelstrike::{Defaults, Description, Detail, Error, Friction, Inspection, Pipeline, Reason, Report, State};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A robot as its URDF file has it, and reduced to its plane.
pub struct Model {
    pub description: Description,
    pub reduction: Reduction,
    pub robot: heelstrike::Robot,
    /// Options of every pipeline, such as how contacts are found.
    pub options: Options,
    /// Processor time that an answer may take.
    pub budget: Seconds,
}

/// A planar robot, read from a URDF file.
///
/// Options: `plane` ("xz", "yz", ...), `hold` (values of joints to fix, by name [rad, m]), `base` ("fixed",
/// "floating"), `axis_tolerance` [rad], `package_path` (folders with packages of meshes), `feet` (contacts to add,
/// listed as in a state), `contact_tolerance` [m], `resting_speed` [m/s], `strict_limits`, `budget` (seconds of
/// processor time that an answer may take, None for no limit). Raises Refused with `file`, `place` and `hint`.
#[pyclass(frozen, module = "heelstrike")]
pub struct Robot {
    pub model: Arc<Model>,
    impacts: Asker,
    forces: Asker,
    /// What the robot was made from: URDF text, path from which meshes are found, options.
    source: (String, PathBuf, Option<Py<PyDict>>),
}

impl Model {
    /// Reads the robot and its meshes, which are found from the file `path`.
    fn read(text: &str, path: &Path, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut description = Description::from_urdf(text).map_err(refused)?;
        let mut reduction = Reduction { reductions: Reductions::ALL, ..Reduction::default() };
        let (mut own, mut budget, mut package_path, mut feet) =
            (Options::default(), Some(Duration::from_secs(10)), Vec::new(), None);
        for (name, value) in options.into_iter().flatten() {
            let name: String = name.extract()?;
            let mut set = || {
                match name.as_str() {
                    "plane" => reduction.plane = choice("plane", PLANES, value.extract()?)?.flatten(),
                    "hold" => reduction.hold = held(&description, value.cast()?)?,
                    "base" => reduction.base = choice("base", BASES, value.extract()?)?,
                    "axis_tolerance" => reduction.axis_tolerance = positive("axis_tolerance", &value)?,
                    "package_path" => package_path = folders(&value)?,
                    "feet" => feet = Some(value.clone()),
                    "contact_tolerance" => own.contact_tolerance = positive("contact_tolerance", &value)?,
                    "resting_speed" => own.resting_speed = positive("resting_speed", &value)?,
                    "strict_limits" => own.strict_limits = value.extract()?,
                    "budget" => budget = limit(&value)?,
                    _ => return Err(PyTypeError::new_err("Robot has no such option")),
                }
                Ok(())
            };
            set().map_err(of_argument(&name))?;
        }
        Meshes::of(path, &package_path).read(&mut description);
        let robot = heelstrike::Robot::reduce(&description, &reduction).map_err(refused)?;
        let feet = feet.map(|feet| contacts(&robot, &feet)).transpose()?;
        let options = Options { feet: feet.unwrap_or_default(), ..own };
        Ok(Self { description, reduction, robot, options, budget })
    }

    /// The answer to a state as JSON, and the result of `then` on it.
    pub fn answer<T>(
        &self,
        state: &str,
        asked: Asked,
        then: impl FnOnce(&State, &heelstrike::Impact, &Report) -> T,
    ) -> heelstrike::Result<(Vec<u8>, T)> {
        let Asked { aspect, friction, detail, next } = asked;
        let state = State::from_json(state, &self.robot, &Defaults { friction, ..Defaults::default() })?;
        let explain_up_to = if detail.explain { usize::MAX } else { 0 };
        let options = Options { aspect, next, explain_up_to, matrices: detail.matrices, ..self.options.clone() };
        let mut pipeline = Pipeline::new(&self.robot, options);
        let impact = budget(self.budget).within(|| pipeline.answer(&state))?;
        let report = Report::of_state(&self.robot, &state, &impact, detail)?;
        let mut out = Vec::new();
        report.append_json(detail, &mut out);
        Ok((out, then(&state, &impact, &report)))
    }
}

/// A question about one state.
#[derive(Clone, Copy)]
pub struct Asked {
    pub aspect: Aspect,
    /// Friction of links to which the state gives none.
    pub friction: Option<Friction>,
    pub detail: Detail,
    pub next: bool,
}

/// A finite number from 0 on, or `None` for the default.
fn positive(what: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    let check = |number: f64| {
        from_zero(&number.to_string())
            .map_err(|expected| PyValueError::new_err(format!("{what}: {expected}, not {number}")))
    };
    value.extract::<Option<f64>>()?.map(check).transpose()
}

fn folders(value: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    value.extract().map_err(|_| PyTypeError::new_err("a list of folders is expected"))
}

fn held(description: &Description, by_name: &Bound<'_, PyDict>) -> PyResult<Vec<(usize, f64)>> {
    let held = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name: String = name.extract()?;
        let known = description.joints.iter().map(|joint| joint.name.as_str());
        let found = description.joint(&name).ok_or_else(|| {
            let reason = Reason::UnknownName { what: "joint", name: name.clone() };
            refused(Error::new(reason).at("hold").did_you_mean(&name, known))
        })?;
        Ok((found, value.extract()?))
    };
    by_name.iter().map(held).collect()
}

/// Reads contacts that are listed as in a state.
fn contacts(robot: &heelstrike::Robot, list: &Bound<'_, PyAny>) -> PyResult<Vec<NamedContact>> {
    let state = PyDict::new(list.py());
    state.set_item("contacts", list)?;
    // The place is that of the option, without line and column, because no one wrote the text.
    let own = |error: Error| {
        let place = error.place().map(|place| place.replacen("contacts", "feet", 1));
        refused(place.into_iter().fold(error.nowhere(), Error::at))
    };
    let state = State::from_json(&to_json(state.as_any())?, robot, &Defaults::default()).map_err(own)?;
    Ok(state.scene.contacts.unwrap_or_default())
}

/// Reads friction as an argument: a number, `inf` and "infinite" included.
pub fn friction(value: &Bound<'_, PyAny>) -> PyResult<Friction> {
    match value.extract::<f64>() {
        Ok(number) => rough(number).map_err(refused),
        Err(_) => {
            let expected = "friction is a number from 0 on or \"infinite\"; by link it is a dictionary, which rows take \
                            and a state holds itself";
            let text = value.extract::<String>().map_err(|_| PyTypeError::new_err(expected))?;
            // Python's `float` reads this text, too.
            if text == "inf" {
                return Ok(Friction::Infinite);
            }
            text.parse().map_err(|expected| PyValueError::new_err(format!("friction: {expected}, not {text}")))
        }
    }
}

/// An argument `budget`.
pub struct Limit(pub Seconds);

impl<'py> FromPyObject<'_, 'py> for Limit {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        limit(&value).map(Self)
    }
}

#[pymethods]
impl Robot {
    #[new]
    #[pyo3(signature = (path, **options))]
    fn new(py: Python<'_>, path: PathBuf, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let bytes = py.import("heelstrike._values")?.call_method1("read", (&path,))?;
        let text = utf8(bytes.extract()?).map_err(refused);
        let robot = text.and_then(|text| Self::of(py, text, &path, options)).and_then(|robot| robot.cautioned(py));
        robot.map_err(|error| {
            // The exception names the file, as messages of the command do.
            let named = error.value(py).setattr("file", &path);
            named.err().unwrap_or(error)
        })
    }

    /// A robot from the text of a URDF file; paths of meshes start in the current folder.
    #[staticmethod]
    #[pyo3(signature = (text, **options))]
    fn from_string(py: Python<'_>, text: &str, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of(py, text, Path::new(""), options)?.cautioned(py)
    }

    /// The robot's name in its file.
    #[getter]
    fn name(&self) -> &str {
        self.model.robot.name()
    }

    /// Names of q's entries: x, z, pitch of the root link unless it is fixed to the world, then the joints.
    #[getter]
    fn coordinates(&self) -> Vec<&str> {
        self.model.robot.coordinates().collect()
    }

    /// The plane's axes in the root link's, forward before up: xz, yz, xy, zy, zx or yx.
    #[getter]
    fn plane(&self) -> &'static str {
        self.model.robot.reading().plane.name()
    }

    /// Values [rad, m] of joints that `hold` fixes, and of mimic joints that follow a joint without a coordinate. All
    /// other joints without a coordinate are at zero.
    #[getter]
    fn held(&self) -> HashMap<&str, f64> {
        let held = self.model.robot.reading().frozen.iter().filter_map(|joint| match joint.reason {
            FreezeReason::Asked { value } | FreezeReason::Follows { value, .. } => Some((&*joint.name, value)),
            _ => None,
        });
        held.collect()
    }

    /// The robot that was read: plane, masses [kg], links, joints, feet, what was left out; as `heelstrike inspect
    /// --format json` writes it.
    fn inspect<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut out = Vec::new();
        append_line(&mut out, &Inspection::new(&self.model.robot, &self.model.options.feet));
        from_json(py, &out, None)
    }

    /// Every outcome of the impact of one state.
    ///
    /// `state` is a dictionary, a JSON text or a path of a JSON file, as the command `heelstrike impact` reads it;
    /// lengths in m, angles in rad. `friction`, a number from 0 on or "infinite", applies to links to which the state
    /// gives none. Returns the result as the command writes it. `explain` adds why every other combination fails,
    /// `matrices` adds M, J and G, `next` adds the forces just after each outcome. Raises Refused.
    #[pyo3(signature = (state, *, friction = None, explain = false, matrices = false, next = false))]
    fn impact<'py>(
        slf: &Bound<'py, Self>,
        state: &Bound<'py, PyAny>,
        friction: Option<&Bound<'py, PyAny>>,
        explain: bool,
        matrices: bool,
        next: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        Self::one(slf, state, Aspect::Impact, friction, Detail { explain, matrices, brief: false }, next)
    }

    /// Every outcome of the impacts of many states.
    ///
    /// `q` and `v` are (n, nq) arrays of float64 in C order, with columns in the order of `coordinates` [m, rad; m/s,
    /// rad/s]; v = dq/dt in the world's frame. Other real numbers and other orders are converted. `friction` (0 to inf)
    /// and `restitution` (0 to 1) are one number for all rows, an (n,) array, or a dictionary by link. `contacts` lists
    /// contacts as a state does; without it they are detected. Further fields of a state apply to all rows, such as
    /// `place="lowest"` or `ground={"slope": 0.1}`. `threads` is 0 or None for all cores. A refused row raises nothing:
    /// it has the verdict REFUSED, and its reason in `error`.
    #[pyo3(signature = (q, v, *, friction = None, restitution = None, contacts = None, threads = None, **scene))]
    fn impacts<'py>(
        slf: &Bound<'py, Self>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        friction: Option<&Bound<'py, PyAny>>,
        restitution: Option<&Bound<'py, PyAny>>,
        contacts: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
        scene: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Answers> {
        let asker = &slf.get().impacts;
        Rows::read(slf.get(), asker, [q, v], friction, restitution, contacts, scene)?.answer(slf.py(), asker, threads)
    }

    /// The contact forces and accelerations in sustained contact: of one state, given as for `impact` with `friction`,
    /// `explain` and `matrices`; or of rows, given as for `impacts`.
    #[pyo3(signature = (
        q, v = None, *, friction = None, restitution = None, contacts = None, threads = None, explain = false,
        matrices = false, **scene
    ))]
    fn forces<'py>(
        slf: &Bound<'py, Self>,
        q: &Bound<'py, PyAny>,
        v: Option<&Bound<'py, PyAny>>,
        friction: Option<&Bound<'py, PyAny>>,
        restitution: Option<&Bound<'py, PyAny>>,
        contacts: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
        explain: bool,
        matrices: bool,
        scene: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(v) = v else {
            if contacts.is_some() || restitution.is_some() || threads.is_some() || scene.is_some() {
                let own = "one state takes friction, explain and matrices besides: all else it has itself";
                return Err(PyTypeError::new_err(own));
            }
            let detail = Detail { explain, matrices, brief: false };
            return Self::one(slf, q, Aspect::Forces, friction, detail, false);
        };
        if explain || matrices {
            return Err(PyTypeError::new_err("explain and matrices are of one state, not of rows"));
        }
        let asker = &slf.get().forces;
        let rows = Rows::read(slf.get(), asker, [q, v], friction, restitution, contacts, scene)?;
        Ok(Bound::new(slf.py(), rows.answer(slf.py(), asker, threads)?)?.into_any())
    }

    /// Outcomes against one or two parameters: regions, borders and samples.
    ///
    /// `study` is a dictionary, a JSON text or a path of a JSON file, as `heelstrike sweep` reads it. Returns the
    /// result as the command writes it. The work may take `budget` seconds of processor time, None for no limit. Raises
    /// Refused.
    #[pyo3(signature = (study, *, friction = None, threads = None, budget = Limit(Some(Duration::from_secs(60)))))]
    fn sweep<'py>(
        slf: &Bound<'py, Self>,
        study: &Bound<'py, PyAny>,
        friction: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
        budget: Limit,
    ) -> PyResult<Bound<'py, PyAny>> {
        study::sweep(slf, study, friction, threads, budget.0)
    }

    /// The impacts at the touchdowns of a recording, as `heelstrike batch --touchdowns` writes them.
    ///
    /// `table` is a path (CSV, TSV, flat NDJSON, Parquet, Arrow), a data frame, an Arrow table or a dictionary of
    /// columns: `time` [s], `q_base_x`, `q_base_z`, `q_base_pitch`, `q_<joint>` [m, rad], and the same names with `v_`
    /// for rates, unless `velocity` is "central" or "backward". `at` is "crossing" or "row"; `touching` is "strike",
    /// "slow:SPEED,HEIGHT" or "near:HEIGHT". A foot must descend by `drop` to at most `ground_height` [m]; the defaults
    /// depend on the robot's size. `simulated` takes z = 0 as the ground. `foreign` names columns that do not belong to
    /// the state and are copied. `line` and `row` of a table in memory count as in its CSV: the first row is line 2.
    /// Raises Refused for the table; a refused touchdown has an `error`.
    #[pyo3(signature = (
        table, *, friction = None, velocity = None, at = None, touching = None, drop = None, ground_height = None,
        simulated = false, foreign = None
    ))]
    fn touchdowns<'py>(
        slf: &Bound<'py, Self>,
        table: &Bound<'py, PyAny>,
        friction: Option<&Bound<'py, PyAny>>,
        velocity: Option<&str>,
        at: Option<&str>,
        touching: Option<&str>,
        drop: Option<&Bound<'py, PyAny>>,
        ground_height: Option<&Bound<'py, PyAny>>,
        simulated: bool,
        foreign: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let height =
            |what, value: Option<_>| value.map_or(Ok(None), |value| positive(what, value)).map_err(of_argument(what));
        let recording = RecordingOptions {
            touchdowns: true,
            simulated,
            at: choice("at", ROWS, at)?.unwrap_or_default(),
            touching: touching.map_or_else(|| Ok(Touching::default()), str::parse).map_err(refused)?,
            drop: height("drop", drop)?,
            ground_height: height("ground_height", ground_height)?,
            velocity: choice("velocity", DIFFERENCES, velocity)?,
        };
        let one =
            |name: &Bound<'py, PyAny>| name.extract().map_or_else(|_| name.extract(), |name: String| Ok(vec![name]));
        let foreign: PyResult<Vec<String>> = foreign.map_or(Ok(Vec::new()), one);
        let foreign = foreign.map_err(|_| PyTypeError::new_err("foreign is a name of a column, or a list of them"))?;
        study::touchdowns(slf, table, friction, &recording, &foreign)
    }

    /// A picture of the robot, as SVG, and its description.
    fn _drawn(&self) -> (Option<String>, String) {
        picture::robot(&self.model)
    }

    /// The picture of a question, which is answered again, as SVG, and the answer as text. A study has these `threads`
    /// and this `budget` again.
    fn _picture(
        &self,
        py: Python<'_>,
        kind: &str,
        question: &str,
        friction: Option<&str>,
        threads: Option<usize>,
        budget: Option<f64>,
    ) -> PyResult<(Option<String>, String)> {
        picture::answer(py, &self.model, (kind, question), friction, (threads, budget))
    }

    #[staticmethod]
    #[pyo3(signature = (text, path, options))]
    fn _again(py: Python<'_>, text: &str, path: PathBuf, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of(py, text, &path, options)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (text, path, options) = &slf.get().source;
        let again = slf.py().import("heelstrike._values")?.getattr("robot")?;
        let source = (text, path, options.as_ref().map(|options| options.bind(slf.py())));
        Ok((again, source).into_pyobject(slf.py())?.into_any())
    }

    fn __repr__(&self) -> String {
        format!("Robot({:?}, coordinates={:?})", self.model.robot.name(), self.coordinates())
    }
}

impl Robot {
    /// Warns Python of the robot's cautions; returns the robot.
    fn cautioned(self, py: Python<'_>) -> PyResult<Self> {
        warn(py, self.model.robot.reading().cautions.iter().cloned())?;
        Ok(self)
    }

    fn of(py: Python<'_>, text: &str, path: &Path, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let model = Model::read(text, path, options)?;
        let asker = |aspect| Asker::new(&model.robot, Table::new(aspect, &model.robot, &model.options.feet, &[]));
        // A copy may be made later, for a process in another folder, and the caller's lists and dictionaries may change
        // before.
        let absolute = |path: &Path| {
            let here = |_| std::env::current_dir().map(|folder| folder.join("robot.urdf"));
            std::path::absolute(path).or_else(here).unwrap_or_else(|_| path.to_owned())
        };
        let copied = |options| {
            let copy = py.import("copy")?.call_method1("deepcopy", (options,))?;
            Ok::<_, PyErr>(copy.cast_into::<PyDict>()?)
        };
        let options = options.map(copied).transpose()?;
        if let Some(options) = &options
            && let Some(folders) = options.get_item("package_path")?
        {
            let folders = self::folders(&folders)?.iter().map(|own| absolute(own)).collect::<Vec<_>>();
            options.set_item("package_path", folders)?;
        }
        let source = (text.to_owned(), absolute(path), options.map(Bound::unbind));
        Ok(Self { impacts: asker(Aspect::Impact), forces: asker(Aspect::Forces), model: Arc::new(model), source })
    }

    fn one<'py>(
        slf: &Bound<'py, Self>,
        state: &Bound<'py, PyAny>,
        aspect: Aspect,
        mu: Option<&Bound<'py, PyAny>>,
        detail: Detail,
        next: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let text = to_json(state)?;
        let friction = mu.map(friction).transpose()?;
        let asked = Asked { aspect, friction, detail, next };
        let model = &slf.get().model;
        let answered = || model.answer(&text, asked, |state, _, _| state.scene.has_own_friction(friction));
        let (out, has_own) = without_python(py, answered)?.map_err(|error| refused_in(state, error))?;
        warn(py, notes::own_friction(has_own.into(), "state"))?;
        let kind = if aspect == Aspect::Impact { "impact" } else { "forces" };
        let mu = friction.map(|own| own.to_string());
        from_json(py, &out, Some((slf, kind, text, mu, None::<usize>, None::<f64>).into_pyobject(py)?.into_any()))
    }
}
