//! Ctrl-C, SIGTERM and SIGHUP as a request to stop: torque is turned off, and
//! files are finished, or removed if they would be partial.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Set once a stop request was carried out, when [`forget`] resets it.
static WAS_CARRIED_OUT: AtomicBool = AtomicBool::new(false);

/// Installs the handlers, which set a flag.
///
/// A signal that comes while its handler is being installed would reach neither the handler nor
/// the system, so it waits for that long. That is so for the thread that calls this: programs
/// that arm or record call it before they have another one.
pub(crate) fn listen() {
    REQUESTED.get_or_init(|| {
        let requested = Arc::new(AtomicBool::new(false));
        held_back(|| {
            for signal in signals() {
                // Without a handler the signal kills the program; only the order of
                // its end is lost.
                let _ = signal_hook::flag::register(signal, requested.clone());
            }
        });
        // With a handler, a file that would be larger than it may be is an error of the write.
        #[cfg(unix)]
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
        requested
    });
}

/// Does something while the signals wait.
#[cfg(unix)]
fn held_back(work: impl FnOnce()) {
    use nix::sys::signal::{SigSet, SigmaskHow, Signal};
    let signals = signals().into_iter().flat_map(Signal::try_from);
    let before = signals
        .collect::<SigSet>()
        .thread_swap_mask(SigmaskHow::SIG_BLOCK);
    work();
    if let Ok(before) = before {
        let _ = before.thread_set_mask();
    }
}

#[cfg(not(unix))]
fn held_back(work: impl FnOnce()) {
    work();
}

/// Forgets a request that was carried out; the next one counts.
pub(crate) fn forget() {
    if let Some(requested) = REQUESTED.get() {
        let was_requested = requested.swap(false, Ordering::Relaxed);
        WAS_CARRIED_OUT.fetch_or(was_requested, Ordering::Relaxed);
    }
}

/// Returns whether a stop was ever requested, also one that was carried out since.
#[cfg(unix)]
pub(crate) fn ever_requested() -> bool {
    requested() || WAS_CARRIED_OUT.load(Ordering::Relaxed)
}

/// Requests a stop, as the signal does: for a Ctrl-C that arrived as a key.
pub(crate) fn request() {
    if let Some(requested) = REQUESTED.get() {
        requested.store(true, Ordering::Relaxed);
    }
}

/// Returns whether a stop was requested.
pub(crate) fn requested() -> bool {
    REQUESTED
        .get()
        .is_some_and(|requested| requested.load(Ordering::Relaxed))
}

/// Those that end a command in order. Interrupts count even where a program starts with them
/// ignored, as one in the background of a script does: torque is to end with that script's Ctrl-C.
#[cfg(unix)]
fn signals() -> Vec<i32> {
    use signal_hook::consts::SIGHUP;
    let mut signals = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP) {
        signals.push(SIGHUP);
    }
    signals
}

#[cfg(not(unix))]
fn signals() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}

/// Returns whether this program was started with the signal ignored, as by `nohup`.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
