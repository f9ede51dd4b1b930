//! The device as a USB device, over USB/IP.

use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::output::to_stderr;
use crate::safe_text::message;
use crepitus_client::connection::Clock;
use crepitus_virtual_device::usb::usbip::{Event, Server};
use serde_json::json;
use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr};
use std::thread::sleep;
use std::time::Duration;

/// The port that USB/IP's clients expect.
const PORT: u16 = 3240;

/// Ticks in a frame of the bus, 1 ms.
const FRAME_TICKS: i64 = 20;

/// Parses the address to listen at; the port may be left out.
pub(super) fn address(text: &str) -> Result<SocketAddr, String> {
    let with_port = || Some(SocketAddr::new(text.parse::<IpAddr>().ok()?, PORT));
    text.parse().ok().or_else(with_port).ok_or_else(|| {
        format!("expected an IP address and a port such as 127.0.0.1:{PORT}, got {text:?}")
    })
}

/// Serves a device at this address until Ctrl-C. `frame` lets the server have the device's wire for a
/// frame; it returns what has happened, and the ticks of the device that have passed.
pub(super) fn serve(
    title: &str,
    address: SocketAddr,
    as_json: bool,
    mut frame: impl FnMut(&mut Server) -> (Vec<Event>, u64),
) -> Result<(), Failure> {
    let failed = |e: std::io::Error| match e.kind() {
        ErrorKind::AddrInUse => Failure::Input(format!(
            "--usbip {address}: another program listens there; choose another port (0 is any free one)"
        )),
        ErrorKind::AddrNotAvailable | ErrorKind::PermissionDenied => {
            Failure::Input(format!("--usbip {address}: {e}"))
        }
        _ => Failure::Work(format!("--usbip {address}: {e}")),
    };
    let mut server = Server::bind(address).map_err(failed)?;
    let address = server.local_address().map_err(failed)?;
    interrupt::listen();
    if !address.ip().to_canonical().is_loopback() {
        warn(format!(
            "USB/IP has no authentication and no encryption: any program that reaches {address} can use the \
             device and read what it sends"
        ));
    }
    if as_json {
        print_json(&json!({ "usbip": address, "bus_id": Server::BUS_ID, "scene": title }))?;
    } else {
        print(&format!(
            "{title} is offered over USB/IP at {address}, bus id {}\n\
             attach it as root: `modprobe vhci-hcd && {}`; Ctrl-C stops it\n",
            Server::BUS_ID,
            attach(address)
        ))?;
    }
    let mut clock = Clock::new();
    // Below zero while the device is ahead: a bus reset takes more than a frame.
    let mut due = 0;
    while !interrupt::requested() {
        due += i64::try_from(clock.due_ticks()).unwrap_or(i64::MAX);
        while due >= FRAME_TICKS && !interrupt::requested() {
            let (events, passed) = frame(&mut server);
            due -= i64::try_from(passed).unwrap_or(i64::MAX);
            events.iter().for_each(log);
        }
        sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// The command that attaches the device.
fn attach(address: SocketAddr) -> String {
    let ip = address.ip().to_canonical();
    let host = if ip.is_unspecified() {
        "ADDRESS-OF-THIS-COMPUTER".to_owned()
    } else {
        ip.to_string()
    };
    let port = match address.port() {
        PORT => String::new(),
        port => format!(" --tcp-port {port}"),
    };
    format!("usbip{port} attach -r {host} -b {}", Server::BUS_ID)
}

/// Logs to stderr when a client imports or releases the device, or is refused.
fn log(event: &Event) {
    let text = match event {
        Event::Imported { client } => format!("{client} has imported the device"),
        Event::Released { client, cause } => format!("{client} has released the device: {cause}"),
        Event::Refused { client, cause } => format!("{client} was refused: {cause}"),
        _ => return,
    };
    to_stderr(&format!("usbip: {}", message(&text)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_the_usual_port() {
        assert_eq!(address("127.0.0.1"), Ok("127.0.0.1:3240".parse().unwrap()));
        assert_eq!(address("[::1]:80"), Ok("[::1]:80".parse().unwrap()));
        assert_eq!(address("::1"), Ok("[::1]:3240".parse().unwrap()));
        for bad in ["", "localhost", "127.0.0.1:", "127.0.0.1:70000", ":3240"] {
            assert!(
                address(bad).unwrap_err().contains("127.0.0.1:3240"),
                "{bad}"
            );
        }
    }

    #[test]
    fn the_command_names_what_differs_from_the_default() {
        let attach = |text| attach(address(text).unwrap());
        assert_eq!(attach("127.0.0.1"), "usbip attach -r 127.0.0.1 -b 1-1");
        assert_eq!(
            attach("0.0.0.0:80"),
            "usbip --tcp-port 80 attach -r ADDRESS-OF-THIS-COMPUTER -b 1-1"
        );
    }
}
