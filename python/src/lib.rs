//! The Rust half of the Python package: it gives answers as dictionaries and arrays.
//!
//! ```text
//!     robot      URDF -> Robot; one state -> dictionary; inspection
//!     rows       arrays q, v -> rows on all cores -> Answers, by pipelines that are kept
//!     answers    the arrays of a batch, made when Python first asks for them
//!     study      sweeps, touchdowns, contact problems -> dictionaries
//!     picture    the same questions -> SVG and text
//!     watch      Ctrl-C and the budget of work
//! ```

mod answers;
mod picture;
#[expect(clippy::too_many_arguments, reason = "Python has them as keywords")]
mod robot;
mod rows;
mod study;
mod values;
mod watch;

use pyo3::prelude::*;

/// The functions and classes behind the package `heelstrike`.
#[pymodule(name = "_core")]
mod core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::answers::Answers;
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::study::solve;
    #[pymodule_export]
    use super::values::Refused;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// Run the command `heelstrike` with these arguments; the first one is the program's name.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| heelstrike::cli::main(arguments))
}
