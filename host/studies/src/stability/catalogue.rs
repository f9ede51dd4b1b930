//! The catalogue of hard cases as data, in the order of their numbers.
//!
//! From H38 to H56 are those that were added to detect planted faults, from H57 on those
//! of symptoms besides crepitus, from H76 on those of the vibration actuator,
//! from H88 on those that others have found. A case that
//! ends in `L` is the long version of the one before it: hours of simulated
//! time. To add a case, write a function like its neighbours in the file of its
//! theme and give it a line in [`all`]; tests, matrix and report follow.

mod actuator;
mod arithmetic;
mod commits;
mod damping;
mod device;
mod encoder;
mod ends;
mod extremes;
mod gaps;
mod motions;
mod off_grid;
mod refusals;
mod reversals;
mod rounding;
mod steady;
mod symptom_energy;
mod symptom_muscles;
mod symptom_rigidity;
mod symptom_tools;
mod symptom_walls;
mod tank_empty;
mod ties;
mod time;
mod tools;

use super::case::Case;

pub(super) use actuator::NOMINAL as ACTUATOR;
pub(crate) use motions::WANDER;

/// All cases.
#[expect(clippy::too_many_lines, reason = "a list")]
pub fn all() -> Vec<Case> {
    vec![
        steady::constant_speed(),
        steady::mirror(),
        steady::rest(),
        steady::rest_long(),
        reversals::dwell(),
        reversals::reversal_in_stick(),
        reversals::velocity_jumps(),
        reversals::through_zero(),
        steady::equal_torques(),
        steady::nearly_equal_torques(),
        steady::no_kinetic_friction(),
        damping::near_critical_damping(),
        damping::strong_damping(),
        damping::strong_damping_long(),
        extremes::stiff(),
        extremes::light(),
        extremes::soft_and_strong(),
        reversals::fast_swing(),
        reversals::sudden_stop(),
        reversals::hard_braking(),
        time::step_length(),
        refusals::steps(),
        device::impossible_samples(),
        refusals::parameters(),
        time::a_day_short(),
        time::a_day(),
        time::no_clock(),
        encoder::counter_wrap(),
        encoder::quantised_velocity(),
        encoder::jitter_and_loss(),
        device::gap(),
        device::parameter_changes(),
        ties::grazing(),
        ties::simultaneous(),
        extremes::storm(),
        extremes::storm_long(),
        extremes::high_speed(),
        encoder::hand(),
        arithmetic::precisions(),
        arithmetic::golden(),
        device::shaking_hand(),
        gaps::gap_under_load(),
        gaps::losses_with_the_motion(),
        gaps::velocity_outliers(),
        gaps::encoder_bursts(),
        gaps::late_estimate(),
        commits::equal_torques_ramp(),
        commits::softer_under_load(),
        commits::stronger_in_a_slip(),
        commits::commits_while_blind(),
        commits::guard_memory(),
        ends::motion_ends_with_the_run(),
        ends::dead_object(),
        ends::event_cap(),
        ends::from_kinetic(),
        rounding::free_period(),
        rounding::subnormal_decay(),
        rounding::break_at_a_sample(),
        rounding::slip_without_lead(),
        gaps::retreat_in_a_gap(),
        symptom_walls::rest_on_a_wall(),
        symptom_walls::graze(),
        symptom_walls::moved_wall(),
        symptom_walls::stiffness_in_contact(),
        symptom_walls::both_limits(),
        symptom_rigidity::touched_limit(),
        symptom_rigidity::cogwheel_at_rest(),
        symptom_rigidity::cogwheel_reversal(),
        symptom_rigidity::texture(),
        symptom_rigidity::asperities_there_and_back(),
        symptom_muscles::dither_at_the_threshold(),
        symptom_muscles::last_condition(),
        symptom_muscles::late_in_counts(),
        symptom_muscles::turned_back(),
        symptom_muscles::clonus(),
        symptom_energy::returned_by_springs(),
        symptom_energy::returned_by_muscles(),
        symptom_energy::refused(),
        symptom_walls::pressed_rotor(),
        actuator::lets_go(),
        actuator::at_its_stops(),
        actuator::at_the_rail(),
        actuator::mean_step(),
        actuator::crawl(),
        actuator::hot_coil(),
        actuator::disarmed(),
        actuator::gain_ramp(),
        actuator::all_off(),
        actuator::lost_samples(),
        actuator::held_loop(),
        actuator::free_loop(),
        tank_empty::tank_empty(),
        off_grid::jump_within_a_step(),
        off_grid::two_limits_in_a_tick(),
        off_grid::clock_against_a_pause(),
        off_grid::armed_beyond(),
        off_grid::longer_than_a_pitch(),
        off_grid::irregular_delay(),
        off_grid::tremble_in_the_gap(),
    ]
}

/// Finds a case by its number or its name.
///
/// # Errors
/// Names similar to `wanted`, the likeliest first; none if none is.
pub fn find(wanted: &str) -> Result<Case, Vec<&'static str>> {
    let all = all();
    let wanted = wanted.to_lowercase();
    if let Some(case) = all
        .iter()
        .find(|case| case.name == wanted || case.id.to_lowercase() == wanted)
    {
        return Ok(case.clone());
    }
    let mut near: Vec<(usize, &'static str)> = all
        .iter()
        .map(|case| (strsim::levenshtein(case.name, &wanted), case.name))
        .filter(|(distance, name)| 2 * distance <= name.len() || name.contains(&wanted))
        .collect();
    near.sort_unstable();
    Err(near.into_iter().map(|(_, name)| name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_found_by_number_and_name_and_slips_of_the_pen_lead_there() {
        assert_eq!(find("h01").unwrap().name, "constant-speed");
        assert_eq!(find("constant-speed").unwrap().id, "H01");
        assert_eq!(find("constant-sped").unwrap_err()[0], "constant-speed");
        assert!(find("velocity").unwrap_err().len() > 1);
        assert_eq!(find("xyzzy").unwrap_err(), [""; 0]);
    }
}
