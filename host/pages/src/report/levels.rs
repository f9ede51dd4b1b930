//! The torque levels as dashed lines with names at the right edge.

use crate::plot::number::rounded;
use crate::plot::{Axis, Plot, Point, extent};

use crate::report::channels::TorqueLevels;

/// Room for the names at the right of a panel, CSS pixels.
pub(crate) const ROOM: f64 = 112.0;

/// A level that is drawn: signed, with its name.
pub(crate) type Level = (f64, String);

/// The levels of the senses in which the torque ever was.
pub(crate) fn levels_in(levels: Option<TorqueLevels>, torque: &[Point]) -> Vec<Level> {
    let Some(levels) = levels else {
        return Vec::new();
    };
    let (low, high) = extent(torque.iter().map(|point| point.y));
    let tiny = 1e-6 * levels.static_nm;
    let mut list = Vec::new();
    for (used, sign, minus) in [
        (high > tiny || low >= -tiny, 1.0, ""),
        (low < -tiny, -1.0, "\u{2212}"),
    ] {
        if !used {
            continue;
        }
        list.push((sign * levels.static_nm, format!("{minus}Ts")));
        list.push((sign * levels.kinetic_nm, format!("{minus}Tk")));
        let elastic = 2.0 * levels.kinetic_nm - levels.static_nm;
        if elastic.abs() <= tiny && list.len() > 2 {
            // Zero is the same level for both senses.
            continue;
        }
        if (levels.restart_nm - elastic).abs() <= tiny {
            let name = if minus.is_empty() {
                "2Tk\u{2212}Ts".to_owned()
            } else {
                format!("{minus}(2Tk\u{2212}Ts)")
            };
            list.push((sign * elastic, name));
        } else if (levels.restart_nm - levels.kinetic_nm).abs() > tiny {
            list.push((sign * levels.restart_nm, format!("{minus}restart")));
        }
    }
    list
}

/// An axis that holds the torque and its levels.
pub(crate) fn torque_axis(torque: &[Point], levels: &[Level]) -> Axis {
    Axis::covering(
        torque
            .iter()
            .map(|point| point.y)
            .chain(levels.iter().map(|(value, _)| *value)),
        5,
    )
}

/// The dashed lines.
pub(crate) fn draw(plot: &mut Plot, levels: &[Level]) {
    for (value, _) in levels {
        plot.across(*value);
    }
}

/// Names at the right edge, one for levels whose names would overlap. `height`
/// is that of the panel in CSS pixels.
pub(crate) fn names(axis: &Axis, levels: &[Level], height: f64) -> Vec<(f64, String)> {
    let mut sorted: Vec<&Level> = levels.iter().collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let too_near = 17.0 / height;
    let mut labels = Vec::new();
    let mut rest = sorted.as_slice();
    while let Some((first, _)) = rest.split_first() {
        let near = rest
            .iter()
            .take_while(|level| axis.place(level.0) - axis.place(first.0) < too_near)
            .count();
        let (group, after) = rest.split_at(near.max(1));
        rest = after;
        let mut names: Vec<&str> = group.iter().map(|level| level.1.as_str()).collect();
        names.dedup();
        let middle = group.iter().map(|level| level.0).sum::<f64>() / group.len() as f64;
        let same = group.iter().all(|level| level.0.abs() == first.0.abs());
        let label = if same {
            format!("{} = {}", names.join(" = "), rounded(first.0))
        } else {
            names.join(", ")
        };
        labels.push((middle, label));
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_senses_that_occur_have_levels() {
        let levels = Some(TorqueLevels::elastic(0.2, 0.3));
        let names = |torque: &[f64]| -> Vec<String> {
            let points: Vec<Point> = torque.iter().map(|y| Point::new(0.0, *y)).collect();
            levels_in(levels, &points)
                .into_iter()
                .map(|(_, name)| name)
                .collect()
        };
        assert_eq!(names(&[0.0, 0.3]), ["Ts", "Tk", "2Tk−Ts"]);
        assert_eq!(names(&[-0.3, -0.1]), ["−Ts", "−Tk", "−(2Tk−Ts)"]);
        assert_eq!(names(&[-0.3, 0.3]).len(), 6);
        assert!(levels_in(None, &[]).is_empty());
    }
}
