//! Labels in one column at the right, each at the height of its curve's end or
//! as near as its neighbours let it.

/// Distance from one line of text to the next, CSS pixels.
pub const LINE: f64 = 15.0;

/// Heights given, one for each wished height, between `top` and `bottom`, no two
/// closer than a line: labels that crowd stand around the middle of what they
/// wish. `None` where there are more labels than lines.
pub fn spread(wishes: &[f64], top: f64, bottom: f64) -> Option<Vec<f64>> {
    let mut order: Vec<usize> = (0..wishes.len()).collect();
    order.sort_by(|a, b| wishes[*a].total_cmp(&wishes[*b]));
    // Blocks of labels that stand line under line: of how many, and where the
    // mean of their wishes puts the first label of all.
    let mut blocks: Vec<(f64, f64)> = Vec::new();
    let mut lines = 0.0;
    for i in &order {
        let mut block = (1.0, wishes[*i] - lines);
        lines += LINE;
        while let Some((number, mean)) = blocks.pop() {
            if mean < block.1 {
                blocks.push((number, mean));
                break;
            }
            let both = block.0 + number;
            block = (both, (block.0 * block.1 + number * mean) / both);
        }
        blocks.push(block);
    }
    let lowest = bottom - lines + LINE;
    if lowest < top {
        return None;
    }
    let mut given = vec![0.0; wishes.len()];
    let mut lines = 0.0;
    let firsts = blocks.iter().flat_map(|(number, mean)| {
        // Small whole numbers.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        std::iter::repeat_n(*mean, *number as usize)
    });
    for (i, first) in order.iter().zip(firsts) {
        given[*i] = first.clamp(top, lowest) + lines;
        lines += LINE;
    }
    Some(given)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_inside() {
        let given = spread(&[125.0, 25.0, 27.0, 247.0], 0.0, 250.0).expect("room");
        assert_eq!(given, [125.0, 18.5, 33.5, 247.0]);
        let given = spread(&[247.0, 250.0, 250.0], 0.0, 250.0).expect("room");
        assert_eq!(given, [220.0, 235.0, 250.0]);
        let given = spread(&[3.0, 2.0, 1.0], 0.0, 250.0).expect("room");
        assert_eq!(given, [30.0, 15.0, 0.0]);
        assert_eq!(spread(&[5.0; 20], 0.0, 250.0), None);
        assert_eq!(spread(&[], 0.0, 250.0), Some(Vec::new()));
    }
}
