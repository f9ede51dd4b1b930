//! Steps on devices that nobody has seen before, and on some that are broken or break.

use super::finding::{Finding, Verdict};
use super::weight::Known;
use super::{connected, hanging, polarity, zero};
use crate::failure::Failure;
use crate::line::Line;
use crepitus_client::connection::Simulated;
use crepitus_client::{Client, Transport};
use crepitus_protocol::State;
use crepitus_protocol::parameters::find;
use crepitus_scene::{Overrides, shipped};
use crepitus_virtual_device::board::Board;
use crepitus_virtual_device::leg::EncoderWiring;
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::usbip::{Event, Server};
use crepitus_virtual_device::{Start, VirtualDevice};
use std::error::Error;
use std::path::Path;
use std::time::Duration;

/// Weight of the scene `weight-on-the-arm`.
const WEIGHT: Known = Known::new(0.61, 0.25, 0.01);

/// A device that breaks.
struct Breaking {
    device: VirtualDevice,
    /// Ticks with torque, after which it breaks.
    after: u64,
    driven: u64,
    how: fn(&mut Board),
}

impl CabledDevice for Breaking {
    fn tick(&mut self) {
        self.device.tick();
        self.driven += u64::from(self.device.board().is_driven());
        if self.driven == self.after {
            (self.how)(self.device.board_mut());
            self.after = u64::MAX;
        }
    }

    fn now(&self) -> u64 {
        CabledDevice::now(&self.device)
    }

    fn plug_in(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        CabledDevice::plug_in(&mut self.device)
    }

    fn host(&mut self) -> Option<&mut CdcHost> {
        CabledDevice::host(&mut self.device)
    }

    fn serve(&mut self, server: &mut Server) -> Vec<Event> {
        self.device.serve(server)
    }
}

/// A device with a weight on its arm, and these values of the scene; it breaks after so many ticks with torque.
fn device(set: Vec<(String, String)>, after: u64, how: fn(&mut Board)) -> Client<Line> {
    let overrides = Overrides {
        set,
        ..Overrides::default()
    };
    let scene = shipped::scene(Path::new("weight-on-the-arm"), &overrides).expect("a scene");
    let device = VirtualDevice::of(&scene, &Start::default()).expect("a device");
    let mut broken = Breaking {
        device,
        after,
        driven: 0,
        how,
    };
    if after == 0 {
        how(broken.device.board_mut());
        broken.after = u64::MAX;
    }
    let line = Line::Simulated(Box::new(Simulated::cabled(Box::new(broken))));
    let mut client = Client::connect(line).expect("a connection");
    client.subscribe().expect("samples");
    client
}

fn whole(settings: &[(&str, f64)]) -> Client<Line> {
    let set = settings
        .iter()
        .map(|(path, value)| ((*path).to_owned(), value.to_string()));
    device(set.collect(), u64::MAX, |_| {})
}

fn number(finding: &Finding, name: &str) -> (f64, f64) {
    let found = finding.values.iter().find(|value| value.name == name);
    let found = found.unwrap_or_else(|| panic!("{name} is not in {}", finding.text()));
    (found.value, found.half_width.unwrap_or_default())
}

/// The constant that the device believes in: that of the scene is the motor's.
fn believe(client: &mut Client<Line>, constant: f64) {
    let (id, _) = find("motor.torque_constant_nm_per_a").expect("a parameter");
    client.set(&[(id, constant)]).expect("a commit");
}

#[test]
fn hidden_devices_are_found() {
    let mut random = fastrand::Rng::with_seed(148);
    let mut between = |least: f64, most: f64| least + (most - least) * random.f64();
    let (mut all, mut inside) = (0, 0);
    for _ in 0..12 {
        let [friction, loss, constant] = [
            between(0.2, 0.45),
            between(0.1, 0.3),
            between(0.0355, 0.0425),
        ];
        let damping = between(0.0, 0.1);
        let settings = [
            ("effects.drivetrain.friction_nm", friction),
            ("effects.drivetrain.load_loss", loss),
            ("effects.drivetrain.inertia_kg_m2", between(0.03, 0.07)),
            ("effects.motor.torque_constant_nm_per_a", constant),
            ("effects.cuff.stiffness_nm_per_rad", between(60.0, 250.0)),
            ("effects.backlash.gap_deg", between(0.3, 2.0)),
            ("effects.limb.damping_nms_per_rad", damping),
        ];
        let mut client = whole(&settings);
        believe(&mut client, 0.0389);
        let before = client.parameters().expect("parameters").1;
        assert_eq!(
            zero::found(&mut client).expect("a zero").verdict,
            Verdict::Good
        );
        let finding = hanging::found(&mut client, &WEIGHT).expect("an experiment");
        assert_eq!(
            finding.verdict,
            Verdict::Good,
            "{settings:?} {}",
            finding.text()
        );
        assert_eq!(client.parameters().expect("parameters").1, before);
        assert_eq!(client.status().expect("a status").state, State::Disarmed);
        // At 8 deg/s what is viscous counts as dry.
        for (name, truth) in [
            ("torque constant", constant),
            ("load-dependent friction", loss),
            ("dry friction at 8 deg/s", friction + 0.14 * damping),
        ] {
            let (value, half_width) = number(&finding, name);
            all += 1;
            inside += u32::from((value - truth).abs() <= half_width);
            println!("{name}: {truth:.4} found {value:.4} ± {half_width:.4}");
        }
        let (_, half_width) = number(&finding, "torque constant");
        assert!(half_width < 0.03 * constant, "{}", finding.text());
    }
    println!("inside: {inside} of {all}");
    assert!(20 * inside >= 19 * all, "{inside} of {all}");
}

