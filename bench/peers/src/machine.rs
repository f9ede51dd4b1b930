//! Computer, compiler and options that the times are of.

use crepitus_ladder::loops::BUILD;

/// All of it in one line.
pub fn line() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let checks = if BUILD.has_debug_assertions {
        "with debug assertions: times mean little"
    } else {
        "fat LTO, one codegen unit"
    };
    format!(
        "{}, {cores} cores, {}; {} for {}, optimisation level {}, {checks}, features {}",
        cpu_of(&text).unwrap_or("unknown processor"),
        std::env::consts::OS,
        BUILD.compiler,
        BUILD.target,
        BUILD.opt_level,
        BUILD.target_features
    )
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_names_processor_and_compiler() {
        let x86 = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: A fast one @ 2 GHz\n";
        assert_eq!(cpu_of(x86), Some("A fast one @ 2 GHz"));
        assert_eq!(cpu_of("model name\t:\n"), None);
        assert!(line().contains("rustc 1."), "{}", line());
    }
}
