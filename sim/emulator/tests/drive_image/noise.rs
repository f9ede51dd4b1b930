//! Noise of the converters, as it reaches the controller.

use crate::host::{Host, examination, image};

/// Standard deviation of a conversion, in counts.
const NOISE: f64 = 3.0;

/// Conversions whose mean is the current of a tick.
const SAMPLES: f64 = 4.0;

/// A count, mA.
const COUNT_MA: f64 = 1e3 * 3.3 / 4096.0 / (20.0 * 0.033);

/// Ticks that are measured: their deviation is known to 1 %.
const TICKS: u64 = 20_000;

/// Standard deviation of the current in the drive's samples while no current flows, mA.
fn deviation_ma(noise: Option<f64>) -> Option<f64> {
    let mut host = Host::new(&image()?, &examination());
    if let Some(counts) = noise {
        host.board.mcu_mut().set_converter_noise(counts);
    }
    host.run(500);
    host.blocks.clear();
    host.run(TICKS);
    let samples = host.blocks.iter().flat_map(|block| block.samples);
    let currents: Vec<f64> = samples.map(|sample| sample.current_ma.into()).collect();
    assert!(currents.len() as u64 > TICKS - 200);
    #[expect(clippy::cast_precision_loss, reason = "some thousands")]
    let count = currents.len() as f64;
    let mean = currents.iter().sum::<f64>() / count;
    let squares: f64 = currents.iter().map(|ma| (ma - mean).powi(2)).sum();
    Some((squares / count).sqrt())
}

#[test]
fn the_current_of_a_tick_has_half_the_noise_of_a_conversion() {
    let Some(quiet_ma) = deviation_ma(None) else {
        return;
    };
    assert!(quiet_ma.abs() < 1e-6, "{quiet_ma}");
    let Some(noisy_ma) = deviation_ma(Some(NOISE)) else {
        return;
    };
    // The step of the converter, in each of its samples; that of telemetry, 1 mA.
    let step = 1.0 / 12.0;
    let conversion_ma = COUNT_MA * (NOISE.powi(2) + step).sqrt();
    let expected_ma = (conversion_ma.powi(2) / SAMPLES + step).sqrt();
    println!("noise of a conversion: {conversion_ma:.2} mA; of a tick: {noisy_ma:.2} mA");
    assert!((noisy_ma / expected_ma - 1.0).abs() < 0.03, "{expected_ma}");
    assert!(noisy_ma < 0.53 * conversion_ma);
}

/// 3 counts a conversion are 12 mN·m at the joint.
#[test]
fn it_arms_with_noise() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.board.mcu_mut().set_converter_noise(NOISE);
    host.arm();
    host.run_until_torque();
    host.run(2_000);
    assert!(host.board.is_driven());
}
