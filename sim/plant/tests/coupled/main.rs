//! The coupled plant against what is known without it: closed forms, textbook
//! results and conservation laws. `-- --nocapture` prints the numbers found.

mod actuator;
mod backlash;
mod bridge;
mod convergence;
mod cuff;
mod drivetrain;
mod energy;
mod grip;
mod guiding_hand;
mod hand;
mod hard;
mod limb;
mod limb_stretch;
mod mirror;
mod motor;
mod random;
mod shell;
mod support;
