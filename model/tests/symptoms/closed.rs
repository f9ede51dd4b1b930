//! Closed forms.

use super::rig::*;

use crepitus_model::Sample;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::effects::texture::TextureSettings;

/// Within one tick, too, no beat begins once the muscle is let go.
#[test]
fn clonus_that_is_let_go_beats_no_more() {
    let settings = on!(clonus: ClonusSettings::default());
    // The second beat is due in the middle of a tick, and the joint passes 55° close to it.
    let due_s = 0.399_98;
    let start_s = due_s - 0.05 - 1.3 / 6.0;
    let most_deg = 60.0 + 150.0 * (0.2 - start_s);
    for late_s in [-15e-6, -5e-6, 5e-6, 15e-6] {
        let back_deg_s = (most_deg - 55.0) / (due_s + late_s - 0.25);
        let motion = |t: f64| {
            let deg_s = if t < 0.2 - 1e-9 {
                150.0
            } else if t < 0.25 - 1e-9 {
                0.0
            } else {
                -back_deg_s
            };
            let before_deg = 150.0 * (0.2 - t).max(0.0);
            let deg = most_deg - before_deg - back_deg_s * (t - 0.25).max(0.0);
            (deg.to_radians(), f64::to_radians(deg_s))
        };
        let run = only::<f64>(settings, motion(0.0).0.to_degrees()).run(0.5, motion);
        near(run.times(Word::Start)[0], start_s, 1e-9);
        near(run.times(Word::Stop)[0], due_s + late_s, 1e-9);
        let beats = run.times(Word::Beat).len();
        assert_eq!(beats, if late_s < 0.0 { 1 } else { 2 }, "{late_s} s");
        assert_eq!(run.at(0.44) != 0.0, late_s > 0.0);
    }
}

/// Of eight asperities three are there.
#[test]
fn texture_in_patches_creaks_and_glides() {
    let settings = on!(texture: TextureSettings {
        irregularity: 0.0,
        patch_deg: 12.0,
        patch_share: 0.375,
        ..TextureSettings::default()
    });
    assert_eq!(settings.texture.unwrap().patches(), (8, 3));
    let run = only::<f64>(settings, 0.5).run(2.0, ramp(0.5, 60.0));
    let snaps = run.times(Word::Snap);
    // 120 deg are ten patches of three.
    assert_eq!(snaps.len(), 30, "{snaps:?}");
    let gaps = snaps
        .windows(2)
        .map(|pair| ((pair[1] - pair[0]) * 40.0).round());
    assert_eq!(gaps.filter(|gap| *gap == 6.0).count(), 10, "{snaps:?}");
    let least = run
        .rows
        .iter()
        .filter(|row| row.0 > 1.0)
        .map(|row| row.2)
        .fold(f64::INFINITY, f64::min);
    near(least, 0.1, 1e-9);
}

/// In f32 a slow answer comes as near to the muscle's input as in f64: what it gains in a
/// tick is then less than the last digit of what it is.
#[test]
fn a_slow_reflex_is_as_exact_in_single_precision() {
    for activation_s in [0.01, 0.03] {
        let settings = on!(spasticity: SpasticitySettings {
            form: 1,
            gain_nm_per_rad: 20.0,
            velocity_shift_s: 0.1,
            activation_s,
            ..SpasticitySettings::default()
        });
        let motion = ramp(60.0, 100.0);
        let exact = only::<f64>(settings, 60.0).run(0.5, &motion);
        let single = only::<f32>(settings, 60.0).run(0.5, &motion);
        let errors = exact
            .rows
            .iter()
            .zip(&single.rows)
            .map(|(a, b)| (a.2 - b.2).abs());
        let worst_nm = errors.fold(0.0, f64::max);
        assert!(worst_nm < 2e-5, "{activation_s} s: {worst_nm:e}");
        assert!(exact.rows.last().unwrap().2 > 4.4);
    }
}

#[test]
fn asperities_go_on_below_zero_and_each_lets_go_of_its_height() {
    let settings = on!(texture: TextureSettings {
        irregularity: 0.0,
        ..TextureSettings::default()
    });
    // Up from -20.3 deg: 0.8 deg to the first one, and then each 1.5 deg; and down.
    for (from_deg, deg_s, jump_nm) in [(-20.3, 20.0, -0.3), (-20.2, -20.0, 0.3)] {
        let mut rig = only::<f64>(settings, from_deg);
        let motion = ramp(from_deg, deg_s);
        let mut snaps = Vec::new();
        for n in 0..8_000_u32 {
            let [from, to] = [n, n + 1].map(|tick| motion(f64::from(tick) * TICK_S));
            rig.step(from, to, to.0 - from.0);
            if let [(Word::Snap, share)] = rig.words[..] {
                snaps.push((f64::from(n) + share) * TICK_S);
                near(rig.jump_nm, jump_nm, 1e-6);
            } else {
                assert_eq!(rig.jump_nm, 0.0);
            }
        }
        assert_eq!(snaps.len(), 5);
        for (nth, time_s) in snaps.iter().enumerate() {
            near(*time_s, (0.8 + 1.5 * nth as f64) / 20.0, 1e-9);
        }
    }
}

/// Input of a muscle over a gap: it takes effect as late as any other, and nothing of it is lost.
#[test]
fn a_gap_leaves_a_reflex_as_late_as_it_is() {
    let settings = on!(spasticity: SpasticitySettings {
        form: 1,
        threshold_deg: 20.0,
        gain_nm_per_rad: 10.0,
        ..SpasticitySettings::default()
    });
    let motion = ramp(5.0, 40.0);
    let at = |tick: u32| motion(f64::from(tick) * TICK_S);
    let mut whole = only::<f64>(settings, 5.0);
    let mut gaps = only::<f64>(settings, 5.0);
    // Two ticks without a sample, and ten; the delay is of a thousand.
    let mut seen = 0;
    for tick in 0..12_000 {
        let nm = whole.step(at(tick), at(tick + 1), at(tick + 1).0 - at(tick).0);
        if (9_000..9_002).contains(&tick) || (11_000..11_010).contains(&tick) {
            let place = gaps.timing.sensing.position(at(seen).0);
            gaps.tick(Sample::Lost, place);
            continue;
        }
        let seen_nm = gaps.step(at(seen), at(tick + 1), at(tick + 1).0 - at(seen).0);
        seen = tick + 1;
        // Over a gap its input is that at the end of the gap: 0.35 mN·m a tick more, for two ticks
        // of the 200 in which the muscle follows.
        near(seen_nm, nm, 1e-5);
        assert!(tick < 9_000 || nm > 0.5, "{nm}");
    }
}
