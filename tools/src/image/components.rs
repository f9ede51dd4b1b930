//! Groups of nodes that can all reach each other: cycles of a graph.

/// The strongly connected groups that hold a cycle, among the nodes that are
/// `alive`. Nodes ascend inside a group. Kosaraju's algorithm, without
/// recursion.
pub fn cycles(next: &[Vec<usize>], alive: &[bool]) -> Vec<Vec<usize>> {
    let mut back = vec![Vec::new(); next.len()];
    for (node, successors) in next.iter().enumerate() {
        for &successor in successors {
            if alive[node] && alive[successor] {
                back[successor].push(node);
            }
        }
    }
    let mut group = vec![usize::MAX; next.len()];
    let mut groups = Vec::new();
    for &start in finished(next, alive).iter().rev() {
        let mut members = Vec::new();
        let mut open = vec![start];
        while let Some(node) = open.pop() {
            if group[node] == usize::MAX {
                group[node] = groups.len();
                members.push(node);
                open.extend(&back[node]);
            }
        }
        members.sort_unstable();
        groups.push(members);
    }
    groups.retain(|members| match members.as_slice() {
        [] => false,
        [only] => next[*only].contains(only),
        _ => true,
    });
    groups.sort();
    groups
}

/// The nodes in the order in which a search in depth is done with them.
fn finished(next: &[Vec<usize>], alive: &[bool]) -> Vec<usize> {
    let mut seen: Vec<bool> = alive.iter().map(|alive| !alive).collect();
    let mut order = Vec::new();
    for start in 0..next.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut path = vec![(start, 0)];
        while let Some((node, at)) = path.last_mut() {
            if let Some(&successor) = next[*node].get(*at) {
                *at += 1;
                if !seen[successor] {
                    seen[successor] = true;
                    path.push((successor, 0));
                }
            } else {
                order.push(*node);
                path.pop();
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::cycles;

    #[test]
    fn finds_groups_and_loops_to_self() {
        // 0 -> 1 <-> 2 -> 3 -> 3, 4 alone
        let next = [vec![1], vec![2], vec![1, 3], vec![3], vec![]];
        assert_eq!(cycles(&next, &[true; 5]), [vec![1, 2], vec![3]]);
        let without_2 = [true, true, false, true, true];
        assert_eq!(cycles(&next, &without_2), [vec![3]]);
    }

    #[test]
    fn long_chains_need_no_stack() {
        let n = 200_000;
        let next: Vec<Vec<usize>> = (0..n).map(|i| vec![(i + 1) % n]).collect();
        assert_eq!(cycles(&next, &vec![true; n]).len(), 1);
    }
}
