use super::*;

const CONSTANT: &str = "
    title = 'Coarse'
    [threshold]
    preset = 'coarse'
    quantity = 'crepitus.static_torque_nm'
    reference = 0.4
    [threshold.constant]
    differences = [0.05, 0.1]
    repeats = 10
    catch_trials = 4
";

fn check(text: &str) -> Result<(), String> {
    let protocol = Protocol::from_toml(text).map_err(|error| error.to_string())?;
    protocol
        .check(Known::SHIPPED)
        .map_err(|error| error.to_string())
}

#[test]
fn every_kind_is_read_and_written() {
    for text in [
        CONSTANT,
        "title = 'T'\n[threshold]\nquantity = 'torque'\ndesign = '2afc'\n[threshold.staircase]\nrule = 'weighted'\n\
         target = 0.75\nstart = 0.2\nsteps = [0.1]\nscale = 'log'\nleast = 0.01\nmost = 1\nreversals = 8\ntrials = 60",
        "title = 'T'\n[abx]\ntrials = 20\na = { preset = 'coarse' }\n\
         b = { preset = 'coarse', device = 'brace-2', values = { 'crepitus.restart' = 1.0 } }",
        "title = 'T'\nconsent = 'c.txt'\n[realism]\npresets = ['coarse', 'fine']\nhealthy = 2\nfeatures = ['grating']",
    ] {
        assert_eq!(check(text), Ok(()), "{text}");
        let protocol = Protocol::from_toml(text).unwrap();
        let again = serde_json::to_string(&protocol).unwrap();
        assert_eq!(serde_json::from_str::<Protocol>(&again).unwrap(), protocol);
    }
}

#[test]
fn what_is_wrong_is_named() {
    let staircase = |change: &str| {
        format!(
            "title = 'T'\n[threshold]\nquantity = 'torque'\n[threshold.staircase]\nstart = 0.2\nleast = 0.01\n\
             most = 1\nreversals = 8\ntrials = 60\n{change}"
        )
    };
    for (text, expected) in [
        (
            "title = ''\n[realism]\npresets = ['coarse']".to_owned(),
            "`title` has 0 characters",
        ),
        ("title = 'T'".to_owned(), "got 0"),
        (
            CONSTANT.to_owned() + "[abx]\ntrials = 2\na = {}\nb = {}",
            "got 2",
        ),
        (
            CONSTANT.replace("0.05", "-0.05"),
            "all above 0 or all below",
        ),
        (CONSTANT.replace("0.05", "0.0"), "all above 0 or all below"),
        (CONSTANT.replace("0.05", "nan"), "all above 0 or all below"),
        (CONSTANT.replace("0.05", "0.1"), "twice"),
        (CONSTANT.replace("repeats = 10", "repeats = 0"), "0 trials"),
        (
            CONSTANT.replace("repeats = 10", "repeats = 5000"),
            "10004 trials",
        ),
        (
            CONSTANT.replace("'coarse'", "'corse'"),
            "did you mean coarse?",
        ),
        (
            CONSTANT.replace("repeats", "repeat"),
            "unknown field `repeat`",
        ),
        (CONSTANT.replace("0.4", "inf"), "`reference` is inf"),
        (staircase("rule = '1-up-2-down'\nsteps = []"), "`steps`"),
        (
            staircase("rule = '1-up-2-down'\nsteps = [-1]"),
            "`steps` is -1",
        ),
        (
            staircase("rule = '1-up-1-down'\nsteps = [1]"),
            "unknown variant",
        ),
        (
            staircase("rule = '1-up-2-down'\nsteps = [1]\ntarget = 0.8"),
            "`target` is 0.8",
        ),
        (
            staircase("rule = 'weighted'\nsteps = [1]"),
            "`target` is NaN",
        ),
        (
            staircase("rule = 'weighted'\nsteps = [1]\ntarget = 0.5"),
            "`target` is 0.5",
        ),
        (
            staircase("rule = '1-up-2-down'\nsteps = [1]").replace("start = 0.2", "start = 2"),
            "`start` is 2",
        ),
        (
            "title = 'T'\n[abx]\ntrials = 3\na = {}\nb = { preset = 'fine' }".to_owned(),
            "an even number",
        ),
        (
            "title = 'T'\n[abx]\ntrials = 2\na = {}\nb = {}".to_owned(),
            "twice",
        ),
        (
            "title = 'T'\n[realism]\npresets = ['fine', 'fine']".to_owned(),
            "twice",
        ),
        (
            "title = 'T'\n[realism]\npresets = []".to_owned(),
            "0 trials",
        ),
    ] {
        let error = check(&text).expect_err(&text);
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn a_device_refuses_values_that_it_cannot_render() {
    for (quantity, expected) in [
        (
            "crepitus.static_torque",
            "did you mean crepitus.static_torque_nm?",
        ),
        ("motor.bandwidth_hz", "the brace's own"),
        ("torque", "lead-pipe.torque_nm = 4.9: expected 0 to 4.5"),
    ] {
        let text = CONSTANT
            .replace("crepitus.static_torque_nm", quantity)
            .replace("0.4", "4.9");
        let error = check(&text).expect_err(quantity);
        assert!(
            error.contains(expected) || error.contains("motor.render"),
            "{error}"
        );
    }
    assert_eq!(values_of(TORQUE, 0.3)[0].0, "lead-pipe.render");
}

#[test]
fn examples_are_protocols() {
    for text in EXAMPLES {
        assert_eq!(check(text), Ok(()), "{text}");
    }
}
