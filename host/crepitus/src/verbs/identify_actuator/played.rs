//! A chirp that the device plays, and the current that it measures meanwhile.

#![expect(
    clippy::cast_precision_loss,
    reason = "counts of ticks; none comes near 2^53"
)]

use super::recorded::Measured;
use crate::cli::Arming;
use crate::failure::Failure;
use crate::following::{End, Follower, follow};
use crate::interrupt;
use crate::line::{Line, failure, failure_with};
use crate::output::to_stderr;
use crepitus_client::{Client, coil_fault_text};
use crepitus_identify::actuator::{Current, Hold, Series};
use crepitus_model::control::chirp::Chirp;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::telemetry::{
    BLOCK_SAMPLES, Block, COIL_TICKS, CoilCurrent, Sample, SampleFlags,
};
use crepitus_protocol::{DeviceSettings, TICK_S, TICKS_PER_S};
use std::io::{BufRead, stdin};
use std::time::Duration;

/// Ticks with the coil at rest, before and after the chirp.
const BEFORE: usize = TICKS_PER_S as usize / 5;
const AFTER: usize = TICKS_PER_S as usize * 3 / 5;

/// Ticks in which the chirp has to begin after it was accepted.
const BEGINS_WITHIN: usize = TICKS_PER_S as usize / 5;

/// Time after arming in which the coil has to be driven for [`BEFORE`] and [`BEGINS_WITHIN`], 0.4 s,
/// without a lost sample: without a fault it is at once.
const DRIVEN_WITHIN: Duration = Duration::from_secs(2);

/// Plays a chirp, and a second one once a mass is added.
pub(super) fn measured(
    client: &mut Client<Line>,
    chirp: PlayedChirp,
    zero: bool,
    with_added: bool,
) -> Result<Measured, Failure> {
    is_silent(client)?;
    let bare = play(client, chirp, zero)?;
    let with_added = if with_added {
        wait_for_added_mass()?;
        Some(play(client, chirp, false)?)
    } else {
        None
    };
    Ok(Measured { bare, with_added })
}

/// Refuses an actuator that is off, has a fault, or plays what the joint commands beside.
fn is_silent(client: &mut Client<Line>) -> Result<(), Failure> {
    refuse_coil_fault(client)?;
    let (_, values) = client.parameters().map_err(failure)?;
    let effects = DeviceSettings::of(&values)
        .map_err(|_| Failure::Work("the device's parameters contradict each other".to_owned()))?;
    let actuator = effects.effects.vibration_actuator;
    if actuator.is_some_and(|actuator| actuator.gain == 0.0) {
        return Ok(());
    }
    Err(Failure::Work(
        "the actuator has to be on, and silent but for the chirp: `crepitus params set \
         vibration-actuator.render=on vibration-actuator.gain=0`"
            .to_owned(),
    ))
}

/// Refuses a coil with a fault: it sleeps until `clear-fault`, and plays nothing.
fn refuse_coil_fault(client: &mut Client<Line>) -> Result<(), Failure> {
    let status = client.status().map_err(failure)?;
    if status.coil_fault == 0 {
        return Ok(());
    }
    Err(Failure::Work(coil_fault_text(status.coil_fault)))
}

/// Arms, plays one chirp, and disarms.
fn play(client: &mut Client<Line>, chirp: PlayedChirp, zero: bool) -> Result<Series, Failure> {
    client.subscribe().map_err(failure)?;
    let mut listening = Listening::new(chirp);
    let end = follow(client, None, Arming::armed(zero), &mut listening);
    // Samples after the chirp would pile up.
    client.unsubscribe().map_err(failure)?;
    match end? {
        End::Requested if interrupt::requested() => Err(Failure::Work(
            "interrupted: the chirp was stopped, and nothing is identified".to_owned(),
        )),
        End::Requested | End::Time => listening.series(),
    }
}

