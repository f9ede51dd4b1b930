//! Samples that a device refuses: the torque meanwhile, and the energy.

use super::{assert_within_what_was_shown, simulate};
use crepitus_model::render::Limit;
use crepitus_scene::run::columns;
use crepitus_scene::{Overrides, Scene};
use std::path::Path;

/// A gap of some ticks in a scene of a drive on a shaft at 0.5 rad/s: the integral of its torque,
/// N·m·s, and for how many ticks it was held.
fn torque_over_a_gap(start_ticks: u32, gap_ticks: u32, ticks: u32) -> (f64, f64) {
    let time_s = |ticks: u32| f64::from(ticks) * 5e-5;
    let text = format!(
        "version = 1\ntitle = \"t\"\nduration_s = {}\ndevice = true\n[effects.crepitus]\n\
        [solver]\nkind = \"exact-events\"\nprecision = \"f32\"\nstep_s = 5e-5\n\
        [motion]\nkind = \"velocity-knots\"\nknots = [{{ t_s = 0, omega_rad_s = 0.5 }}, \
        {{ t_s = {}, omega_left_rad_s = 0.5, omega_right_rad_s = 5000.0 }}, \
        {{ t_s = {}, omega_left_rad_s = 5000.0, omega_right_rad_s = 0.5 }}, {{ t_s = 1.0, omega_rad_s = 0.5 }}]",
        time_s(ticks),
        time_s(start_ticks),
        time_s(start_ticks + gap_ticks),
    );
    let scene = Scene::parse(Path::new("t.toml"), &text, &Overrides::default()).unwrap();
    let column = columns(&scene).iter().position(|c| c.name == "limit");
    let holding = f64::from(Limit::Holding as u8);
    let (kept, summary) = simulate(&scene);
    let held = kept
        .rows
        .iter()
        .filter(|row| row[column.unwrap()] == holding);
    let mean_nm = summary.torque.unwrap().mean_nm;
    (
        mean_nm * time_s(ticks),
        time_s(u32::try_from(held.count()).unwrap()),
    )
}

/// Compares with closed forms: 400 N·m/rad at 0.5 rad/s, up to 0.4 N·m after 2 ms, then 0.2 N·m.
#[test]
fn the_torque_of_a_gap_is_what_was_held() {
    let rise = |from_nm: f64, time_s: f64| from_nm * time_s + 100.0 * time_s * time_s;
    let close = |(integral, _): (f64, f64), expected: f64, label: &str| {
        let off = (integral - expected).abs();
        assert!(
            off < 2e-9,
            "{label}: {integral:e} N·m·s, expected {expected:e}"
        );
    };
    for gap_ticks in [1, 2, 3, 5, 9] {
        // In stick at 0.2 N·m, from 1 ms on; what is caught up goes on, after more it begins
        // again at the end of a tick.
        let found = torque_over_a_gap(20, gap_ticks, 35);
        let held_s = if found.1 > 3.5 * 5e-5 {
            found.1 + 5e-5
        } else {
            found.1
        };
        assert!(found.1 > 0.0, "no sample was refused");
        let expected = 0.2 * held_s + rise(0.0, 35.0 * 5e-5 - held_s);
        close(found, expected, &format!("stick, {gap_ticks} ticks"));
        // In slip.
        let found = torque_over_a_gap(100, gap_ticks, 115);
        let rest_s = if found.1 > 3.5 * 5e-5 {
            14.0 * 5e-5 - found.1
        } else {
            0.0
        };
        let slip_s = 115.0 * 5e-5 - 2e-3 - rest_s;
        let expected = rise(0.0, 2e-3) + 0.2 * slip_s + rise(0.2, rest_s);
        close(found, expected, &format!("slip, {gap_ticks} ticks"));
    }
}

/// A shaft too fast to be believed: a drive holds its torque, lets go, and catches up or begins
/// again. What a summary says is what it showed, and the energy balances.
#[test]
fn samples_that_a_device_refuses_are_in_the_accounting() {
    const DEVICE: &str =
        "device = true\n[solver]\nkind = \"exact-events\"\nprecision = \"f32\"\nstep_s = 5e-5\n";
    for start_ms in 40..70 {
        for gap_ticks in [1, 2, 3, 20, 4000] {
            let start_s = f64::from(start_ms) * 1e-3;
            let end_s = start_s + f64::from(gap_ticks) * 5e-5;
            let text = format!(
                "version = 1\ntitle = \"t\"\nduration_s = 0.2\n{DEVICE}\n[effects.crepitus]\n[effects.encoder]\n\
                [motion]\nkind = \"velocity-knots\"\nknots = [{{ t_s = 0, omega_rad_s = 0.5 }}, \
                {{ t_s = {start_s:?}, omega_left_rad_s = 0.5, omega_right_rad_s = 5000.0 }}, \
                {{ t_s = {end_s:?}, omega_left_rad_s = 5000.0, omega_right_rad_s = 0.5 }}, {{ t_s = 1.0, omega_rad_s = 0.5 }}]"
            );
            let scene = Scene::parse(Path::new("t.toml"), &text, &Overrides::default()).unwrap();
            let columns = columns(&scene);
            let shown = columns
                .iter()
                .position(|c| c.name == "shown_nm")
                .expect("a device");
            let (kept, summary) = simulate(&scene);
            let torque = summary.torque.expect("a joint");
            let label = format!("{start_ms} ms, {gap_ticks} ticks");
            assert_within_what_was_shown(&torque, &label);
            let sum: f64 = kept.rows.iter().map(|row| row[shown]).sum();
            let mean_nm = sum / f64::from(u32::try_from(kept.rows.len()).unwrap());
            assert!(
                (torque.mean_nm - mean_nm).abs() < 2e-3,
                "{label}: {torque:?}, {mean_nm} N·m shown"
            );
            let energy = summary.energy.expect("a joint");
            // Of steps in f32, and of some that were caught up at once.
            assert!(energy.residual_relative.abs() < 1e-5, "{label}: {energy:?}");
        }
    }
}
