//! Pictures that explain one hard case each, as data: what was computed with
//! the real model, and how its axes are meant. The report draws them.
//!
//! One file a story, with a function of the name of the file; a new one gets a
//! line in [`all`].

mod implicit_euler;
mod parameter_change;
mod restick_rules;
mod trace;
mod turn_back;

use crepitus_model::SettingsError;

/// A picture of one or several panels, one above the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Name of its file: `implicit-euler`.
    pub name: &'static str,
    /// What it says, in a line.
    pub title: &'static str,
    /// What one sees, with the numbers.
    pub caption: String,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// What it shows.
    pub heading: String,
    /// The axis to the right.
    pub x: Scale,
    /// The axis upwards.
    pub y: Scale,
    /// The lines, the first at the back.
    pub series: Vec<Series>,
    /// Horizontal lines with names: limits of y.
    pub levels: Vec<Mark>,
    /// Vertical lines with names: limits of x.
    pub bounds: Vec<Mark>,
}

/// What an axis shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// Quantity and unit: `Time (s)`. Panels below each other that share it,
    /// and the range, share the axis.
    pub label: &'static str,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
    /// From where to where; `None` covers what is there. What is outside in y
    /// stands at the edge, what is outside in x is left out.
    pub range: Option<(f64, f64)>,
}

/// One line. Lines of one name look the same in all panels of a story.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// For the legend.
    pub name: &'static str,
    /// Whether each point has a sign of its own: measured one by one.
    pub dotted: bool,
    /// From left to right.
    pub points: Vec<(f64, f64)>,
}

/// A value on an axis with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The value.
    pub at: f64,
    /// Its name, with the number if that says something.
    pub name: String,
}

impl Scale {
    /// A linear axis over what is there.
    pub fn linear(label: &'static str) -> Self {
        Self {
            label,
            ..Self::default()
        }
    }

    /// The axis from `low` to `high`.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Self {
        Self {
            range: Some((low, high)),
            ..self
        }
    }
}

impl Series {
    /// A line without signs.
    pub fn line(name: &'static str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            dotted: false,
            points,
        }
    }
}

impl Mark {
    /// A named value.
    pub fn new(at: f64, name: impl Into<String>) -> Self {
        Self {
            at,
            name: name.into(),
        }
    }
}

/// All stories, computed: about a second of work.
///
/// # Errors
/// None in practice: every story has settings that the model takes.
pub fn all() -> Result<Vec<Story>, SettingsError> {
    Ok(vec![
        implicit_euler::implicit_euler()?,
        restick_rules::restick_rules()?,
        parameter_change::parameter_change()?,
        turn_back::turn_back()?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_story_can_be_drawn_and_has_its_own_name() {
        let stories = all().unwrap();
        let mut names: Vec<_> = stories.iter().map(|s| s.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), stories.len());
        for story in &stories {
            assert!(
                story.caption.len() > 100 && !story.panels.is_empty(),
                "{}",
                story.name
            );
            for panel in &story.panels {
                assert!(!panel.heading.is_empty());
                for series in &panel.series {
                    assert!(series.points.len() > 1, "{}: {}", story.name, series.name);
                    assert!(
                        series
                            .points
                            .iter()
                            .all(|(x, y)| x.is_finite() && y.is_finite())
                    );
                    assert!(series.points.windows(2).all(|w| w[0].0 <= w[1].0));
                }
            }
        }
    }
}
