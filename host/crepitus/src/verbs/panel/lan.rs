//! The address under which the page is served to a network.

use crate::failure::Failure;
use std::io;
use std::net::{AddrParseError, IpAddr, Ipv4Addr, UdpSocket};
use std::str::FromStr;

/// Address of this computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lan {
    /// The one of the interface that has the default route.
    Auto,
    /// This one.
    Address(IpAddr),
}

impl FromStr for Lan {
    type Err = AddrParseError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Address)
    }
}

impl Lan {
    /// The address itself.
    pub(super) fn address(self) -> Result<IpAddr, Failure> {
        match self {
            Self::Address(address) => Ok(address),
            Self::Auto => of_default_route().map_err(|error| {
                Failure::Input(format!(
                    "--lan auto: this computer is in no network ({error}): join one, or name the address under \
                     which phones reach it, as in --lan 192.168.1.20"
                ))
            }),
        }
    }
}

/// Address from which a datagram to any other network would go. None is sent: to connect a socket only chooses the
/// way, here to an address of examples (RFC 5737).
fn of_default_route() -> io::Result<IpAddr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9))?;
    Ok(socket.local_addr()?.ip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_number_or_auto() {
        let known = Lan::Address(IpAddr::V4(Ipv4Addr::new(192, 168, 1, 20)));
        assert_eq!("192.168.1.20".parse::<Lan>(), Ok(known));
        assert_eq!("auto".parse::<Lan>(), Ok(Lan::Auto));
        for wrong in ["", "Auto", "nowhere", "192.168.1"] {
            assert!(wrong.parse::<Lan>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn auto_is_an_address_of_this_computer_or_says_what_to_do() {
        match Lan::Auto.address() {
            Ok(address) => {
                assert!(!address.is_unspecified());
                assert!(UdpSocket::bind((address, 0)).is_ok(), "{address}");
            }
            Err(failure) => assert!(failure.into_text().contains("join one")),
        }
    }
}
