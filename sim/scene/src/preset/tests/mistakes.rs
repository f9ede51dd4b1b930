//! Mistakes in a preset, each with the words of its error.

use super::parse;

#[test]
fn mistakes_are_named_with_line_key_and_remedy() {
    let wall = "[effects.range-limit]\n";
    for (text, parts) in [
        (
            "titel = \"x\"\n[effects.texture]\n",
            &["mine.toml, line 1", "`titel`", "did you mean title?"][..],
        ),
        ("title = \"x\"\n", &["`effects`", "missing"]),
        (
            "title = 3\n[effects.texture]\n",
            &["line 1: `title`", "a text in quotes is wanted"],
        ),
        (
            "feel = \"\"\n[effects.texture]\n",
            &["line 1: `feel`", "one line"],
        ),
        (
            "feel = \"a\\nb\"\n[effects.texture]\n",
            &["line 1: `feel`", "one line"],
        ),
        (
            "disorder = \"clonos\"\n[effects.clonus]\n",
            &["`disorder`", "did you mean clonus?"],
        ),
        (
            "evidence = \"good\"\n[effects.clonus]\n",
            &["`evidence`", "sourced, derived and estimate"],
        ),
        ("[effects]\n", &["line 1: `effects`", "no effect"]),
        ("[effects.wobble]\n", &["`effects.wobble`", "no such key"]),
        (
            "[effects.encoder]\n",
            &["line 1: `effects.encoder`", "sensor", "version = 1"],
        ),
        (
            "[effects.texture]\n[effects.limb]\n",
            &["line 2: `effects.limb`", "leg"],
        ),
        (
            "[effects.texture]\npeak_nm = 9\n",
            &["line 2: `effects.texture.peak_nm`", "up to 4"],
        ),
        (
            "[effects.texture]\npeak_nm = nan\n",
            &["line 2: `effects.texture.peak_nm`", "NaN"],
        ),
        (
            "[effects.texture]\npreset = \"coarse\"\n",
            &["line 2: `effects.texture.preset`", "texture-coarse"],
        ),
        (
            "[effects.spasticity]\nform = \"reflex\"\nvelocity_shift_s = 0.01\n",
            &["line 1: `effects.spasticity`", "reflex"],
        ),
        (
            &format!("{wall}extension_limit_deg = 118\n"),
            &["line 1: `effects.range-limit`", "5"],
        ),
        (
            "[effects.crepitus]\nconvention = \"physical\"\n",
            &["line 1: `effects.crepitus`", "frozen"],
        ),
        (
            "[effects.crepitus]\nkinetic_torque_nm = 0.5\n",
            &["`effects.crepitus`", "Tk ≤ Ts"],
        ),
        (
            "[effects.crepitus]\nstiffness_nm_per_rad = 1100\n[effects.texture]\n",
            &["`effects`", "1300 N·m/rad"],
        ),
        (
            "[effects.texture]\n[evidence_of.texture]\nseed = \"sourced\"\n",
            &["line 3: `evidence_of.texture.seed`", "no such key"],
        ),
        (
            "[effects.texture]\nseed = 2\n[evidence_of.clonus]\nbeats = \"sourced\"\n",
            &["line 3: `evidence_of.clonus`", "no such key"],
        ),
        (
            "[effects.texture]\nseed = 2\n[evidence_of.texture]\nseed = \"true\"\n",
            &["`evidence_of.texture.seed`", "estimate"],
        ),
        (
            "version = 1\n[effects.texture]\n",
            &["`version`", "no such key"],
        ),
    ] {
        let error = parse(text).expect_err(text).to_string();
        for part in parts {
            assert!(error.contains(part), "{text}{part}: {error}");
        }
    }
    let long = format!("feel = \"{}\"\n[effects.texture]\n", "x".repeat(121));
    let error = parse(&long).unwrap_err().to_string();
    assert!(
        error.contains("121 characters") && error.contains("120"),
        "{error}"
    );
}
