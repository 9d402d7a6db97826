//! Which compiler can build for Cortex-M on this machine.
//!
//! Two ways lead there. A toolchain that has the target's libraries, as `rustup target add` leaves it, builds as it is.
//! One that has the library's sources builds `core` itself (`-Zbuild-std`): that is the way of Debian's `rustc-web`
//! and `rust-web-src`, and of rustup's component `rust-src`. `CAMIF_RUSTC` names a compiler to take instead of looking.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Cortex-M4 and M7, floats in registers.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// Debian's compiler, and its packages.
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

/// A way to build for [`TARGET`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Toolchain {
    /// The compiler.
    pub(crate) rustc: PathBuf,
    /// Its version, as it says itself: `rustc 1.96.0`.
    pub(crate) version: String,
    /// `core` is built from its sources.
    pub(crate) build_core: bool,
    /// The linker, if the compiler brings none.
    pub(crate) linker: Option<PathBuf>,
}

/// What is needed and not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Missing {
    /// No compiler has the target or the sources.
    Target,
    /// Debian's compiler is there, but nothing that links.
    Linker,
}

impl std::error::Error for Missing {}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self {
            Self::Target => "compiler here builds",
            Self::Linker => "linker is here",
        };
        write!(f, "no {what} for {TARGET}; `cargo xtask setup` says how to get one")
    }
}

impl Toolchain {
    /// Looks at the user's compiler, then at Debian's.
    pub(crate) fn find() -> Result<Self, Missing> {
        let named = |name| std::env::var_os(name).map(PathBuf::from);
        let candidates = match named("CAMIF_RUSTC") {
            Some(rustc) => vec![rustc],
            None => vec![named("RUSTC").unwrap_or_else(|| "rustc".into()), DEBIAN_RUSTC.into()],
        };
        for rustc in &candidates {
            let Some(libraries) = print(rustc, &["--print", "target-libdir", "--target", TARGET]) else {
                continue;
            };
            if has_core(Path::new(&libraries)) {
                return Ok(Self::new(rustc, false, None));
            }
        }
        for rustc in &candidates {
            let Some(sysroot) = print(rustc, &["--print", "sysroot"]) else { continue };
            if !Path::new(&sysroot).join("lib/rustlib/src/rust/library/core/Cargo.toml").is_file() {
                continue;
            }
            if rust_lld(Path::new(&sysroot)).is_some() {
                return Ok(Self::new(rustc, true, None));
            }
            let linker = print(Path::new("rustc"), &["--print", "sysroot"])
                .and_then(|sysroot| rust_lld(Path::new(&sysroot)))
                .or_else(|| in_path("ld.lld"));
            return linker.map(|linker| Self::new(rustc, true, Some(linker))).ok_or(Missing::Linker);
        }
        Err(Missing::Target)
    }

    fn new(rustc: &Path, build_core: bool, linker: Option<PathBuf>) -> Self {
        let version = print(rustc, &["--version"]).unwrap_or_default();
        let version = version.split(' ').take(2).collect::<Vec<_>>().join(" ");
        Self { rustc: rustc.to_path_buf(), version, build_core, linker }
    }

    /// A cargo that builds for [`TARGET`] with this compiler: `subcommand` first, the caller's arguments after.
    pub(crate) fn cargo(&self, subcommand: &str) -> Command {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.arg(subcommand).args(["--release", "--target", TARGET]);
        command.env("RUSTC", &self.rustc).env("RUSTUP_AUTO_INSTALL", "0");
        if self.build_core {
            command.arg("-Zbuild-std=core").env("RUSTC_BOOTSTRAP", "1");
        }
        if let Some(linker) = &self.linker {
            command.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker);
        }
        command
    }
}

/// What a compiler prints; `None` if there is no such compiler, or it can't.
fn print(rustc: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new(rustc).args(arguments).env("RUSTUP_AUTO_INSTALL", "0").output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn has_core(libraries: &Path) -> bool {
    let Ok(entries) = std::fs::read_dir(libraries) else { return false };
    entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
}

fn rust_lld(sysroot: &Path) -> Option<PathBuf> {
    let hosts = std::fs::read_dir(sysroot.join("lib/rustlib")).ok()?;
    hosts.flatten().map(|host| host.path().join("bin/rust-lld")).find(|path| path.is_file())
}

/// A program on the search path.
pub(crate) fn in_path(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|path| path.is_file())
}
