//! Which value comes most often.

use std::collections::BTreeMap;

/// The most frequent value, and how many there are of it; of equally frequent ones the largest.
pub(crate) fn most_frequent<N: Ord>(values: impl Iterator<Item = N>) -> Option<(N, u64)> {
    let mut counts = BTreeMap::new();
    for value in values {
        *counts.entry(value).or_insert(0) += 1;
    }
    // The last of equals, which a sorted map has as the largest.
    counts.into_iter().max_by_key(|&(_, count)| count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_of_equally_frequent_values_wins() {
        assert_eq!(most_frequent([3, 1, 1, 3, 2].into_iter()), Some((3, 2)));
        assert_eq!(most_frequent([1, 1, 3].into_iter()), Some((1, 2)));
        assert_eq!(most_frequent([0; 0].into_iter()), None);
    }
}
