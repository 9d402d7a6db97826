use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// A bar of bytes on stderr; nothing where stderr is no terminal.
pub(super) fn bytes(what: &'static str, total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {bytes}/{total_bytes} {bytes_per_sec} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(total).with_style(style.progress_chars("━╸ ")).with_message(what)
}

/// A bar of frames on stderr; nothing where stderr is no terminal.
pub(super) fn frames(what: &'static str, total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} frames {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(total).with_style(style.progress_chars("━╸ ")).with_message(what)
}

/// Several lines on stderr, one below the other; nothing where stderr is no terminal.
pub(super) fn lines() -> MultiProgress {
    MultiProgress::new()
}

/// A line that says how far something without an end has come.
pub(super) fn line() -> ProgressBar {
    let style =
        ProgressStyle::with_template("{spinner} {msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
    ProgressBar::new_spinner().with_style(style)
}

/// A bar of cases on stderr; nothing where stderr is no terminal.
pub(super) fn cases(what: &'static str, total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} cases {per_sec} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(total).with_style(style.progress_chars("━╸ ")).with_message(what)
}
