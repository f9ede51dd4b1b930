//! The study of what accuracy costs for every friction law that haptics uses.
//!
//! ```text
//! law × joint × task ──> f32 at the device's tick ──> value ─────┐
//!                   └──> f64, steps ever finer ──> converged ────┤
//! closed form, or the event-driven reference ──> demanded ───────┴─> rows ─┬─> leaderboard.csv
//!                                                                          └─> order, answers
//! model error = converged − demanded        numerical error = value − converged
//! ```
//!
//! What is demanded is what a device is to render: the paper's joint, which grates throughout a pass
//! of the knee. That is the convention `frozen`. An inertia on a spring does the same only while the
//! shaft accelerates slowly: once Ω·Ω̇ is more than (Ts − Tk)²·ωn/(4π·J·kr), the velocities no
//! longer meet, and it slips on. So a law on an object, and our own conventions `paper` and `physical`,
//! have a model error in a fast pass, and none in a slow one. Every other demand is the same in the
//! three conventions.
//!
//! | to find | look in |
//! |---|---|
//! | who is judged: an entry of the ladder, or a law of one's own | [`contestant`] |
//! | a law on its way through a task | [`runner`] |
//! | what a task is, and all of them | [`task`], [`tasks`] |
//! | cycles counted in a torque | [`cycles`] |
//! | closed forms of our joint | [`closed_forms`] |
//! | the whole study and its rows | [`study`], [`row`] |
//! | time, memory and controller cycles of a step | [`costs`] |
//! | order of the laws, and which to take for what | [`ranking`] |
//! | the files | [`law_tables`] |
//! | the laws on the controller | [`controller`] |
//! | the page, and what is said of the study | [`report`], [`words`] |

pub mod closed_forms;
pub mod contestant;
pub mod controller;
pub mod costs;
pub mod cycles;
pub mod law_tables;
pub mod ranking;
mod reference;
pub mod report;
pub mod row;
pub mod runner;
#[cfg(test)]
mod sensitivity;
pub mod study;
pub mod task;
pub mod tasks;
pub mod words;

pub use contestant::Contestant;
pub use crepitus_ladder::laws::ENTRIES;
pub use ranking::{Answer, answers};
pub use row::Row;
pub use study::{LawStudy, Plan, run};
pub use task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
pub use tasks::TASKS;
pub use words::LawsOutcome;
