//! # Crepitus for Python
//!
//! The native half of the package `crepitus`: it converts, releases the GIL, and calls
//! the crates that the tool uses, too.
//!
//! ```text
//!  package/crepitus   what users see: types, docs, dicts
//!        │ numbers, texts, JSON      ↑ arrays that own their numbers, exceptions
//!  ┌─────┴───────────────────────────┴─────┐
//!  │ scene · run · studies · joint · device │  this crate
//!  └─────┬──────────────────────────────────┘
//!        crepitus-scene, -study, -sweep, -connection, -recording
//! ```
//!
//! **What takes time releases the GIL** and looks for signals twenty times a second, so
//! that Ctrl-C works. A panic becomes an exception; it does not end the interpreter.
//!
//! | to find | look in |
//! |---|---|
//! | values of Python as TOML | `values.rs` |
//! | scenes, what ships | `scene.rs`, `shipped.rs` |
//! | runs, the arrays of a trace | `run.rs`, `columns.rs` |
//! | studies | `studies.rs` |
//! | many runs of a scene | `sweep.rs`, `sweep_columns.rs` |
//! | commit, target and compiler | `build.rs` |
//! | a joint to step by hand, many of them | `joint.rs`, `joints.rs`, `rung.rs` |
//! | plants to step by hand | `plant.rs` |
//! | devices, what they are given | `device.rs`, `knee.rs` |
//! | experiments with people | `experiment.rs` |
//! | threads that share a device, its time and marks | `turns.rs`, `timeline.rs` |
//! | samples, recordings, examinations | `blocks.rs`, `following.rs`, `received.rs`, `samples.rs`, `export.rs`, `examination.rs` |
//! | a brace and a knee from measurements | `identify.rs` |

// Python hands its arguments over by value.
#![allow(clippy::needless_pass_by_value)]

mod blocks;
mod build;
mod columns;
mod device;
mod errors;
mod examination;
mod experiment;
mod export;
mod following;
mod identify;
mod joint;
mod joints;
mod knee;
mod plant;
mod received;
mod run;
mod rung;
mod samples;
mod scene;
mod shipped;
mod signals;
mod studies;
mod sweep;
mod sweep_columns;
mod timeline;
mod turns;
mod values;

use pyo3::prelude::*;

#[pymodule]
fn _crepitus(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<joint::Joint>()?;
    module.add_class::<joints::Joints>()?;
    module.add_class::<plant::Plant>()?;
    module.add_class::<device::Device>()?;
    module.add_class::<blocks::Blocks>()?;
    module.add_class::<experiment::Session>()?;
    module.add_function(wrap_pyfunction!(run::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(studies::accuracy, module)?)?;
    module.add_function(wrap_pyfunction!(studies::effects, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::run_points, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::run_design, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::repeat, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::read_sweep, module)?)?;
    module.add_function(wrap_pyfunction!(build::build, module)?)?;
    module.add_function(wrap_pyfunction!(export::export_parquet, module)?)?;
    module.add_function(wrap_pyfunction!(identify::fit, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(shipped::scenes, module)?)?;
    module.add_function(wrap_pyfunction!(shipped::presets, module)?)?;
    module.add_function(wrap_pyfunction!(shipped::parameters, module)?)?;
    module.add_function(wrap_pyfunction!(examination::examination, module)?)?;
    for function in [
        wrap_pyfunction!(experiment::experiment_results, module)?,
        wrap_pyfunction!(experiment::experiment_participants, module)?,
        wrap_pyfunction!(experiment::experiment_export, module)?,
        wrap_pyfunction!(experiment::experiment_delete, module)?,
        wrap_pyfunction!(experiment::experiment_deposit, module)?,
    ] {
        module.add_function(function)?;
    }
    module.add_function(wrap_pyfunction!(samples::read_recording, module)?)
}
