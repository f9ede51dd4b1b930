//! Computer, clock and build on which a study measured its times.

use crepitus_ladder::loops::BUILD;
use crepitus_scene::cpu_time::CLOCK;
use serde::Serialize;
use std::sync::LazyLock;

/// The computer and the build.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Model of the processor; `unknown` where the system does not tell.
    pub cpu: String,
    /// Architecture and operating system.
    pub system: String,
    /// Cores that the program may use.
    pub cores: usize,
    /// Compiler and its version.
    pub compiler: &'static str,
    /// Target triple.
    pub target: &'static str,
    /// Optimisation level of the loops that are timed.
    pub opt_level: &'static str,
    /// Features of the target that the compiler may use.
    pub target_features: &'static str,
    /// Whether debug assertions are compiled in: times mean little then.
    pub debug_assertions: bool,
    /// Clock of the times.
    pub clock: &'static str,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        Self {
            cpu: CPU.clone(),
            system: host(),
            cores: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            compiler: BUILD.compiler,
            target: BUILD.target,
            opt_level: BUILD.opt_level,
            target_features: BUILD.target_features,
            debug_assertions: BUILD.has_debug_assertions,
            clock: CLOCK,
        }
    }
}

/// Model of the processor.
static CPU: LazyLock<String> = LazyLock::new(|| {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    cpu_of(&text).unwrap_or("unknown").to_owned()
});

/// The model in a text of `/proc/cpuinfo`; that of an ARM core is on another line.
fn cpu_of(text: &str) -> Option<&str> {
    let line = |key: &str| {
        let mut lines = text.lines().filter_map(|line| line.split_once(':'));
        let found = lines.find(|(name, _)| name.trim() == key);
        found.map(|(_, value)| value.trim())
    };
    line("model name")
        .or_else(|| line("Model"))
        .filter(|model| !model.is_empty())
}

/// Architecture and operating system, for a summary without times.
pub(crate) fn host() -> String {
    format!("{} {}", std::env::consts::ARCH, std::env::consts::OS)
}

/// Computer, clock and build, for a page.
pub(crate) fn measured_on() -> String {
    let machine = Machine::here();
    let build = if machine.debug_assertions {
        "a debug build: times mean little"
    } else {
        "a release build"
    };
    format!(
        "{}, {}, {CLOCK}, {build}, {}, loops at optimisation level {}",
        machine.cpu, machine.system, machine.compiler, machine.opt_level
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_processor_is_named_by_its_model() {
        let x86 =
            "processor\t: 0\nvendor_id\t: A\nmodel\t\t: 85\nmodel name\t: A fast one @ 2 GHz\n";
        assert_eq!(cpu_of(x86), Some("A fast one @ 2 GHz"));
        let arm = "processor\t: 0\nBogoMIPS\t: 108\n\nModel\t\t: A board\n";
        assert_eq!(cpu_of(arm), Some("A board"));
        assert_eq!(cpu_of("model name\t:\n"), None);
        assert_eq!(cpu_of(""), None);
    }

    #[test]
    fn the_build_is_known() {
        let machine = Machine::here();
        assert!(machine.compiler.starts_with("rustc 1."), "{machine:?}");
        assert!(machine.target.contains(std::env::consts::ARCH));
        assert!(measured_on().contains(machine.compiler));
    }
}
