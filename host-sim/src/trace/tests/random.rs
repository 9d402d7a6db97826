//! Random dumps against a reader written from the definition, and round trips.

use super::*;

/// Identifiers, and for each of their bits the wire it is.
type Wires = Vec<(String, Vec<(usize, u32)>)>;

/// A reader written from the definition: lines, words, a map of names. Only for text of one word or change a line.
fn naive(text: &str, widths: &[(String, Vec<(usize, u32)>)]) -> Vec<Clock> {
    let (mut state, mut before, mut clocks) = (0_u32, 0_u32, Vec::new());
    let mut end_of_stamp = |state: u32| {
        if state >> 18 & 1 == 1 && before >> 18 & 1 == 0 {
            clocks.push((state >> 16 & 1 == 1, state >> 17 & 1 == 1, (state & 0x3FFF) as u16));
        }
        before = state;
    };
    let changes = text.split("$enddefinitions $end\n").nth(1).unwrap();
    for line in changes.lines() {
        if line.starts_with('#') {
            end_of_stamp(state);
            continue;
        }
        let (digits, id) = match line.strip_prefix('b') {
            Some(vector) => vector.split_once(' ').unwrap(),
            None => line.split_at(1),
        };
        let (_, taps) = widths.iter().find(|(name, _)| name == id).unwrap();
        for &(bit, wire) in taps {
            let high = digits.chars().rev().nth(bit) == Some('1');
            state = state & !(1 << wire) | u32::from(high) << wire;
        }
    }
    end_of_stamp(state);
    clocks
}

/// Random identifiers, layouts, values and times.
fn random_dump() -> impl Strategy<Value = (String, Wires)> {
    // Of one length or of several.
    let ids = prop_oneof![Just("[!-~]"), Just("[!-~]{2}"), Just("[!-~]{3}"), Just("[!-~]{1,9}")]
        .prop_flat_map(|id| proptest::collection::hash_set(id, 14));
    let changes = proptest::collection::vec((0..14_usize, any::<u16>(), 0..6_u64, 0..3_u8), 1..400);
    (ids, any::<bool>(), changes, 0..10_000_000_000_000_000_u64).prop_map(|(ids, bus, changes, start)| {
        let ids: Vec<String> = ids.into_iter().collect();
        let mut text = String::from("$timescale 1ps $end\n");
        let mut wires = Vec::new();
        let mut declare = |id: &str, width: usize, name: &str, wire: Option<u32>| {
            writeln!(text, "$var wire {width} {id} {name} $end").unwrap();
            let taps =
                wire.map_or(Vec::new(), |wire| (0..width).map(|bit| (bit, wire + bit as u32)).collect());
            wires.push((id.to_owned(), taps));
        };
        declare(&ids[0], 1, "pclk", Some(18));
        declare(&ids[1], 1, "hsync", Some(16));
        declare(&ids[2], 1, "vsync", Some(17));
        declare(&ids[3], 1, "unused", None);
        declare(&ids[4], 20, "wide", None);
        if bus {
            declare(&ids[5], 10, "data [9:0]", Some(0));
        } else {
            for line in 0..8 {
                declare(&ids[5 + line], 1, &format!("d{line}"), Some(line as u32));
            }
        }
        text.push_str("$enddefinitions $end\n");
        // An edge for certain.
        writeln!(text, "#{start}\n0{0}\n#{1}\n1{0}\n#{2}", ids[0], start + 1, start + 2).unwrap();
        let mut time = start + 2;
        for (which, value, wait, digits) in changes {
            time += wait;
            let which = which % wires.len();
            let width = [1, 1, 1, 1, 20, 10][if which < 5 || bus { which } else { 0 }];
            if wait > 0 {
                writeln!(text, "#{time}").unwrap();
            }
            let value = u32::from(value) << 4 & ((1 << width) - 1) | u32::from(value) & 1;
            match (width, digits) {
                (1, 0) => writeln!(text, "b{value} {}", ids[which]).unwrap(),
                (1, _) => writeln!(text, "{value}{}", ids[which]).unwrap(),
                (_, 0) => writeln!(text, "b{value:b} {}", ids[which]).unwrap(),
                _ => writeln!(text, "b{value:0width$b} {}", ids[which]).unwrap(),
            }
        }
        (text, wires)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn any_dump_reads_as_the_definition_says((text, wires) in random_dump()) {
        prop_assert_eq!(usual(&text).unwrap(), naive(&text, &wires));
    }

    #[test]
    fn what_is_written_is_read(
        clocks in proptest::collection::vec((any::<bool>(), any::<bool>(), 0..0x1000_u16), 1..300),
        bus in any::<bool>(), with_edge in any::<bool>(), falling in any::<bool>(), hertz in 1..500_000_000_u32,
    ) {
        let edge = if falling { Edge::Falling } else { Edge::Rising };
        let options = VcdWriterOptions {
            layout: if bus { Layout::Bus } else { Layout::Wires },
            style: if with_edge { Style::WithEdge } else { Style::OppositeEdge },
            edge,
            names: VcdNames { hsync: "HREF".into(), data: "DOUT".into(), ..VcdNames::default() },
            ..VcdWriterOptions::new(12, hertz)
        };
        let mut writer = VcdWriter::new(Vec::new(), options).unwrap();
        send(&clocks, &mut writer).unwrap();
        let (text, count) = writer.finish().unwrap();
        prop_assert_eq!(count, clocks.len() as u64);
        let (read, _) = read(&text, &CaptureOptions { edge, ..CaptureOptions::default() }).unwrap();
        prop_assert_eq!(read, clocks);
    }
}
