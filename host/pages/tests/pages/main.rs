//! Pages, charts and sounds as they are written: see each module.

mod fixture;
mod markup;
mod paper;
mod report;
mod sound;
mod symptoms;
