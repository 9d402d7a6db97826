//! Links the images by the `memory.x` at the top of the repository.

use std::path::Path;

fn main() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    println!("cargo:rustc-link-search={}", top.display());
    println!("cargo:rerun-if-changed={}", top.join("memory.x").display());
    for script in ["link.x", "defmt.x"] {
        println!("cargo:rustc-link-arg-bins=-T{script}");
    }
}
