//! Arming of the bench, as far as torque.

use super::*;

/// Without torque most of the drive would never be searched.
#[test]
fn all_that_arming_needs_arms() {
    let mut bench = Bench::new(&Boot {
        self_test: SelfTest::default(),
        identity: Identity::default(),
        counter: 0,
        start: 0,
        tick: 0,
        sequence: 0,
        crash: None,
    });
    for input in [&[8][..], &[2, 0, 31]] {
        bench.step(&mut Bytes::new(input));
    }
    assert_eq!(bench.drive.state(), State::Armed);
}
