//! How many bytes a frame takes on the serial link, by each encoding, and how many frames a second that is: the page
//! `docs/link-sizes.md`.

use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

use camif_tests::page::same_page;
use firmware::link::packet::{FrameStart, Meaning};
use firmware::link::{BODY_MAX, Choice, Encoding, Format, Sender, small_table, wire_bytes};
use host_sim::picture;
use host_sim::pipeline::{Picture, Pipeline, Runner};
use host_sim::scene::{Scene, Still};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};

const EDGES: &str = "gray|canny:low=50,high=150";

/// A picture in one format, as it is sent and as its peers take it.
struct Sent<'a> {
    format: Format,
    width: u32,
    height: u32,
    bytes: &'a [u8],
}

impl Sent<'_> {
    /// Bytes on the wire, from FRAME to END.
    fn by(&self, choice: Choice) -> usize {
        let (mut memory, mut wire) = (vec![0; wire_bytes(BODY_MAX)], Vec::new());
        let mut sender = Sender::new(&mut wire, &mut memory, small_table);
        let start = FrameStart {
            stream: 0,
            format: self.format,
            meaning: Meaning::default(),
            snapshot: false,
            sequence: 1,
            width: self.width as u16,
            height: self.height as u16,
            captured: 0,
            palette: 0,
        };
        let mut frame = sender.begin(start, choice).unwrap();
        let line = self.format.line_bytes(self.width as usize);
        for (number, pixels) in (0..).zip(self.bytes.chunks(line)) {
            sender.line(&mut frame, number, pixels).unwrap();
        }
        sender.end(frame.end()).unwrap();
        wire.len()
    }

    fn png(&self) -> usize {
        let color = match self.format {
            Format::RGB888 => ExtendedColorType::Rgb8,
            _ => ExtendedColorType::L8,
        };
        let mut file = Cursor::new(Vec::new());
        PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive)
            .write_image(self.bytes, self.width, self.height, color)
            .unwrap();
        file.into_inner().len()
    }

    /// QOI has no gray: it goes as equal red, green and blue.
    fn qoi(&self) -> usize {
        let rgb: Vec<u8> = match self.format {
            Format::RGB888 => self.bytes.to_vec(),
            _ => self.bytes.iter().flat_map(|&gray| [gray; 3]).collect(),
        };
        qoi::encode_to_vec(&rgb, self.width, self.height).unwrap().len()
    }
}

/// A number with commas between thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn pictures() -> Vec<(String, RgbImage)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/photographs/colour");
    let photograph =
        |name: &str| (name.to_owned(), picture::read(&folder.join(format!("{name}.jpg"))).unwrap());
    let mut all: Vec<_> = ["astronaut", "chelsea", "coffee", "rocket"].map(photograph).into();
    all.push(("the scene `demo`".to_owned(), Scene::Demo { seed: 0 }.render(0, 640, 480)));
    all.push(("the scene `bars`".to_owned(), Scene::Bars.render(0, 640, 480)));
    all
}

fn edges(picture: &RgbImage) -> Vec<u8> {
    let pipeline: Pipeline = EDGES.parse().unwrap();
    Runner::new(&pipeline).run(Picture::from_image(picture)).unwrap().into_gray().pixels().to_vec()
}

fn gray(picture: &RgbImage) -> Vec<u8> {
    Picture::from_image(picture).into_gray().pixels().to_vec()
}

/// A table of one format: a row for each picture, a column for each encoding, QOI and PNG.
fn table(page: &mut String, format: Format, encodings: &[Encoding], make: fn(&RgbImage) -> Vec<u8>) {
    let one = |encoding: &Encoding| (encoding.name(), Choice::One(*encoding));
    let columns: Vec<_> = encodings.iter().map(one).chain([("auto", Choice::Sender)]).collect();
    let names: Vec<_> = columns.iter().map(|(name, _)| format!("`{name}`")).collect();
    writeln!(page, "| picture | pixels' bytes | {} | QOI file | PNG file |", names.join(" | ")).unwrap();
    writeln!(page, "|---|---:|{}---:|---:|", "---:|".repeat(columns.len())).unwrap();
    for (name, picture) in pictures() {
        let bytes = make(&picture);
        let (width, height) = picture.dimensions();
        let sent = Sent { format, width, height, bytes: &bytes };
        let sizes = columns.iter().map(|&(_, choice)| sent.by(choice));
        let sizes: Vec<_> = sizes.chain([sent.qoi(), sent.png()]).map(grouped).collect();
        let raw = grouped(bytes.len());
        writeln!(page, "| {name}, {width} × {height} | {raw} | {} |", sizes.join(" | ")).unwrap();
    }
    page.push('\n');
}

