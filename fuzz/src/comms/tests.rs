//! Arming of the bench, as far as the enable line.

use super::*;

/// Without the line the laws about it would hold of themselves.
#[test]
fn what_arming_needs_turns_the_line_on() {
    let mut bench = Bench::new(&Boot {
        identity: Identity {
            schema: schema::HASH,
            ..Identity::default()
        },
        ..Boot::default()
    });
    bench.step(&mut Bytes::new(&[1, 0, 20]));
    bench.step(&mut Bytes::new(&[7, 240]));
    assert_eq!(bench.comms.state(), State::Armed);
    assert!(bench.line_is_on);
}
