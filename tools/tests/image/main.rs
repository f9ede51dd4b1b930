//! Images of this project and of others, against budgets: see each module.

mod budget_numbers;
mod common;
mod compiled;
mod compiler;
mod images;
mod library_panics;
mod planted;
mod shared_loops;
mod sizes;
