//! Captures as PulseView and Logic 2 export them, with a fault planted: `diagnose` names it.
//!
//! `sigrok-cli` writes with the library that PulseView writes with. `digital.csv` is written here, by its description and not
//! by our own writer: a row whenever a channel changes, seconds, and channels named as Logic 2 names them.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

const PROFILE: &str = r#"name = "bench"
[bus]
bits = 8
clock_edge = "rising"
sync = "gated"
hsync_blank = "low"
vsync_blank = "low"
[frame]
width = 48
height = 40
format = "rgb565-be"
[timing]
pclk_hz = 6_000_000
hblank = 16
vblank = 400
vfront = 16
vback = 16
"#;

/// Faults that leave every kind of mark: in data, in lines, in sync, in the clock.
const FAULTS: [(&str, &str); 4] = [
    ("stuck-bit", "stuck-bit:bit=6,level=low"),
    ("swapped-bits", "swapped-bits:a=2,b=6"),
    ("missing-clock", "missing-clock:count=2"),
    ("inverted-hsync", "inverted-hsync"),
];

fn host_sim(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    (output.status.code(), text + &String::from_utf8_lossy(&output.stderr))
}

/// A folder with a trace of a fault, `b.sr` and `b.vcd`.
fn broken(fault: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bench.toml"), PROFILE).unwrap();
    let run = |arguments: &[&str]| {
        let (status, text) = host_sim(folder.path(), arguments);
        assert_eq!(status, Some(0), "{text}");
    };
    run(&["generate", "--scene", "demo", "--profile", "bench.toml", "--frames", "3", "-o", "a.camt"]);
    for output in ["b.sr", "b.vcd"] {
        run(&["inject", "a.camt", "--profile", "bench.toml", "--fault", fault, "--seed", "5", "-o", output]);
    }
    folder
}

/// The first finding of a capture, in text.
fn named(folder: &Path, trace: &str, more: &[&str]) -> String {
    let arguments = [&["diagnose", trace, "--profile", "bench.toml"], more].concat();
    let (status, text) = host_sim(folder, &arguments);
    assert_eq!(status, Some(1), "{trace}: {text}");
    text
}

#[test]
fn exports_of_sigrok_name_the_planted_fault() {
    if Command::new("sigrok-cli").arg("--version").output().is_err() {
        eprintln!("skipped: no sigrok-cli (apt install sigrok-cli)");
        return;
    }
    for (class, fault) in FAULTS {
        let folder = broken(fault);
        for (format, name) in [("srzip", "export.sr"), ("vcd", "export.vcd")] {
            let written = Command::new("sigrok-cli")
                .current_dir(folder.path())
                .args(["-i", "b.sr", "-O", format, "-o", name])
                .status()
                .unwrap();
            assert!(written.success());
            let text = named(folder.path(), name, &[]);
            assert!(text.contains(&format!("\n1. {class} (")), "{name}, {fault}: {text}");
        }
    }
}

