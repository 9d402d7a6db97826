//! Numbers as people read them.

use std::collections::BTreeMap;

/// A number with commas between thousands.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// The most frequent numbers of a histogram, each with how often it comes.
pub(super) fn usual(counts: &BTreeMap<u64, u64>) -> String {
    let mut sorted: Vec<(&u64, &u64)> = counts.iter().collect();
    sorted.sort_by_key(|&(number, count)| (std::cmp::Reverse(*count), *number));
    let shown = sorted.iter().take(4).map(|(number, count)| match sorted.len() {
        1 => grouped(**number),
        _ => format!("{} ({}×)", grouped(**number), grouped(**count)),
    });
    let mut text = shown.collect::<Vec<_>>().join(", ");
    if sorted.len() > 4 {
        text.push_str(", …");
    }
    if text.is_empty() { "none".to_owned() } else { text }
}

/// The same text with its first letter as a capital.
pub(super) fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map(|first| first.to_uppercase().chain(rest).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_grouped() {
        assert_eq!([0, 999, 1000, 27_648_000].map(grouped), ["0", "999", "1,000", "27,648,000"]);
    }

    #[test]
    fn the_usual_comes_first() {
        assert_eq!(usual(&BTreeMap::from([(640, 711), (634, 9)])), "640 (711×), 634 (9×)");
        assert_eq!(usual(&BTreeMap::from([(1240, 3)])), "1,240");
        assert_eq!(usual(&BTreeMap::new()), "none");
        assert_eq!(capital("élan, even"), "Élan, even");
    }
}
