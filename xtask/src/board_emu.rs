//! Runs images for STM32 on the emulated boards of `board-emu/`, a package with a lock file of its own.
//!
//! The emulator declares a newer compiler than it needs, hence `--ignore-rust-version`. Beside the images that are flashed
//! there are those of `board-emu/images/`, an application on another driver and its twin on ours; each is built for both
//! chips.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::toolchain::{Toolchain, in_path};
use crate::{boards, top};

/// The chips, by the names of the board packages and of the features of the other images.
const CHIPS: [&str; 2] = ["stm32h743", "stm32f429"];

/// The emulator's folder.
fn folder() -> PathBuf {
    top().join("board-emu")
}

/// Builds every image, then runs the emulator's tests on them.
pub(crate) fn test() -> Result<bool> {
    let images = build_images()?;
    let mut cargo = cargo(&["test", "--release", "--locked"]);
    cargo.env("CAMIF_IMAGES", &images);
    Ok(cargo.status().context("cannot start cargo")?.success())
}

/// Runs `board-emu` with these arguments.
pub(crate) fn run(arguments: &[String]) -> Result<bool> {
    let mut cargo = cargo(&["run", "--release", "--quiet"]);
    cargo.arg("--manifest-path").arg(folder().join("Cargo.toml")).arg("--").args(arguments);
    cargo.current_dir(std::env::current_dir()?);
    Ok(cargo.status().context("cannot start cargo")?.success())
}

/// Runs the H743's image against a trace, before a sensor that answers on I2C, and shows its pictures in the inspector; or
/// saves the first of them there.
pub(crate) fn show(save_to: Option<&str>) -> Result<bool> {
    let inspector = std::env::var_os("CAMIF_INSPECT").map(PathBuf::from).or_else(|| in_path("camif-inspect"));
    let inspector = inspector.context("no camif-inspect on the search path: pipx install ./inspector")?;
    let images = boards::build(&["stm32h743".into()])?;
    let image = images.iter().find(|image| image.name == "camera_h743").context("no image camera_h743")?;
    let into = folder().join("target/show");
    std::fs::create_dir_all(&into).with_context(|| into.display().to_string())?;
    let trace = into.join("trace.camt");
    let mut generate = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    generate.current_dir(top()).args(["run", "--release", "--quiet", "-p", "host-sim", "--", "generate"]);
    generate.args(["--scene", "demo", "--sensor", "ov7670", "--mode", "qvga-rgb565", "--frames", "40", "-o"]);
    ensure!(generate.arg(&trace).status().context("cannot start cargo")?.success(), "no trace was made");

    let mut board = cargo(&["run", "--release", "--quiet"]);
    board.args(["--", "run"]).arg(&image.elf).args(["--board", "stm32h743", "--sensor", "ov7670"]);
    board.arg("--trace").arg(&trace).args(["--uart", "tcp:127.0.0.1:0", "--mips", "60"]);
    let mut board = board.stderr(Stdio::piped()).spawn().context("cannot start cargo")?;
    let mut told = BufReader::new(board.stderr.take().context("its messages")?).lines();
    let address = told.by_ref().map_while(Result::ok).find_map(|line| {
        eprintln!("{line}");
        let address = line.strip_prefix("serial port on ")?.split(';').next()?;
        Some(address.to_owned())
    });
    let address = address.context("the emulated board did not start")?;
    let mut inspector = Command::new(inspector);
    match save_to {
        Some(out) => inspector.args(["save", "--whole", "-o", out]),
        None => inspector.arg("view"),
    };
    let shown = inspector.arg(format!("socket://{address}")).status().context("cannot start the inspector");
    told.map_while(Result::ok).for_each(|line| eprintln!("{line}"));
    let ran = board.wait()?.success();
    Ok(ran && shown?.success())
}

/// A cargo in the emulator's folder.
fn cargo(words: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(folder()).args(words).arg("--ignore-rust-version").env("RUSTUP_AUTO_INSTALL", "0");
    cargo
}

/// Builds the images of the boards and those in `board-emu/images/`, and puts them into one folder, which it names.
fn build_images() -> Result<PathBuf> {
    let into = folder().join("target/images");
    std::fs::create_dir_all(&into).with_context(|| into.display().to_string())?;
    let ours = CHIPS.into_iter().filter(|chip| boards::folder().join(chip).is_dir());
    let ours: Vec<String> = ours.map(str::to_owned).collect();
    if !ours.is_empty() {
        for image in boards::build(&ours)? {
            copy(&image.elf, &into.join(format!("{}-{}.elf", image.name, image.package)))?;
        }
    }
    let toolchain = Toolchain::find()?;
    let sources = folder().join("images");
    for entry in std::fs::read_dir(&sources).with_context(|| sources.display().to_string())? {
        let package = entry?.path();
        let name = package.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for chip in CHIPS {
            let target = folder().join("target/foreign").join(chip);
            let mut build = toolchain.cargo("build");
            build.current_dir(&package).args(["--locked", "--features", chip]);
            build
                .env("CARGO_TARGET_DIR", &target)
                .env("RUSTFLAGS", "-Clink-arg=-Tlink.x -Clink-arg=--nmagic");
            let status = build.status().context("cannot start cargo")?;
            ensure!(status.success(), "{name} does not build for {chip}");
            let elf = target.join(crate::toolchain::TARGET).join("release").join(&name);
            copy(&elf, &into.join(format!("{name}-{chip}.elf")))?;
        }
    }
    Ok(into)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    match std::fs::copy(from, to) {
        Ok(_) => Ok(()),
        Err(error) => bail!("cannot copy {} to {}: {error}", from.display(), to.display()),
    }
}