/// `sigrok-cli` breaks a session into pieces of 4 MiB, which are named so that the tenth stands before the second.
#[test]
fn a_session_of_many_pieces_holds_the_frames_that_were_sent() {
    if Command::new("sigrok-cli").arg("--version").output().is_err() {
        eprintln!("skipped: no sigrok-cli (apt install sigrok-cli)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let (status, text) = host_sim(folder.path(), &arguments);
        assert_eq!(status, Some(0), "{text}");
        text
    };
    for name in ["a.camt", "a.sr"] {
        run(&format!("generate --scene demo --profile vga-rgb888-gated --frames 3 -o {name}"));
    }
    let mut sigrok = Command::new("sigrok-cli");
    let sigrok = sigrok.current_dir(folder.path()).args(["-i", "a.sr", "-O", "srzip", "-o", "b.sr"]);
    assert!(sigrok.status().unwrap().success());
    let archive = zip::ZipArchive::new(std::fs::File::open(folder.path().join("b.sr")).unwrap()).unwrap();
    let names = archive.file_names().map(Result::unwrap);
    let pieces = names.filter(|name| name.starts_with("logic-1-")).count();
    assert!(pieces >= 10, "{pieces} pieces");
    let frames = |name: &str| {
        let text = run(&format!("replay {name} --profile vga-rgb888-gated --json"));
        let json: serde_json::Value = serde_json::from_str(&text[..=text.rfind('}').unwrap()]).unwrap();
        let frames = json["frames"].as_array().unwrap().iter();
        frames.map(|frame| (frame["crc32"].to_string(), frame["verdict"].to_string())).collect::<Vec<_>>()
    };
    let sent = frames("a.camt");
    assert_eq!(sent.len(), 3);
    assert_eq!(frames("b.sr"), sent);
}

/// Channels in the order of Logic 2's columns: PCLK, HSYNC, VSYNC, D7 to D0.
const CHANNELS: [&str; 11] = ["PCLK", "HSYNC", "VSYNC", "D7", "D6", "D5", "D4", "D3", "D2", "D1", "D0"];

/// A dump of simulator times as Logic 2 exports it, the nanosecond its unit.
fn logic2_csv(dump: &Path) -> String {
    let mut parser = vcd::Parser::new(std::io::BufReader::new(std::fs::File::open(dump).unwrap()));
    let header = parser.parse_header().unwrap();
    let (count, unit) = header.timescale.unwrap();
    let second = count as f64 / unit.divisor() as f64;
    fn variables(items: &[vcd::ScopeItem], into: &mut Vec<(String, vcd::IdCode, u32)>) {
        for item in items {
            match item {
                vcd::ScopeItem::Var(variable) => {
                    into.push((variable.reference.to_uppercase(), variable.code, variable.size));
                }
                vcd::ScopeItem::Scope(scope) => variables(&scope.items, into),
                _ => {}
            }
        }
    }
    let mut wires = Vec::new();
    variables(&header.items, &mut wires);
    let mut csv = String::from("Time [s]");
    for channel in 0..CHANNELS.len() {
        let _ = write!(csv, ",Channel {channel}");
    }
    csv.push('\n');
    let (mut levels, mut shown, mut time) = ([0u8; CHANNELS.len()], None, 0);
    let mut row = |levels: [u8; CHANNELS.len()], time: u64| {
        if shown.replace(levels) != Some(levels) {
            let values = levels.map(|level| level.to_string()).join(",");
            let _ = writeln!(csv, "{:.9},{values}", time as f64 * second);
        }
    };
    for command in parser {
        let mut set = |code: vcd::IdCode, bits: Vec<vcd::Value>| {
            let (name, ..) = wires.iter().find(|(_, known, _)| *known == code).unwrap();
            for (place, bit) in bits.iter().rev().enumerate() {
                let wire = if wires.iter().any(|(_, known, size)| *known == code && *size > 1) {
                    format!("D{place}")
                } else {
                    name.clone()
                };
                if let Some(channel) = CHANNELS.iter().position(|channel| *channel == wire) {
                    levels[channel] = u8::from(*bit == vcd::Value::V1);
                }
            }
        };
        match command.unwrap() {
            vcd::Command::ChangeScalar(code, value) => set(code, vec![value]),
            vcd::Command::ChangeVector(code, value) => set(code, value.iter().collect()),
            vcd::Command::Timestamp(next) => {
                if next > time {
                    row(levels, time);
                }
                time = next;
            }
            _ => {}
        }
    }
    row(levels, time);
    csv
}

#[test]
fn an_export_of_logic_2_names_the_planted_fault() {
    let map: Vec<String> =
        CHANNELS.iter().enumerate().map(|(channel, wire)| format!("{wire}=Channel {channel}")).collect();
    for (class, fault) in FAULTS {
        let folder = broken(fault);
        let csv = logic2_csv(&folder.path().join("b.vcd"));
        std::fs::write(folder.path().join("digital.csv"), csv).unwrap();
        let text = named(folder.path(), "digital.csv", &["--map", &map.join(",")]);
        assert!(text.contains(&format!("\n1. {class} (")), "{fault}: {text}");
    }
}

#[test]
fn a_profile_that_samples_where_data_moves_is_told_so() {
    let folder = broken("stuck-bit:bit=6,level=low");
    let profile = PROFILE.replace("\"rising\"", "\"falling\"");
    std::fs::write(folder.path().join("bench.toml"), profile).unwrap();
    let text = named(folder.path(), "b.sr", &[]);
    assert!(text.contains("\n1. wrong-edge (") && text.contains("bus.clock_edge = \"rising\""), "{text}");
    assert!(text.contains("CR.PCKPOL = 1") && text.contains("\n2. stuck-bit ("), "{text}");
}