/// The other clamping: the upper half level, the weight hangs at 90° of flexion and is lifted into extension.
#[test]
fn a_weight_that_is_lifted_into_extension_shows_the_same() {
    let level = [
        ("effects.limb.posture", "\"sitting\""),
        ("effects.motor.torque_constant_nm_per_a", "0.0365"),
    ];
    let set = level.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let mut client = device(set.to_vec(), u64::MAX, |_| {});
    believe(&mut client, 0.0389);
    // The zero of the straight joint, from which the weight falls; until it hangs still.
    client.zero().expect("a zero");
    client.transport_mut().wait(Duration::from_secs(15));
    let finding = hanging::found(&mut client, &WEIGHT).expect("an experiment");
    let (value, half_width) = number(&finding, "torque constant");
    assert!(
        (value - 0.0365).abs() <= half_width && half_width < 0.0015,
        "{}",
        finding.text()
    );
    let (friction, half_width) = number(&finding, "dry friction at 8 deg/s");
    assert!((friction - 0.38).abs() <= half_width, "{}", finding.text());
    let (arc, _) = number(&finding, "moved by");
    assert!(arc > 45.0, "{}", finding.text());
}

#[test]
fn a_reversed_polarity_is_refused_by_the_drive() {
    let mut client = device(Vec::new(), 0, |board| {
        board.leg_mut().set_encoder_wiring(EncoderWiring::Swapped);
    });
    zero::found(&mut client).expect("a zero");
    let finding = polarity::found(&mut client).expect("an answer");
    assert_eq!(finding.verdict, Verdict::Bad);
    let text = finding.text();
    assert!(
        text.contains("encoder-polarity") && text.contains("swap the motor's two wires"),
        "{text}"
    );
    // Ready for the next try.
    assert_eq!(
        connected::found(&mut client).expect("a status").verdict,
        Verdict::Good
    );
    // The experiment is refused, too, and says why. The fault has taken the zero with it.
    zero::found(&mut client).expect("a zero");
    let refused = hanging::found(&mut client, &WEIGHT);
    assert!(
        matches!(&refused, Err(Failure::Work(text)) if text.contains("polarity")),
        "{refused:?}"
    );
}

#[test]
fn a_fault_in_the_middle_ends_the_torque_and_restores_the_parameters() {
    let unplug: fn(&mut Board) =
        |board| board.leg_mut().set_encoder_wiring(EncoderWiring::Unplugged);
    let mut client = device(Vec::new(), 80_000, unplug);
    zero::found(&mut client).expect("a zero");
    let before = client.parameters().expect("parameters").1;
    let Err(Failure::Work(text)) = hanging::found(&mut client, &WEIGHT) else {
        panic!("a weight was found without an encoder");
    };
    let status = client.status().expect("a status");
    assert_ne!(status.drive_fault, 0, "{text}");
    assert!(!client.is_armed() && status.state != State::Armed);
    assert!(text.contains("encoder") || text.contains("speed"), "{text}");
    assert_eq!(client.parameters().expect("parameters").1, before);
    let bad = connected::found(&mut client).expect("a status");
    assert_eq!(bad.verdict, Verdict::Bad);
    assert!(bad.text().contains("clear-fault"), "{}", bad.text());
}

#[test]
fn a_weight_that_is_too_heavy_is_not_lifted_beyond_what_the_motor_bears() {
    let mut client = whole(&[("effects.limb.body_mass_kg", 60.0)]);
    zero::found(&mut client).expect("a zero");
    let finding =
        hanging::found(&mut client, &Known::new(3.66, 0.25, 0.01)).expect("an experiment");
    assert_eq!(client.status().expect("a status").drive_fault, 0);
    assert_eq!(finding.verdict, Verdict::Unknown, "{}", finding.text());
    assert!(
        finding.text().contains("0.6 kg at 0.25 m"),
        "{}",
        finding.text()
    );
}
