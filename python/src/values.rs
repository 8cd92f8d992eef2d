//! Python values as JSON and back, and refusals as exceptions.

use heelstrike::Error;
use heelstrike::cli::{Choices, named};
use heelstrike::read::documents::utf8;
use heelstrike::write::ErrorObject;
use pyo3::create_exception;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

create_exception!(
    heelstrike,
    Refused,
    PyValueError,
    "An input was refused; `place` names where and `hint` the remedy."
);

/// The exception of a refusal.
pub fn refused(error: Error) -> PyErr {
    let short = ErrorObject::new(&error);
    let shown = match error.remedy() {
        Some(remedy) => format!("{error}; {}", as_keywords(remedy)),
        None => error.to_string(),
    };
    let hint = short.hint.as_deref().map(as_keywords);
    let refused = Refused::new_err(shown);
    Python::attach(|py| {
        let value = refused.value(py);
        let _ = value.setattr("place", short.place).and_then(|()| value.setattr("hint", hint));
    });
    refused
}

/// The exception of a refusal of `value`. A dictionary has no text that anyone wrote, so line and column are left out.
pub fn refused_in(value: &Bound<'_, PyAny>, error: Error) -> PyErr {
    refused(if value.is_instance_of::<PyDict>() { error.nowhere() } else { error })
}

/// Adds the argument's name to Python's own exception for a wrong type.
pub fn of_argument(name: &str) -> impl Fn(PyErr) -> PyErr + '_ {
    move |error| {
        Python::attach(|py| match error.is_instance_of::<PyTypeError>(py) {
            true => PyTypeError::new_err(format!("{name}: {}", error.value(py))),
            false => error,
        })
    }
}

/// The value of the choice `name` of an argument.
pub fn choice<T: Copy>(what: &str, choices: Choices<T>, name: Option<&str>) -> PyResult<Option<T>> {
    let unknown = |name: &str, known| PyValueError::new_err(format!("{what} is {known}, not \"{name}\""));
    name.map(|name| named(choices, name).map_err(|known| unknown(name, known))).transpose()
}

/// The text with settings such as `velocity: central` in backticks written as keywords: `velocity="central"`. The format
/// of a table is no keyword, but follows from the name of its file.
pub fn as_keywords(text: &str) -> String {
    let is_word = |value: &str| value.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'_');
    let text = text.replace("say `input_format: ", "end the file's name in `.");
    let pieces = text.split('`').enumerate().map(|(at, piece)| match piece.split_once(": ") {
        Some(("feet", _)) if at % 2 == 1 => "feet=[{\"link\": ..., \"offset\": [x, y, z]}]".to_owned(),
        Some(("input_format", form)) if at % 2 == 1 => format!("--input-format {form}"),
        Some((name, value)) if at % 2 == 1 && value.parse::<f64>().is_ok() => format!("{name}={value}"),
        Some((name, value)) if at % 2 == 1 && is_word(value) => format!("{name}=\"{value}\""),
        _ => piece.to_owned(),
    });
    pieces.collect::<Vec<_>>().join("`")
}

/// Issues a Python warning for each note.
pub fn warn(py: Python<'_>, notes: impl IntoIterator<Item = String>) -> PyResult<()> {
    let warnings = py.import("warnings")?;
    notes.into_iter().try_for_each(|note| warnings.call_method1("warn", (as_keywords(&note),)).map(drop))
}

/// The JSON text of a value, in which NumPy's numbers and arrays count as Python's, or the text of a file.
pub fn to_json(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let json = value.py().import("heelstrike._values")?.call_method1("to_json", (value,))?;
    match json.cast::<PyBytes>() {
        Ok(bytes) => {
            utf8(bytes.as_bytes()).map(str::to_owned).map_err(|error| refused(error.in_file(value.to_string())))
        }
        Err(_) => json.extract(),
    }
}

/// The Python value of a JSON text, with what `heelstrike.plot` needs to draw it.
pub fn from_json<'py>(py: Python<'py>, text: &[u8], drawn: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
    py.import("heelstrike._values")?.call_method1("from_json", (text, drawn))
}
