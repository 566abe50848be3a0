//! Joins line elements into strands.

/// Joins elements of two vertices end to end. A joined strand starts at its end with the lower index. Returns the
/// elements unchanged if one has more than two vertices or if a vertex has more than two neighbors.
pub(super) fn chain(elements: Vec<Vec<usize>>, vertices: usize) -> Vec<Vec<usize>> {
    let mut ends: Vec<Vec<usize>> = vec![Vec::new(); vertices];
    for (i, e) in elements.iter().enumerate() {
        for end in [e[0], e[e.len() - 1]] {
            ends[end].push(i);
        }
    }
    let joinable = elements.iter().all(|e| e.len() == 2 && e[0] != e[1]) && ends.iter().all(|e| e.len() <= 2);
    if !joinable {
        return elements;
    }
    let mut used = vec![false; elements.len()];
    let mut strands = Vec::new();
    // Open strands first. The remaining elements form closed rings, which are cut at their lowest vertex.
    for free in [true, false] {
        for start in 0..vertices {
            if free != (ends[start].len() == 1) {
                continue;
            }
            let (mut strand, mut at) = (vec![start], start);
            while let Some(e) = ends[at].iter().copied().find(|e| !used[*e]) {
                used[e] = true;
                at = if elements[e][0] == at { elements[e][1] } else { elements[e][0] };
                strand.push(at);
            }
            if strand.len() == 2 {
                // A strand of a single element keeps its direction.
                strand.clone_from(&elements[ends[start][0]]);
            }
            if strand.len() > 1 {
                strands.push(strand);
            }
        }
    }
    strands
}

#[cfg(test)]
mod tests {
    use super::chain;

    #[test]
    fn edges_join_in_any_order() {
        let edges = vec![vec![2, 1], vec![4, 3], vec![0, 1]];
        assert_eq!(chain(edges, 5), vec![vec![0, 1, 2], vec![4, 3]]);
    }

    #[test]
    fn whole_strands_and_forks_are_unchanged() {
        let whole = vec![vec![3, 2, 1], vec![0, 4, 5]];
        assert_eq!(chain(whole.clone(), 6), whole);
        let fork = vec![vec![0, 1], vec![0, 2], vec![0, 3]];
        assert_eq!(chain(fork.clone(), 4), fork);
    }
}
