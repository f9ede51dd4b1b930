//! Motor and encoder turn the same way.

use super::finding::{Finding, Verdict};
use super::prepared::{Prepared, all_off};
use super::step::Step;
use crate::failure::Failure;
use crate::following::disarming;
use crate::line::{Line, failure};
use crepitus_client::connection::device_text;
use crepitus_client::{Client, Error};
use crepitus_protocol::Fault;

/// Arms with all effects off: the drive pushes, and compares the encoder with the motor by itself.
pub(super) fn found(client: &mut Client<Line>) -> Result<Finding, Failure> {
    let mut prepared = Prepared::new(client, &all_off())?;
    let finding = pushed(prepared.client());
    prepared.restored()?;
    finding
}

fn pushed(client: &mut Client<Line>) -> Result<Finding, Failure> {
    let (armed, status) = disarming(client, |client| {
        let armed = client.arm();
        Ok((armed, client.status().map_err(failure)?))
    })?;
    match armed {
        Ok(()) if status.polarity_proven => Ok(Finding::new(Step::Polarity, Verdict::Good)
            .remark("the drive armed; its push of 1.2 A moved the encoder the way it should")),
        Ok(()) => Ok(Finding::new(Step::Polarity, Verdict::Unknown)
            .remark("the drive armed, but its push did not move the encoder: nothing is proven")
            .remedy("let go of the joint, away from its stops, nothing hanging on it, and take the step again")),
        Err(Error::Refused(refused)) => {
            let bad = Finding::new(Step::Polarity, Verdict::Bad);
            if status.drive_fault == Fault::EncoderPolarity.code() {
                client.clear_fault().map_err(failure)?;
                return Ok(bad
                    .remark("the drive refused to arm: its push moved the encoder the wrong way (encoder-polarity)")
                    .remedy(
                        "if the step range is good, flexion counts up: swap the motor's two wires, behind the shunts, and nothing else; if \
                         range found the angle falling in flexion, swap A and B of the encoder and nothing else; then take the step zero again",
                    ));
            }
            let faults = device_text::faults(&status);
            let why = if faults.is_empty() { refused.to_string() } else { faults.join("; ") };
            Ok(bad.remark(why).remedy("remove the cause, `crepitus clear-fault`, and take the step again"))
        }
        Err(error) => Err(failure(error)),
    }
}
