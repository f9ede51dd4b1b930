//! Numbers of this law for its twin in the page, `sound-law.js`: a browser test compares it with the same file.
//!
//! Where they are meant to change, `CREPITUS_BLESS=1 cargo test -p crepitus-pages --lib twin` rewrites them.

use super::high_pass::HighPass;
use super::resampler::Resampler;
use super::sound::{PEAK, RATE_HZ};
use serde_json::{Value, json};
use std::convert::Infallible;
use std::path::Path;

const TICKS: u32 = 1_000;

/// Samples from one that is compared to the next.
const EVERY: usize = 24;

/// A sawtooth of the pitch of coarse crepitus, and a rustle.
fn torque_nm(tick: u32) -> f64 {
    0.4 * f64::from(tick % 629) / 629.0 + 0.05 * f64::from(tick * 7_919 % 1_000) / 1_000.0
}

fn above_30_hz_nm() -> Vec<f64> {
    let rate_hz = f64::from(RATE_HZ);
    let mut resampler = Resampler::new(20_000.0, rate_hz);
    let mut high_pass = HighPass::new(rate_hz);
    let mut heard = Vec::new();
    let mut take = |value| {
        heard.push(high_pass.next(value));
        Ok::<(), Infallible>(())
    };
    for tick in 0..TICKS {
        let Ok(()) = resampler.push(torque_nm(tick), &mut take);
    }
    heard
}

#[test]
fn the_twin_in_the_page_is_compared_with_these_numbers() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sound.json");
    let heard = above_30_hz_nm();
    if std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0") {
        let rounded = heard
            .iter()
            .step_by(EVERY)
            .map(|nm| (nm * 1e9).round() / 1e9);
        let golden = json!({
            "torque_nm": "of tick i: 0.4*(i%629)/629 + 0.05*(i*7919%1000)/1000",
            "ticks": TICKS,
            "every": EVERY,
            "peak": PEAK,
            "above_30_hz_nm": rounded.collect::<Vec<_>>(),
        });
        std::fs::write(&path, format!("{golden:#}\n")).unwrap();
    }
    let golden: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(golden["peak"], PEAK);
    let numbers = golden["above_30_hz_nm"].as_array().unwrap();
    assert_eq!(numbers.len(), heard.len().div_ceil(EVERY));
    for (number, nm) in numbers.iter().zip(heard.iter().step_by(EVERY)) {
        let number = number.as_f64().unwrap();
        assert!((number - nm).abs() < 1e-8, "{number} {nm}");
    }
}
