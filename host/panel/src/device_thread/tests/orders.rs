//! Orders that flood the queue, and of whom they are.

use super::{Alone, device_thread, done, order, take_all};
use crate::request::Request;
use crate::tokens::Role;
use crate::watchdog::TIMEOUT;
use serde_json::Value;
use std::time::Duration;

/// A phone that joins again and again: neither the watchdog of the page in control nor a stop waits for it.
#[test]
fn a_flood_of_orders_delays_neither_supervision_nor_a_stop() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let [page, phone] = [shared.control.page(), shared.control.page()];
    device_thread.open_class(true);
    device_thread.client.zero().expect("a zero");
    done(&mut device_thread, page, Request::Take).expect("control");
    done(&mut device_thread, page, Request::Arm).expect("torque");
    shared.watchdog.made(1);
    std::thread::sleep(TIMEOUT + Duration::from_millis(20));
    let join = Request::Join {
        name: "Quokka".to_owned(),
        key: None,
    };
    let joined = |_| shared.order(join.clone(), phone, Role::Student);
    let mut joined: Vec<_> = (0..20_000).map(joined).collect();
    let last = joined.last_mut().expect("many").as_mut().expect("a queue");
    device_thread.step();
    assert!(last.try_recv().is_err(), "they wait");
    assert!(!device_thread.client.is_armed());
    assert_eq!(device_thread.torque.end()["cause"], "watchdog");
    let mut stopped = shared
        .order(Request::Stop, phone, Role::Student)
        .expect("a queue");
    device_thread.take_orders();
    assert_eq!(stopped.try_recv(), Ok(Ok(Value::Null)));
    assert!(last.try_recv().is_err(), "they wait");
}

/// Nobody answers for the torque then.
#[test]
fn while_control_passes_the_remote_has_to_wait() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let [page, other, remote] = [(); 3].map(|()| shared.control.page());
    done(&mut device_thread, page, Request::Take).expect("control");
    let worse = || {
        let severity = Request::Severity { worse: true };
        shared
            .order(severity, remote, Role::Remote)
            .expect("a queue")
    };
    let mut before = worse();
    take_all(&mut device_thread);
    assert!(before.try_recv().expect("an outcome").is_ok());
    let mut meanwhile = worse();
    drop(order(&shared, other, Request::Take));
    take_all(&mut device_thread);
    let outcome = meanwhile.try_recv().expect("an outcome");
    assert!(outcome.unwrap_err().contains("no page has control"));
}
