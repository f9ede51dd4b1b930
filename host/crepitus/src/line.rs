//! Connections: the device that the arguments name, and the failures of its requests.

use crate::cli::{Arming, DeviceArguments};
use crate::failure::Failure;
pub(crate) use crepitus_client::connection::Connection as Line;
use crepitus_client::connection::{OpenError, is_in_this_process, is_input};
use crepitus_client::sharing::Program;
use crepitus_client::{Client, Error, Management, RequestKind, TransportError};
use crepitus_protocol::Session;
use crepitus_protocol::host::Refusal;
use crepitus_scene::{Overrides, Scene, SceneError, shipped};
use std::path::Path;

/// The scene of a device in this process.
const SCENE: &str = "passive-examination";

/// Opens the connection to the device that the arguments name.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Line, Failure> {
    opened(arguments, false, usual_scene)
}

/// Opens it for a command that arms like this. Where it sets the zero before, the leg of a device
/// in this process begins straight: the device has the angles of the scene then.
pub(crate) fn open_to_arm(arguments: &DeviceArguments, arming: Arming) -> Result<Line, Failure> {
    let begins_straight = arming.arm && arming.zero;
    opened(arguments, begins_straight, usual_scene)
}

/// Opens it for the panel; a device in this process is not faster than real time, and its leg begins
/// straight. Without a scene an examiner chooses the motion by the knee that is on the device.
pub(crate) fn open_examined(arguments: &DeviceArguments) -> Result<Line, Failure> {
    opened(arguments, true, shipped::examination).map(Line::in_real_time)
}

fn usual_scene() -> Result<Scene, SceneError> {
    shipped::scene(Path::new(SCENE), &Overrides::default())
}

fn opened(
    arguments: &DeviceArguments,
    begins_straight: bool,
    default: impl FnOnce() -> Result<Scene, SceneError>,
) -> Result<Line, Failure> {
    let device = arguments.device.as_deref();
    if let Some(scene) = &arguments.scene
        && !device.is_some_and(is_in_this_process)
    {
        return Err(Failure::Input(format!(
            "--scene {}: only a simulated device of this command has a scene: give --device sim or --device \
             emulated, or leave it out",
            scene.display()
        )));
    }
    let scene = || {
        let scene = match &arguments.scene {
            Some(scene) => shipped::scene(scene, &Overrides::default()),
            None => default(),
        };
        scene.map(|scene| Scene {
            begins_straight,
            ..scene
        })
    };
    Line::open(device, &command_line(), scene).map_err(not_open)
}

/// Opens it for a stop, also where it cannot be shared.
pub(crate) fn manage_to_stop(arguments: &DeviceArguments) -> Result<Management<Line>, Failure> {
    let device = arguments.device.as_deref();
    if device.is_some_and(is_in_this_process) {
        return manage(arguments);
    }
    let line = Line::open_to_stop(device, &command_line()).map_err(not_open)?;
    Ok(Management::new(line))
}

/// That a program hangs is no mistake of the user's.
fn not_open(error: OpenError) -> Failure {
    match error {
        OpenError::Transport(TransportError::Hangs { .. }) => Failure::Work(error.to_string()),
        error => Failure::input(error),
    }
}

/// Opens the connection; a device in this process is not faster than real time.
pub(crate) fn open_in_real_time(arguments: &DeviceArguments) -> Result<Line, Failure> {
    open(arguments).map(Line::in_real_time)
}

/// Opens the connection and performs the handshake.
pub(crate) fn connect(arguments: &DeviceArguments) -> Result<Client<Line>, Failure> {
    Client::connect(open(arguments)?).map_err(failure)
}

/// Opens the connection like [`open_to_arm`], and performs the handshake.
pub(crate) fn connect_to_arm(
    arguments: &DeviceArguments,
    arming: Arming,
) -> Result<Client<Line>, Failure> {
    Client::connect(open_to_arm(arguments, arming)?).map_err(failure)
}

/// The devices that the arguments name: without a name, all that are attached, or none, whose
/// opening says so.
pub(crate) fn attached(arguments: &DeviceArguments) -> Result<Vec<DeviceArguments>, Failure> {
    let ports = match &arguments.device {
        Some(_) => Vec::new(),
        None => Line::attached().map_err(Failure::input)?,
    };
    if ports.is_empty() {
        return Ok(vec![arguments.clone()]);
    }
    let named = |port| DeviceArguments {
        device: Some(port),
        ..arguments.clone()
    };
    Ok(ports.into_iter().map(named).collect())
}

/// Opens the connection to a device of any version.
pub(crate) fn manage(arguments: &DeviceArguments) -> Result<Management<Line>, Failure> {
    Ok(Management::new(open(arguments)?))
}

/// A rejected request is failed work (exit code 1); invalid values and unknown
/// parameters are bad input (2).
#[expect(
    clippy::needless_pass_by_value,
    reason = "used where errors are mapped"
)]
pub(crate) fn failure(error: Error) -> Failure {
    let text = error.to_string();
    if is_input(&error) {
        Failure::Input(text)
    } else {
        Failure::Work(text)
    }
}

/// [`failure`]; a device that another program has armed is reported with that
/// program's name.
pub(crate) fn failure_with(client: &mut Client<Line>, error: Error) -> Failure {
    let Error::Refused(refused) = &error else {
        return failure(error);
    };
    let Refusal::Leased { by } = refused.refusal else {
        return failure(error);
    };
    let request = refused.request;
    let Some(other) = holder(client, by) else {
        return failure(error);
    };
    let way_out = if request == RequestKind::Disarm {
        "`crepitus disarm --force` or `crepitus stop` turns its torque off"
    } else {
        "end that program, or run `crepitus stop`"
    };
    Failure::Work(format!(
        "`{request}` is rejected: {} has armed the device; {way_out}",
        named(&other)
    ))
}

/// The program of a session, if it is connected to the same device.
pub(crate) fn holder(client: &mut Client<Line>, session: Session) -> Option<Program> {
    let programs = client.transport_mut().programs();
    programs.into_iter().find(|p| p.session == Some(session))
}

/// A program for people.
pub(crate) fn named(program: &Program) -> String {
    format!("`{}`, process {},", program.name, program.pid)
}

/// Command line as the user typed it, by which other programs name this one.
fn command_line() -> String {
    let arguments = std::env::args_os().skip(1);
    let words = arguments.map(|argument| argument.to_string_lossy().into_owned());
    ["crepitus".to_owned()]
        .into_iter()
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}
