//! The link's test vectors, which Python wrote from the protocol's page: read, written, put together.

use std::fs;
use std::path::{Path, PathBuf};

use firmware::link::packet::Meaning;
use firmware::link::{
    Assembled, Assembler, BODY_MAX, Content, Counts, Encoding, Format, Framer, Inbox, Packet, Received,
    coding, marks_words, small_table, wire_bytes,
};
use serde_json::{Value, json};

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/link")
}

fn vectors(key: &str) -> Vec<Value> {
    let text = fs::read_to_string(directory().join("vectors.json")).unwrap();
    let vectors: Value = serde_json::from_str(&text).unwrap();
    vectors[key].as_array().unwrap().clone()
}

fn file(name: &Value) -> Vec<u8> {
    fs::read(directory().join(name.as_str().unwrap())).unwrap()
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn format_named(name: &Value) -> Format {
    Format::ALL.into_iter().find(|format| format.name() == name).unwrap()
}

fn encoding_named(name: &Value) -> Encoding {
    Encoding::ALL.into_iter().find(|encoding| encoding.name() == name).unwrap()
}

/// The fields of a packet as the vectors have them, without those whose form is the code's own.
fn described(packet: &Packet<'_>) -> Value {
    match packet {
        Packet::Hello(p) => json!({
            "kind": "hello", "oldest": p.oldest, "newest": p.newest, "takes": p.takes, "sends": p.sends,
            "streams": p.streams, "commands": p.commands, "encodings": p.encodings, "session": p.session,
            "text": p.name,
        }),
        Packet::Stream(p) => json!({
            "kind": "stream", "stream": p.stream, "format": p.format.name(), "encoding": p.encoding.code(),
            "on": p.on, "width": p.width, "height": p.height, "meaning": meaning(p.meaning),
            "pipeline": p.pipeline, "text": p.name,
        }),
        Packet::Palette(p) => json!({
            "kind": "palette", "stream": p.stream, "colours": hexadecimal(p.colors.as_flattened()),
            "crc": small_table(0, p.colors.as_flattened()),
        }),
        Packet::Frame(p) => json!({
            "kind": "frame", "stream": p.stream, "format": p.format.name(), "meaning": meaning(p.meaning),
            "snapshot": p.snapshot, "sequence": p.sequence, "width": p.width, "height": p.height,
            "captured": p.captured, "palette_crc": p.palette,
        }),
        Packet::Line(p) => json!({
            "kind": "line", "stream": p.stream, "format": p.format.name(), "encoding": p.encoding.name(),
            "unused": p.unused, "again": p.again, "sequence": p.sequence, "line": p.line, "first": p.first,
            "payload": hexadecimal(p.payload),
        }),
        Packet::End(p) => json!({
            "kind": "end", "stream": p.stream, "format": p.format.name(), "verdict": p.verdict,
            "lines_sent": p.lines_sent, "sequence": p.sequence, "width": p.width, "height": p.height,
            "lines_captured": p.lines, "bytes_captured": p.bytes, "min_line_bytes": p.min_line_bytes,
            "max_line_bytes": p.max_line_bytes, "detail": p.detail, "overruns": p.overruns,
            "dropped": p.dropped, "bytes_sent": p.bytes_sent, "frame_crc": p.crc,
        }),
        Packet::Heartbeat(p) => {
            let frames = &p.frames;
            json!({
                "kind": "heartbeat", "session": p.session, "uptime": p.uptime, "delivered": frames.delivered,
                "dropped": frames.dropped, "lost": frames.lost, "skipped": frames.skipped,
                "overruns": frames.overruns, "sync_errors": frames.sync_errors,
                "dma_errors": frames.dma_errors, "lines_dropped": frames.lines_dropped,
                "packets_sent": p.packets_sent, "bytes_sent": p.bytes_sent,
                "packets_unsent": p.packets_unsent, "packets_received": p.packets_received,
                "packets_damaged": p.packets_damaged, "baud": p.baud,
                "state": if p.state == firmware::link::packet::State::Running { 1 } else { 255 },
                "cause": p.cause,
            })
        }
        Packet::Log(p) => json!({
            "kind": "log", "level": p.level as u8, "cut": p.cut, "lost": p.lost, "time": p.time,
            "text": p.text,
        }),
        Packet::Reply(p) => json!({
            "kind": "reply", "request": p.request, "command": p.code, "status": p.status.code(),
            "rest": hexadecimal(p.rest),
        }),
        Packet::Command(p) => json!({
            "kind": "command", "request": p.request, "command": p.code, "rest": hexadecimal(p.arguments),
        }),
    }
}

fn meaning(meaning: Meaning) -> u8 {
    if meaning == Meaning::default() { 0 } else { 0x31 }
}

/// All that is in some bytes on the wire.
fn received<T>(wire: &[u8], mut each: impl FnMut(Received<'_>) -> T) -> (Vec<T>, Counts) {
    let (mut memory, mut all) = ([0; BODY_MAX], Vec::new());
    let mut inbox = Inbox::new(&mut memory, small_table);
    inbox.feed(wire, |received| all.push(each(received)));
    (all, inbox.counts())
}

#[test]
fn every_packet_reads_and_writes_as_python_has_it() {
    for mut vector in vectors("packets") {
        let wire = file(&vector["wire"]);
        let name = vector["name"].as_str().unwrap().to_owned();
        let fields = vector.as_object_mut().unwrap();
        fields.remove("name");
        fields.remove("wire");
        let (packets, _) = received(&wire, |received| {
            let Received::Packet(packet) = received else { panic!("{name}: {received:?}") };
            let mut memory = [0; wire_bytes(BODY_MAX)];
            let mut framer = Framer::new(&mut memory, small_table);
            let written = packet.frame(&mut framer).unwrap().to_vec();
            (described(&packet), written)
        });
        let [(fields, written)] = packets.as_slice() else { panic!("{name}: {} packets", packets.len()) };
        assert_eq!(fields, &vector, "{name}");
        // A longer FRAME is read, and its end not understood.
        if name != "frame-longer" {
            assert_eq!(written.strip_prefix(&[0]).unwrap_or(written), wire, "{name}");
        }
    }
}

#[test]
fn commands_are_understood_and_written_the_same() {
    use firmware::link::Request;
    for vector in vectors("packets").iter().filter(|vector| vector["kind"] == "command") {
        let wire = file(&vector["wire"]);
        received(&wire, |received| {
            let Received::Packet(Packet::Command(command)) = received else { panic!("{received:?}") };
            let request = Request::read(&command).unwrap();
            assert_eq!(request.code(), command.code);
            let mut memory = [0; wire_bytes(512)];
            let mut framer = Framer::new(&mut memory, small_table);
            assert_eq!(request.frame(command.request, &mut framer).unwrap()[1..], wire);
        });
    }
}

#[test]
fn what_is_damaged_is_told_apart() {
    for vector in vectors("damaged") {
        let (what, _) = received(&file(&vector["wire"]), |received| match received {
            Received::Packet(_) => "received",
            Received::Damaged(_) => "damaged",
            Received::Malformed(_) => "malformed",
            Received::UnknownKind(_) => "unknown-kind",
            Received::OtherVersion { .. } => "other-version",
        });
        assert_eq!(what, [vector["is"].as_str().unwrap()], "{}", vector["name"]);
    }
}

#[test]
fn another_version_says_what_it_speaks() {
    let vector = vectors("damaged").into_iter().find(|vector| vector["name"] == "version-2").unwrap();
    let expected = Received::OtherVersion { version: 2, spoken: Some((1, 1)) };
    received(&file(&vector["wire"]), |received| assert_eq!(received, expected));
    assert!(matches!(Content::read(&[]), Content::Malformed { .. }));
}

#[test]
fn every_encoding_decodes() {
    for vector in vectors("encodings") {
        let (pixels, payload) = (file(&vector["pixels"]), file(&vector["payload"]));
        let (format, encoding) = (format_named(&vector["format"]), encoding_named(&vector["encoding"]));
        let unused = vector["unused"].as_u64().unwrap() as u8;
        let mut back = vec![0; pixels.len()];
        let length = coding::decode(format, encoding, unused, &payload, &mut back);
        assert_eq!((length, &back), (Some(pixels.len()), &pixels), "{vector}");
    }
}

/// QOI lines are what a QOI encoder makes of a picture of one line.
#[test]
fn colour_is_quite_ok() {
    let lines = vectors("encodings");
    let mut seen = 0;
    for vector in lines.iter().filter(|vector| vector["format"] == "rgb888" && vector["encoding"] == "qoi") {
        let pixels = file(&vector["pixels"]);
        let peer = qoi::encode_to_vec(&pixels, pixels.len() as u32 / 3, 1).unwrap();
        let mut room = vec![0; 2 * pixels.len()];
        let choice = firmware::link::Choice::One(Encoding::Qoi);
        let (_, length) = coding::encode(Format::RGB888, choice, &pixels, &mut room).unwrap();
        let coded = [&peer[..14], &room[..length], &peer[peer.len() - 8..]].concat();
        let (_, decoded) = qoi::decode_to_vec(&coded).unwrap();
        assert_eq!(decoded, pixels, "another decoder reads our lines");
        let mut back = vec![0; pixels.len()];
        let chunks = &peer[14..peer.len() - 8];
        assert_eq!(
            coding::decode(Format::RGB888, Encoding::Qoi, 0, chunks, &mut back),
            Some(pixels.len()),
            "we read another encoder's"
        );
        assert_eq!(back, pixels);
        seen += 1;
    }
    assert_eq!(seen, 4);
}

/// An ended frame, in the vectors' words.
fn told(stream: u8, frame: &Assembled<'_>) -> (Value, Vec<u8>) {
    let missing: Vec<u16> = frame.missing().collect();
    let words = json!({
        "stream": stream, "sequence": frame.sequence, "width": frame.width, "height": frame.height,
        "format": frame.format.name(), "missing": missing, "verdict": frame.end.map(|end| end.verdict),
        "crc_ok": frame.crc,
    });
    (words, frame.picture.to_vec())
}

#[test]
fn streams_come_together_as_python_has_them() {
    for vector in vectors("streams") {
        let wire = file(&vector["wire"]);
        for chunk in [wire.len(), 7] {
            let mut memory: [(Vec<u8>, Vec<u32>); 2] =
                std::array::from_fn(|_| (vec![0xAA; 40 * 12 * 3], vec![u32::MAX; marks_words(12)]));
            let mut assemblers: Vec<_> = (0..)
                .zip(&mut memory)
                .map(|(stream, (picture, marks))| Assembler::new(stream, picture, marks, small_table))
                .collect();
            let (mut body, mut frames) = ([0; BODY_MAX], Vec::new());
            let mut inbox = Inbox::new(&mut body, small_table);
            for piece in wire.chunks(chunk) {
                inbox.feed(piece, |received| {
                    let Received::Packet(packet) = received else { return };
                    for (stream, assembler) in (0..).zip(&mut assemblers) {
                        assembler.push(&packet, &mut |frame| frames.push(told(stream, &frame)));
                    }
                });
            }
            let name = &vector["name"];
            let counts = inbox.counts();
            let unfit: u32 = assemblers.iter().map(|assembler| assembler.dropped().unfit).sum();
            let counts = json!({
                "received": counts.received, "damaged": counts.damaged, "malformed": counts.malformed,
                "other_version": counts.other_version, "unknown_kind": counts.unknown_kind, "unfit": unfit,
            });
            assert_eq!(counts, vector["counts"], "{name}");
            let expected: Vec<_> = vector["frames"].as_array().unwrap().to_vec();
            assert_eq!(frames.len(), expected.len(), "{name}");
            for ((words, picture), mut expected) in frames.iter().zip(expected) {
                let file = file(&expected.as_object_mut().unwrap().remove("picture").unwrap());
                assert_eq!(words, &expected, "{name}");
                assert!(picture == &file, "{name}: {words}");
            }
        }
    }
}
