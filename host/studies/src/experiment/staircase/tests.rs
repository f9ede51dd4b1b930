use super::*;

fn plan(rule: Rule) -> Staircase {
    Staircase {
        rule,
        start: 8.0,
        steps: vec![2.0, 1.0],
        scale: Scale::Linear,
        least: 1.0,
        most: 12.0,
        reversals: 4,
        trials: 40,
        interleaved: 1,
        target: (rule == Rule::Weighted).then_some(0.75),
    }
}

/// Levels at which these answers are given, and the one after them.
fn levels(plan: &Staircase, answers: &str) -> Vec<f64> {
    let mut track = Track::new(plan);
    let mut levels = vec![track.level];
    for answer in answers.chars() {
        track.answer(plan, answer == '+');
        levels.push(track.level);
    }
    levels
}

#[test]
fn two_right_answers_go_down_and_a_wrong_one_up() {
    let levels = levels(&plan(Rule::TwoDown), "++++-+-++");
    assert_eq!(levels, [8.0, 8.0, 6.0, 6.0, 4.0, 5.0, 5.0, 6.0, 6.0, 5.0]);
}

#[test]
fn unequal_steps_balance_at_the_target() {
    let plan = plan(Rule::Weighted);
    // Up is three times down; the first turn makes both smaller.
    assert_eq!(levels(&plan, "+-+"), [8.0, 6.0, 9.0, 8.0]);
    assert_eq!(plan.target(), 0.75);
}

#[test]
fn log_steps_are_decades_and_limits_hold() {
    let mut plan = plan(Rule::Weighted);
    plan.scale = Scale::Log;
    plan.steps = vec![0.5];
    let levels = levels(&plan, "+++-");
    assert!((levels[1] - 8.0 / 10.0_f64.sqrt()).abs() < 1e-11);
    assert_eq!(levels[2..], [1.0, 1.0, 12.0]);
}

#[test]
fn it_ends_after_reversals_or_trials() {
    let plan = plan(Rule::TwoDown);
    let mut track = Track::new(&plan);
    let mut turned = Vec::new();
    for answer in "++-++-++-".chars() {
        assert!(!track.is_over(&plan));
        turned.push(track.answer(&plan, answer == '+'));
        if track.is_over(&plan) {
            break;
        }
    }
    assert_eq!(track.reversals, [6.0, 7.0, 6.0, 7.0]);
    let turns = [false, false, true, false, true, true, false, true];
    assert_eq!(turned, turns);
    let mut track = Track::new(&plan);
    for _ in 0..40 {
        track.answer(&plan, true);
    }
    assert!(track.is_over(&plan) && track.reversals.is_empty());
}

/// A stationary observer is held at the target of the rule.
#[test]
fn each_rule_converges_where_it_says() {
    use crate::experiment::order::SplitMix64;
    for rule in Rule::ALL {
        let mut plan = plan(rule);
        plan.steps = vec![0.1];
        (plan.least, plan.most) = (0.001, 20.0);
        let mut track = Track::new(&plan);
        let mut random = SplitMix64::new(3);
        let (mut sum, mut count) = (0.0, 0.0);
        for trial in 0..60_000 {
            let p = 0.5 + 0.5 / (1.0 + (-(track.level - 8.0)).exp());
            if trial > 500 {
                sum += p;
                count += 1.0;
            }
            let drawn = random.below(1 << 32) as f64 / 4_294_967_296.0;
            track.answer(&plan, drawn < p);
        }
        let mean = sum / count;
        assert!(
            (mean - plan.target()).abs() < 0.012,
            "{}: {mean}",
            rule.name()
        );
    }
}