/// Frames a second of the four pictures at VGA, by rates of the line in bytes a second.
fn rates(page: &mut String) {
    let still = |name: &str, picture: RgbImage| Still::new(name.into(), picture);
    let (_, photograph) = pictures().swap_remove(2);
    let coffee = still("coffee", photograph);
    let lines = [("921,600 baud", 92_160.0), ("3,000,000 baud", 300_000.0), ("USB full speed", 1_216_000.0)];
    writeln!(page, "| frames | bytes on the wire | {} |", lines.map(|(name, _)| name).join(" | ")).unwrap();
    writeln!(page, "|---|---:|---:|---:|---:|").unwrap();
    for (size, (width, height)) in [("VGA", (640, 480)), ("QVGA", (320, 240))] {
        let picture = coffee.scaled(width, height);
        let rows = [
            ("`rgb888`, `raw`", Format::RGB888, Choice::One(Encoding::Raw), picture.as_raw().clone()),
            ("`rgb888`, `qoi`", Format::RGB888, Choice::One(Encoding::Qoi), picture.as_raw().clone()),
            ("`gray8`, `raw`", Format::GRAY8, Choice::One(Encoding::Raw), gray(&picture)),
            ("`gray8`, `qoi`", Format::GRAY8, Choice::One(Encoding::Qoi), gray(&picture)),
            ("edges, `auto`", Format::GRAY8, Choice::Sender, edges(&picture)),
        ];
        for (name, format, choice, bytes) in rows {
            let wire = Sent { format, width, height, bytes: &bytes }.by(choice);
            let rates: Vec<_> = lines.iter().map(|(_, rate)| format!("{:.2}", rate / wire as f64)).collect();
            writeln!(page, "| {size} {name} | {} | {} |", grouped(wire), rates.join(" | ")).unwrap();
        }
    }
}

#[test]
fn the_page_tells_what_a_frame_takes() {
    let mut page = String::from(
        "# Bytes a frame on the serial link\n\n\
         Counted, not estimated: `cargo test -p camif-tests --test link_sizes` sends each picture and fails if this page \
         says otherwise;\nwith `BLESS=1` it writes the page. Bytes are those on the wire, from FRAME to END, framing and CRCs \
         included. `auto` is the\nsender's own choice for each line. QOI and PNG are whole files by the crates `qoi` and \
         `image` (default compression, adaptive\nfilters): they see the frame as a whole, where a packet of the link is \
         decoded by itself, so that a lost one costs its own line and\nno other. [link.md](link.md) has all else.\n\n\
         ## Colour\n",
    );
    table(&mut page, Format::RGB888, &[Encoding::Raw, Encoding::RunLength, Encoding::Qoi], |picture| {
        picture.as_raw().clone()
    });
    page.push_str("## Gray\nQOI has no gray; it is given equal red, green and blue.\n\n");
    table(&mut page, Format::GRAY8, &[Encoding::Raw, Encoding::RunLength, Encoding::Qoi], gray);
    write!(page, "## Edges\nOf `{EDGES}`.\n\n").unwrap();
    let all = [Encoding::Raw, Encoding::RunLength, Encoding::Qoi, Encoding::Bits, Encoding::BitsRunLength];
    table(&mut page, Format::GRAY8, &all, edges);
    page.push_str(
        "## Frames a second\n\
         The photograph `coffee`, scaled. A UART takes ten bits a byte (8N1). Full-speed USB is *computed*, not measured: at most \
         19 bulk\npackets of 64 bytes fit a frame of 1 ms (USB 2.0, table 5-9), so 1,216,000 bytes a second is what no device \
         exceeds; it assumes\na bus with nothing else on it and firmware that always has a packet ready.\n\n",
    );
    rates(&mut page);
    same_page("link-sizes.md", &page, "--test link_sizes");
}

/// What the protocol's page says of raw VGA lines.
#[test]
fn framing_adds_less_than_one_and_a_half_percent() {
    let bytes: Vec<u8> = (0..640 * 480 * 3_u32).map(|at| at as u8 | 1).collect();
    let sent = Sent { format: Format::RGB888, width: 640, height: 480, bytes: &bytes };
    assert_eq!(sent.by(Choice::One(Encoding::Raw)), 480 * 1947 + 35 + 63);
    // And no picture, whatever zeros are in it, takes more.
    for step in [2, 3, 255, 256, 257] {
        let bytes: Vec<u8> =
            (0..640 * 480 * 3_u32).map(|at| if at.is_multiple_of(step) { 0 } else { 7 }).collect();
        let wire = Sent { bytes: &bytes, ..sent }.by(Choice::One(Encoding::Raw));
        assert!((wire as f64) <= 1.015 * bytes.len() as f64, "{wire}");
    }
}
