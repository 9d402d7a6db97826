//! `cargo xtask setup` on machines that lack things: a search path with nothing on it but stand-ins for `rustc` and `apt-get`.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// A machine with nothing but a compiler that has neither target nor sources.
struct Machine(TempDir);

/// What `apt-get` does.
const INSTALLS: &str = r#"
echo "$*" >> "$ROOT/log"
[ "$1" = install ] || exit 0
for package; do
  case "$package" in
    rust-web-src) mkdir -p "$ROOT/sysroot/lib/rustlib/src/rust/library/core"
                  touch "$ROOT/sysroot/lib/rustlib/src/rust/library/core/Cargo.toml" ;;
    lld) touch "$ROOT/bin/ld.lld" ;;
    qemu-system-arm) touch "$ROOT/bin/qemu-system-arm" ;;
  esac
done
"#;
const REFUSES: &str = r#"
echo "$*" >> "$ROOT/log"
echo "E: Could not open lock file - open (13: Permission denied)" >&2
exit 100
"#;
const DOES_NOTHING: &str = r#"echo "$*" >> "$ROOT/log""#;

impl Machine {
    fn new(apt_get: Option<&str>) -> Self {
        let machine = Self(tempfile::tempdir().unwrap());
        fs::create_dir_all(machine.root().join("bin")).unwrap();
        machine.program(
            "rustc",
            r#"
case "$*" in
  *target-libdir*) echo "$ROOT/lib" ;;
  *sysroot*) echo "$ROOT/sysroot" ;;
  *) echo "rustc 9.9.9 (none)" ;;
esac"#,
        );
        if let Some(body) = apt_get {
            machine.program("apt-get", body);
        }
        machine
    }

    fn root(&self) -> &Path {
        self.0.path()
    }

    fn program(&self, name: &str, body: &str) {
        let path = self.root().join("bin").join(name);
        let head = format!("#!/bin/sh\nROOT='{}'\nPATH=/usr/bin:/bin\n", self.root().display());
        fs::write(&path, head + body).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    fn setup(&self, arguments: &[&str]) -> (i32, String) {
        self.xtask(&[&["setup"], arguments].concat())
    }

    /// Exit status, and all that it says.
    fn xtask(&self, arguments: &[&str]) -> (i32, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
        command.args(arguments).env("PATH", self.root().join("bin"));
        command.env("CAMIF_RUSTC", self.root().join("bin/rustc")).env_remove("RUSTC");
        let output = command.output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        (output.status.code().unwrap(), String::from_utf8_lossy(&said).into_owned())
    }

    /// Calls of `apt-get`, without its options.
    fn calls(&self) -> Vec<String> {
        let log = fs::read_to_string(self.root().join("log")).unwrap_or_default();
        let words =
            |line: &str| line.split(' ').filter(|word| !word.starts_with("--")).collect::<Vec<_>>().join(" ");
        log.lines().map(words).collect()
    }
}

#[test]
fn what_is_missing_is_said_and_nothing_is_touched() {
    let machine = Machine::new(Some(INSTALLS));
    let (status, said) = machine.setup(&[]);
    assert_eq!(status, 1, "{said}");
    for part in [
        "rustup target add thumbv7em-none-eabihf",
        "apt-get install rustc-web rust-web-src",
        "qemu-system-arm",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(machine.calls(), Vec::<String>::new());
}

#[test]
fn what_builds_images_says_what_to_do_where_nothing_can() {
    let machine = Machine::new(None);
    for arguments in [
        &["build-boards"][..],
        &["check-boards"],
        &["qemu"],
        &["run", "qemu_replay"],
        &["stream", "--port", "0"],
    ] {
        let (status, said) = machine.xtask(arguments);
        assert_eq!(status, 2, "{arguments:?}: {said}");
        let told =
            "no compiler here builds for thumbv7em-none-eabihf; `cargo xtask setup` says how to get one";
        assert!(said.contains(told), "{arguments:?}: {said}");
    }
}

#[test]
fn all_that_is_missing_is_installed_once() {
    let machine = Machine::new(Some(INSTALLS));
    let (status, said) = machine.setup(&["--install"]);
    assert_eq!(status, 0, "{said}");
    // The linker shows to be missing when there is a compiler.
    let calls = ["update", "install rustc-web rust-web-src qemu-system-arm", "install lld"];
    assert_eq!(machine.calls(), calls);
    let (status, said) = machine.setup(&["--install"]);
    assert_eq!((status, machine.calls().len()), (0, calls.len()), "{said}");
    assert!(said.contains("all there"), "{said}");
    assert_eq!(machine.setup(&[]).0, 0);
}

#[test]
fn who_may_not_install_is_told_to_be_root() {
    let machine = Machine::new(Some(REFUSES));
    let (status, said) = machine.setup(&["--install"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("as root") && said.contains("rustc-web rust-web-src qemu-system-arm"), "{said}");
    assert_eq!(machine.calls(), ["update"], "what failed is not tried again");
}

#[test]
fn an_apt_get_that_brings_nothing_is_no_endless_loop() {
    let machine = Machine::new(Some(DOES_NOTHING));
    let (status, said) = machine.setup(&["--install"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("still they are not found"), "{said}");
    assert_eq!(machine.calls().len(), 2);
}

#[test]
fn without_apt_get_the_packages_are_named() {
    let machine = Machine::new(None);
    let (status, said) = machine.setup(&["--install"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("no apt-get here: install rustc-web rust-web-src qemu-system-arm"), "{said}");
}
