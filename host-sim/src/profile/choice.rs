/// A value that is a word in a profile.
///
/// One table gives the words for reading, writing and error messages.
pub trait Choice: Copy + PartialEq + Sized + 'static {
    /// Every value with its word, in the order in which messages list them.
    const NAMES: &'static [(&'static str, Self)];

    /// The word.
    #[must_use]
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, value)| *value == self).map_or("?", |(name, _)| name)
    }

    /// The value that a word means.
    #[must_use]
    fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// The word among `known` that is nearest to `word`, without regard to case and to `-` against `_`.
///
/// `None` only where `known` is empty.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let fold = |text: &str| text.to_lowercase().replace('_', "-");
    let word = fold(word);
    // Damerau: swapped letters are one slip, not two. Ties go to the first.
    known.into_iter().min_by_key(|candidate| strsim::damerau_levenshtein(&word, &fold(candidate)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_forgives_case_dashes_and_swapped_letters() {
        let known = ["hsync_blank", "vsync_blank", "bits"];
        assert_eq!(nearest("HSYNC-BLANK", known), Some("hsync_blank"));
        assert_eq!(nearest("vsycn_blank", known), Some("vsync_blank"));
        assert_eq!(nearest("bit", known), Some("bits"));
        assert_eq!(nearest("", known), Some("bits"), "there is always a nearest");
        assert_eq!(nearest("x", []), None);
    }
}
