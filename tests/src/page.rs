//! Pages of `docs/` that tests write: what is printed there was measured.

use std::path::Path;

/// Asserts that a page of `docs/` holds this text, with one line to bless it if it does not: `BLESS=1` writes it.
///
/// # Panics
/// If the page is another.
pub fn same_page(name: &str, made: &str, test: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, made).expect("the page can be written");
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        there == made,
        "docs/{name} is another; BLESS=1 cargo test -p camif-tests {test} writes it:\n{made}"
    );
}
