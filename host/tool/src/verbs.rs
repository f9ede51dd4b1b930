//! What `crepitus` can do: one file a verb.

pub(crate) mod accuracy;
pub(crate) mod completions;
pub(crate) mod effects;
pub(crate) mod presets;
pub(crate) mod run;
pub(crate) mod scenes;
pub(crate) mod stability;
