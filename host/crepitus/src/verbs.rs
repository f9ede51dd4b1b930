//! Verbs of `crepitus`. A verb is one file: its arguments with their help,
//! and what it does. A new one is entered twice here: as a module and in the
//! list.

pub(crate) mod accuracy;
pub(crate) mod arm;
pub(crate) mod bring_up;
pub(crate) mod calibrate;
pub(crate) mod clear_fault;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod devices;
pub(crate) mod disarm;
pub(crate) mod doctor;
pub(crate) mod effects;
pub(crate) mod experiment;
pub(crate) mod export;
pub(crate) mod fit;
pub(crate) mod identify;
pub(crate) mod identify_actuator;
pub(crate) mod info;
pub(crate) mod knee;
pub(crate) mod laws;
pub(crate) mod monitor;
pub(crate) mod panel;
pub(crate) mod params;
pub(crate) mod presets;
pub(crate) mod record;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod scenes;
pub(crate) mod serve_sim;
pub(crate) mod stability;
pub(crate) mod stop;
pub(crate) mod stream;
pub(crate) mod sweep;
pub(crate) mod vibration;
pub(crate) mod zero;

use crate::failure::Failure;
use clap::Subcommand;

macro_rules! verbs {
    ($($verb:ident: $module:ident),* $(,)?) => {
        /// Verb of the command line, with its arguments.
        #[derive(Debug, Subcommand)]
        pub(crate) enum Verb {
            $($verb($module::Arguments)),*
        }

        impl Verb {
            /// Runs the verb.
            pub(crate) fn run(&self, as_json: bool) -> Result<(), Failure> {
                match self {
                    $(Self::$verb(arguments) => $module::run(arguments, as_json)),*
                }
            }
        }
    };
}

// In the order of `--help`.
verbs! {
    Demo: demo,
    Panel: panel,
    Monitor: monitor,
    Knee: knee,
    Devices: devices,
    Info: info,
    Doctor: doctor,
    Params: params,
    BringUp: bring_up,
    Calibrate: calibrate,
    Identify: identify,
    IdentifyActuator: identify_actuator,
    Fit: fit,
    Zero: zero,
    Arm: arm,
    Disarm: disarm,
    Stop: stop,
    ClearFault: clear_fault,
    Stream: stream,
    Record: record,
    Report: report,
    Export: export,
    ServeSim: serve_sim,
    Run: run,
    Sweep: sweep,
    Accuracy: accuracy,
    Stability: stability,
    Laws: laws,
    Effects: effects,
    Vibration: vibration,
    Experiment: experiment,
    Scenes: scenes,
    Presets: presets,
    Completions: completions,
}
