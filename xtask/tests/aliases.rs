//! The project's short words in `.cargo/config.toml`: each one that is for this program says what this program takes.

use std::path::Path;
use std::process::Command;

/// What stands behind `--` of each alias that runs this program.
fn aliases() -> Vec<(String, Vec<String>)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.cargo/config.toml");
    let config: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let own = |text: &str| text.split_once("-p xtask --").map(|(_, behind)| words(behind));
    let aliases = config["alias"].as_table().unwrap().iter();
    aliases.filter_map(|(name, text)| Some((name.clone(), own(text.as_str()?)?))).collect()
}

fn xtask(arguments: &[String], path: &str) -> (Option<i32>, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).env("PATH", path).output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8_lossy(&said).into_owned())
}

#[test]
fn every_alias_is_a_command() {
    let aliases = aliases();
    let names: Vec<&str> = aliases.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["flash-f429", "flash-h743", "run-qemu", "xtask"]);
    for (name, mut arguments) in aliases {
        arguments.push("--help".to_owned());
        let (status, said) = xtask(&arguments, "");
        assert_eq!(status, Some(0), "{name}: {said}");
    }
}

#[test]
fn flashing_without_probe_rs_says_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in aliases().into_iter().filter(|(name, _)| name.starts_with("flash-")) {
        let (status, said) = xtask(&arguments, folder.path().to_str().unwrap());
        assert_eq!(status, Some(2), "{name}: {said}");
        assert!(said.contains("cargo install probe-rs-tools"), "{name}: {said}");
    }
}