/// Waits for Enter between two chirps.
fn wait_for_added_mass() -> Result<(), Failure> {
    to_stderr("disarmed: fasten the added mass to the moving mass, then press Enter");
    let mut line = String::new();
    let read = stdin().lock().read_line(&mut line);
    if interrupt::requested() || !matches!(read, Ok(count) if count > 0) {
        return Err(Failure::Work(
            "no second chirp: nobody has said that the added mass is fastened".to_owned(),
        ));
    }
    Ok(())
}

/// Samples from before the chirp until the mass is at rest again.
struct Listening {
    chirp: PlayedChirp,
    is_asked: bool,
    /// Time of the first pause, which is right after arming.
    armed_at: Option<Duration>,
    /// Tick that the next block begins with.
    next_tick: Option<u64>,
    /// Samples were lost: no series.
    has_gap: bool,
    /// Whether a tick has played the chirp.
    chirped: Vec<bool>,
    /// Mean current of so many ticks, A.
    amperes: Vec<Option<f32>>,
    /// Ticks when the chirp was asked for.
    asked_at: usize,
}

impl Listening {
    fn new(chirp: PlayedChirp) -> Self {
        Self {
            chirp,
            is_asked: false,
            armed_at: None,
            next_tick: None,
            has_gap: false,
            chirped: Vec::new(),
            amperes: Vec::new(),
            asked_at: 0,
        }
    }

    fn first(&self) -> Option<usize> {
        self.chirped.iter().position(|played| *played)
    }

    fn last(&self) -> Option<usize> {
        self.chirped.iter().rposition(|played| *played)
    }

    /// The recording, if all of it is there.
    fn series(&self) -> Result<Series, Failure> {
        let work = |text: &str| Failure::Work(text.to_owned());
        let (Some(first), Some(last)) = (self.first(), self.last()) else {
            return Err(work(
                "the device has accepted the chirp, but has not played it",
            ));
        };
        if self.has_gap {
            return Err(work(
                "samples were lost while the chirp was played: play it again",
            ));
        }
        let settings = self.chirp.settings();
        let mut generator = Chirp::new(&settings).map_err(Failure::input)?;
        let ticks = last - first + 1;
        if ticks != settings.duration_ticks as usize {
            return Err(Failure::Work(format!(
                "the chirp has ended after {:.2} of {:.2} s: another program has committed vibration-actuator.gain, \
                 or the coil has a fault: see `crepitus info`",
                ticks as f64 * TICK_S,
                f64::from(settings.duration_ticks) * TICK_S
            )));
        }
        // In whole means of the current.
        let from = (first - BEFORE.min(first)).div_ceil(COIL_TICKS);
        let groups = self.chirped.chunks_exact(COIL_TICKS).zip(&self.amperes);
        let (mut volts, mut amperes) = (Vec::new(), Vec::new());
        for (played, current) in groups.skip(from) {
            let Some(current) = current else {
                // Disarmed, after the end.
                break;
            };
            let sum: f32 = (played.iter())
                .map(|played| if *played { generator.tick() } else { 0.0 })
                .sum();
            volts.push(f64::from(sum) / COIL_TICKS as f64);
            amperes.push(f64::from(*current));
        }
        if !generator.is_over() {
            return Err(work(
                "the coil's current was not measured all the time: see `crepitus doctor`",
            ));
        }
        let series = Series::new(TICK_S * COIL_TICKS as f64, &volts, &amperes)
            .map_err(|error| Failure::Work(error.to_string()))?;
        Ok(series.held(Hold {
            tick_s: TICK_S,
            current: Current::Ticks,
        }))
    }
}

