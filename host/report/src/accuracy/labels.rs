//! Labels in one column at the right, each at the height of its curve's end or
//! as near as its neighbours let it.

/// From one line of text to the next, grid lines.
pub(crate) const LINE: i32 = 60;

/// For each wished height the height given, between `top` and `bottom`, no two
/// closer than a line: labels that crowd stand around the middle of what they
/// wish. `None` where there are more labels than lines.
pub(crate) fn spread(wishes: &[i32], top: i32, bottom: i32) -> Option<Vec<i32>> {
    let mut order: Vec<usize> = (0..wishes.len()).collect();
    order.sort_by_key(|i| wishes[*i]);
    // Blocks of labels that stand line under line: of how many, and the sum of
    // where each would have the first of its block.
    let mut blocks: Vec<(i32, i32)> = Vec::new();
    let mut lines = 0;
    for i in &order {
        let mut block = (1, wishes[*i] - lines);
        lines += LINE;
        while let Some((number, sum)) = blocks.pop() {
            if sum / number < block.1 / block.0 {
                blocks.push((number, sum));
                break;
            }
            block = (block.0 + number, block.1 + sum);
        }
        blocks.push(block);
    }
    let lowest = bottom - lines + LINE;
    if lowest < top {
        return None;
    }
    let mut given = vec![0; wishes.len()];
    let mut at = order.iter();
    let mut lines = 0;
    for (number, sum) in blocks {
        for i in at.by_ref().take(usize::try_from(number).unwrap_or(0)) {
            given[*i] = (sum / number).clamp(top, lowest) + lines;
            lines += LINE;
        }
    }
    Some(given)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_inside() {
        let given = spread(&[500, 100, 110, 990], 0, 1000).expect("room");
        assert_eq!(given, [500, 75, 135, 990]);
        let given = spread(&[990, 1000, 1000], 0, 1000).expect("room");
        assert_eq!(given, [880, 940, 1000]);
        let given = spread(&[3, 2, 1], 0, 1000).expect("room");
        assert_eq!(given, [120, 60, 0]);
        assert_eq!(spread(&[5; 20], 0, 1000), None);
        assert_eq!(spread(&[], 0, 1000), Some(Vec::new()));
    }
}
