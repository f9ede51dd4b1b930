//! What `crepitus` can do: one file a verb.

pub(crate) mod accuracy;
pub(crate) mod completions;
pub(crate) mod control;
pub(crate) mod demo;
pub(crate) mod devices;
pub(crate) mod doctor;
pub(crate) mod effects;
pub(crate) mod info;
pub(crate) mod params;
pub(crate) mod presets;
pub(crate) mod record;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod scenes;
pub(crate) mod serve_sim;
pub(crate) mod stability;
pub(crate) mod stream;