impl Follower for Listening {
    fn block(&mut self, _: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.next_tick.is_some_and(|next| next != block.first_tick) {
            if self.is_asked {
                self.has_gap = true;
            }
            // Before the chirp nothing is lost by a new beginning.
            self.chirped.clear();
            self.amperes.clear();
            self.asked_at = 0;
        }
        self.next_tick = Some(block.first_tick + BLOCK_SAMPLES as u64);
        let has_chirped = |sample: &Sample| sample.flags.has(SampleFlags::CHIRP);
        self.chirped.extend(block.samples.iter().map(has_chirped));
        self.amperes
            .extend(block.coil_currents.map(CoilCurrent::amperes));
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        let driven = self
            .amperes
            .iter()
            .rev()
            .take_while(|a| a.is_some())
            .count()
            * COIL_TICKS;
        if !self.is_asked {
            if driven >= BEFORE + BEGINS_WITHIN {
                client
                    .play_chirp(self.chirp)
                    .map_err(|error| failure_with(client, error))?;
                self.is_asked = true;
                self.asked_at = self.chirped.len();
                to_stderr("playing the chirp; Ctrl-C disarms");
                return Ok(false);
            }
            let armed_at = *self.armed_at.get_or_insert(client.now());
            if client.now() > armed_at + DRIVEN_WITHIN {
                refuse_coil_fault(client)?;
                return Err(Failure::Work(format!(
                    "the coil is not driven without a pause within {} s of arming, so the chirp was not played: check \
                     that vibration-actuator.render is on and that no samples are lost, and see `crepitus doctor`",
                    DRIVEN_WITHIN.as_secs()
                )));
            }
            return Ok(false);
        }
        let now = self.chirped.len();
        Ok(match self.last() {
            None => now > self.asked_at + BEGINS_WITHIN,
            Some(last) => now > last + AFTER,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_client::Transport;
    use crepitus_client::connection::Simulated;
    use crepitus_model::control::chirp::ChirpSettings;
    use crepitus_protocol::State;
    use crepitus_protocol::parameters::find;
    use crepitus_scene::Overrides;
    use crepitus_scene::shipped::{self, Source};
    use std::path::Path;

    const CHIRP: PlayedChirp = PlayedChirp {
        amplitude_mv: 400,
        from_dhz: 80,
        to_dhz: 5000,
        duration_ms: 10_000,
    };

    fn client(scene: &Path) -> Client<Line> {
        let scene = shipped::scene(scene, &Overrides::default()).expect("a scene");
        let device = Simulated::of(&scene).expect("a device");
        Client::connect(Line::Simulated(Box::new(device))).expect("a connection")
    }

    /// Plays the chirp without the checks before it; the error, and how long it took.
    fn failed(client: &mut Client<Line>) -> (String, Duration) {
        let begun = client.now();
        let error = play(client, CHIRP, true).expect_err("nothing to play on");
        assert!(!client.is_armed());
        client.transport_mut().wait(Duration::from_millis(20));
        let status = client.status().expect("the status");
        assert_eq!(status.state, State::Disarmed);
        (error.into_text(), client.now().saturating_sub(begun))
    }

    #[test]
    fn the_chirp_of_these_tests_is_the_usual_one() {
        assert_eq!(CHIRP.settings(), ChirpSettings::default());
    }

    /// A faulted coil sleeps: the chirp was awaited for ever, armed.
    #[test]
    fn a_coil_with_a_fault_ends_the_wait() {
        let shipped = Source::find(Path::new("actuator-in-a-vice")).expect("a scene");
        let (broken, _) = (shipped.text)
            .split_once("[effects.vibration-actuator]")
            .expect("a coil");
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("broken.toml");
        std::fs::write(&file, broken).expect("a file");
        let mut client = client(&file);
        // The device believes in a coil that is not there.
        let on = ["render", "gain"].map(|key| find(&format!("vibration-actuator.{key}")));
        let on = on.map(|found| found.expect("a parameter").0);
        client.set(&[(on[0], 1.0), (on[1], 0.0)]).expect("set");
        for _ in 0..2 {
            let (text, took) = failed(&mut client);
            assert!(text.contains("of the coil"), "{text}");
            assert!(took < Duration::from_secs(3), "{took:?}");
        }
        let before = is_silent(&mut client).expect_err("a fault").into_text();
        assert!(before.contains("clear-fault"), "{before}");
    }

    #[test]
    fn a_coil_that_is_not_driven_ends_the_wait() {
        let (text, took) = failed(&mut client(Path::new("passive-examination")));
        assert!(text.contains("not driven"), "{text}");
        assert!(took < Duration::from_secs(3), "{took:?}");
    }
}
