//! Says what is missing and how to get it; gets it when told so.

use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::qemu;
use crate::toolchain::{Missing, TARGET, Toolchain, in_path};

/// Debian's packages: a compiler with the sources of `core`, a linker, the machine.
const COMPILER: [&str; 2] = ["rustc-web", "rust-web-src"];
const LINKER: &str = "lld";
const MACHINE: &str = "qemu-system-arm";

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Install what is missing with apt-get (as root)
    #[arg(long)]
    install: bool,
    /// Add the target to the active rustup toolchain
    #[arg(long)]
    rustup_target: bool,
}

/// True if nothing is missing.
pub(crate) fn run(options: &Options) -> Result<bool> {
    if options.rustup_target && Toolchain::find().is_err() {
        call(Command::new("rustup").args(["target", "add", TARGET]))?;
    }
    if options.install {
        install()?;
    }
    let packages = report();
    if packages.is_empty() {
        println!("all there: `cargo xtask qemu` runs the images");
    }
    Ok(packages.is_empty())
}

/// Installs what is missing, until nothing is or apt has no more to give.
fn install() -> Result<()> {
    let mut updated = false;
    loop {
        let packages = missing();
        if packages.is_empty() {
            return Ok(());
        }
        if in_path("apt-get").is_none() {
            bail!("no apt-get here: install {} by other means", packages.join(" "));
        }
        let by_hand = || format!("as root, this would do: apt-get install {}", packages.join(" "));
        if !std::mem::replace(&mut updated, true) {
            call(Command::new("apt-get").args(["update", "--quiet"])).with_context(by_hand)?;
        }
        let mut install = Command::new("apt-get");
        install.args(["install", "--yes", "--quiet", "--no-install-recommends"]).args(&packages);
        call(install.env("DEBIAN_FRONTEND", "noninteractive")).with_context(by_hand)?;
        if missing() == packages {
            bail!("apt-get installed {}, and still they are not found", packages.join(" "));
        }
    }
}

fn call(command: &mut Command) -> Result<()> {
    let shown = format!("{command:?}");
    println!("{shown}");
    let status = command.status().with_context(|| format!("cannot start {shown}"))?;
    if !status.success() {
        bail!("{shown} failed: {status}");
    }
    Ok(())
}

/// Debian's names of what is missing.
fn missing() -> Vec<&'static str> {
    let mut packages = Vec::new();
    match Toolchain::find() {
        Ok(_) => {}
        Err(Missing::Target) => packages.extend(COMPILER),
        Err(Missing::Linker) => packages.push(LINKER),
    }
    if in_path(qemu::PROGRAM).is_none() {
        packages.push(MACHINE);
    }
    packages
}

/// Prints what there is and what is missing, and returns Debian's names of the latter.
fn report() -> Vec<&'static str> {
    match Toolchain::find() {
        Ok(Toolchain { rustc, version, build_core: false, .. }) => {
            println!("compiler: {} ({version}) has {TARGET}", rustc.display());
        }
        Ok(Toolchain { rustc, version, linker, .. }) => {
            println!("compiler: {} ({version}) builds core for {TARGET} from its sources", rustc.display());
            if let Some(linker) = linker {
                println!("linker:   {}", linker.display());
            }
        }
        Err(Missing::Target) => println!(
            "missing: a compiler for {TARGET}. With rustup:\n    rustup target add {TARGET}\n\
             (`cargo xtask setup --rustup-target` does so). Without it, on Debian 12:\n    apt-get install {}",
            COMPILER.join(" ")
        ),
        Err(Missing::Linker) => println!("missing: a linker. On Debian:\n    apt-get install {LINKER}"),
    }
    match in_path(qemu::PROGRAM) {
        Some(path) => println!("machine:  {}", path.display()),
        None => println!("missing: {}. On Debian:\n    apt-get install {MACHINE}", qemu::PROGRAM),
    }
    let packages = missing();
    if !packages.is_empty() {
        println!("`cargo xtask setup --install` runs apt-get for what is missing, as root");
    }
    packages
}
