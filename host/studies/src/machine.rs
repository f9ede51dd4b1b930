//! Computer, clock and build on which a study measured its times.

use crepitus_scene::cpu_time::CLOCK;

/// The computer, as `summary.json` names it.
pub(crate) fn host() -> String {
    format!("{} {}", std::env::consts::ARCH, std::env::consts::OS)
}

/// Computer, clock and build, for a page.
pub(crate) fn measured_on() -> String {
    let build = if cfg!(debug_assertions) {
        "a debug build: times mean little"
    } else {
        "a release build"
    };
    format!("{}, {CLOCK}, {build}", host())
}
