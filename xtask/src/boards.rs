//! The board packages in `firmware/boards/`: found, not listed.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::toolchain::Toolchain;
use crate::top;

/// A program that a board package makes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Image {
    /// The package.
    pub(crate) package: String,
    /// The program.
    pub(crate) name: String,
    /// The file.
    pub(crate) elf: PathBuf,
}

/// The workspace of the board packages.
pub(crate) fn folder() -> PathBuf {
    top().join("firmware/boards")
}

/// Builds these packages in release, all if none is named, and says what came of it, by name.
///
/// # Errors
/// If no compiler is there for it, or the build fails; it has said why.
pub(crate) fn build(packages: &[String]) -> Result<Vec<Image>> {
    let toolchain = Toolchain::find()?;
    build_with(&toolchain, packages, &[])
}

/// The same by a given compiler, with more of `RUSTFLAGS`.
pub(crate) fn build_with(toolchain: &Toolchain, packages: &[String], flags: &[&str]) -> Result<Vec<Image>> {
    let all = if packages.is_empty() { found()? } else { packages.to_vec() };
    let mut images = Vec::new();
    // One at a time: built together, the chips of two boards would be features of one HAL.
    for package in &all {
        images.extend(build_package(toolchain, package, flags)?);
    }
    images.sort();
    Ok(images)
}

/// The packages that make programs.
fn found() -> Result<Vec<String>> {
    let folder = folder();
    let entries = std::fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut packages: Vec<_> = entries
        .flatten()
        .filter(|entry| entry.path().join("src/bin").is_dir() && entry.path().join("Cargo.toml").is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    packages.sort();
    Ok(packages)
}

fn build_package(toolchain: &Toolchain, package: &str, flags: &[&str]) -> Result<Vec<Image>> {
    let mut command = toolchain.cargo("build");
    command.current_dir(folder()).args(["--locked", "--message-format", "json-render-diagnostics"]);
    command.args(["--package", package]);
    if !flags.is_empty() {
        command.env("RUSTFLAGS", flags.join(" "));
        command.args(["--target-dir", "target/flags"]);
    }
    let output = command.stderr(std::process::Stdio::inherit()).output().context("cannot start cargo")?;
    if !output.status.success() {
        bail!("the board package {package} does not build");
    }
    Ok(String::from_utf8_lossy(&output.stdout).lines().filter_map(image).collect())
}

/// The program that a message of cargo tells of.
fn image(message: &str) -> Option<Image> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    let elf = message.get("executable")?.as_str()?;
    let manifest = Path::new(message.get("manifest_path")?.as_str()?);
    let package = manifest.parent()?.file_name()?.to_string_lossy().into_owned();
    let name = message.get("target")?.get("name")?.as_str()?.to_owned();
    let is_program = message.get("target")?.get("kind")?.get(0)?.as_str()? == "bin";
    is_program.then(|| Image { package, name, elf: PathBuf::from(elf) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_told_from_build_scripts() {
        let message = |kind: &str, executable: &str| {
            let target = format!(r#"{{"name":"qemu_hello","kind":["{kind}"]}}"#);
            format!(r#"{{"manifest_path":"/w/mps2/Cargo.toml","target":{target},"executable":{executable}}}"#)
        };
        let found = image(&message("bin", "\"/t/qemu_hello\"")).unwrap();
        assert_eq!((found.package.as_str(), found.name.as_str()), ("mps2", "qemu_hello"));
        assert_eq!(image(&message("custom-build", "\"/t/build\"")), None);
        assert_eq!(image(&message("lib", "null")), None);
        assert_eq!(image("not json"), None);
    }
}
