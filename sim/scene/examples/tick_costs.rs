//! The page "What a tick costs": standard scenes, their instructions and their time, counted and
//! measured in one run of this program.
//!
//! ```text
//! CARGO_INCREMENTAL=0 cargo run -p crepitus-scene --example tick_costs > docs/generated/tick-costs.md
//! ```

use crepitus_model::Real;
use crepitus_scene::instructions;
use crepitus_scene::run::step_times;
use std::convert::Infallible;
use std::error::Error;

/// Steps of the shorter of the two runs that are counted.
const STEPS: u32 = 2_000;
const TIMINGS: u32 = 25;

fn main() -> Result<(), Box<dyn Error>> {
    let (names, scenes): (Vec<_>, Vec<_>) = instructions::standard()?.into_iter().unzip();
    if instructions::is_counted() {
        instructions::run_counted(&scenes, STEPS);
        return Ok(());
    }
    let nobody = std::iter::empty::<&str>();
    let program = std::env::current_exe()?;
    let counts = instructions::per_step(&program, nobody, (scenes.len(), STEPS))?;
    let Ok(times) = step_times(&scenes, TIMINGS, || Ok::<(), Infallible>(()));
    println!("{}", include_str!("tick_costs/before.md").trim_end());
    println!(
        "\n| a tick of | instructions | × motion | ns | × real time |\n|---|---:|---:|---:|---:|"
    );
    let alone = counts.first().copied().unwrap_or(f64::NAN);
    for (((name, scene), count), time) in names.iter().zip(&scenes).zip(&counts).zip(&times) {
        println!(
            "| {name} | {count:.0} | {:.1} | {:.0} | {} |",
            count / alone,
            time.ns,
            (scene.step_s() * 1e9 / time.ns).whole()
        );
    }
    println!("\n{}", include_str!("tick_costs/after.md").trim_end());
    Ok(())
}
