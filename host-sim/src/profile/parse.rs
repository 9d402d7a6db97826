use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;
use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::check::{Range, SIZE, allowed_bits};
use super::{Bus, Choice, Frame, Level, Profile, ProfileError, SyncMode, Timing, check, nearest};

/// What a profile is called whose text does not say.
pub(super) const UNNAMED: &str = "unnamed";

/// The sections with their keys. The first is the top level.
const SECTIONS: [(&str, &[&str]); 4] = [
    ("", &["name", "about", "bus", "frame", "timing"]),
    ("bus", &["bits", "clock_edge", "sync", "hsync_blank", "vsync_blank"]),
    ("frame", &["width", "height", "format", "bayer"]),
    ("timing", &["pclk_hz", "hblank", "vblank", "vfront", "vback"]),
];

impl Profile {
    /// Reads a profile from its TOML text and checks it.
    ///
    /// `frame.width`, `frame.height` and `frame.format` must be there. Of the rest, `bus` is by default 8 bits, rising
    /// edge, `gated`, both blanking levels high, and `timing` the blanking that the sync mode needs at 24 MHz.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line: see [`ProfileError`].
    pub fn from_toml(text: &str) -> Result<Self, ProfileError> {
        let table = DeTable::parse(text).map_err(|error| ProfileError::Syntax {
            line: line_of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().replace('\n', ", "),
        })?;
        let top = Section { name: "", table: Some(table.get_ref()), text };
        top.refuse_unknown_keys()?;
        let (bus, frame, timing) = (top.section("bus")?, top.section("frame")?, top.section("timing")?);

        let bus = Bus {
            bits: bus.integer("bits", allowed_bits(), |bits| check::BITS.contains(&bits))?.unwrap_or(8),
            clock_edge: bus.word("clock_edge")?.unwrap_or(Edge::Rising),
            sync: bus.word("sync")?.unwrap_or(SyncMode::Gated),
            hsync_blank: bus.word("hsync_blank")?.unwrap_or(Level::High),
            vsync_blank: bus.word("vsync_blank")?.unwrap_or(Level::High),
        };
        let mut frame = Frame {
            width: frame.needed("width", SIZE)?,
            height: frame.needed("height", SIZE)?,
            format: frame.word("format")?.ok_or_else(|| frame.missing("format", words::<Format>()))?,
            bayer: frame.word("bayer")?.unwrap_or(BayerOrder::Rggb),
        };
        if !frame.is_bayer() {
            // The order of a mosaic that is not there must not make two profiles differ.
            frame.bayer = BayerOrder::Rggb;
        }
        let usual = usual_timing(&bus, &frame);
        let blank = |key, range, usual| timing.ranged(key, range).map(|value| value.unwrap_or(usual));
        let timing = Timing {
            pclk_hz: timing.ranged("pclk_hz", check::PCLK)?.unwrap_or(usual.pclk_hz),
            hblank: blank("hblank", check::HBLANK, usual.hblank)?,
            vblank: blank("vblank", check::VBLANK, usual.vblank)?,
            vfront: blank("vfront", check::VBLANK, usual.vfront)?,
            vback: blank("vback", check::VBLANK, usual.vback)?,
        };
        let name = top.string("name")?.unwrap_or_else(|| UNNAMED.to_owned());
        let about = top.string("about")?.unwrap_or_default();
        let profile = Self { name, about, bus, frame, timing };
        profile.check()?;
        Ok(profile)
    }
}

/// The timing of a profile that leaves it out: as little blanking as sensors have, three blank lines a frame.
fn usual_timing(bus: &Bus, frame: &Frame) -> Timing {
    let line = frame.width * frame.samples_per_pixel();
    let (hblank, blank_lines) = if bus.sync == SyncMode::Marker { (0, 0) } else { (16, 3) };
    let vblank = hblank + blank_lines * (line + hblank);
    Timing { pclk_hz: 24_000_000, hblank, vblank, vfront: 0, vback: 0 }
}

/// The words of a choice, for people.
fn words<T: Choice>() -> String {
    let names: Vec<_> = T::NAMES.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    format!("one of {}", names.join(", "))
}

/// The line, from 1, in which byte `at` of the text stands.
fn line_of(text: &str, at: usize) -> usize {
    text.bytes().take(at).filter(|byte| *byte == b'\n').count() + 1
}

/// A section of the text. One that is not there has no keys, and its defaults count.
struct Section<'a> {
    name: &'static str,
    table: Option<&'a DeTable<'a>>,
    text: &'a str,
}

impl<'a> Section<'a> {
    fn get(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table?.get(key)
    }

    fn line(&self, value: &Spanned<DeValue<'_>>) -> usize {
        line_of(self.text, value.span().start)
    }

    fn refuse_unknown_keys(&self) -> Result<(), ProfileError> {
        let keys = SECTIONS.iter().find(|(name, _)| *name == self.name).map_or(&[][..], |(_, keys)| keys);
        for (key, value) in self.table.into_iter().flatten() {
            let written: &str = key.get_ref();
            if keys.contains(&written) {
                continue;
            }
            // A section is not mistaken for a key, nor the other way about.
            let is_section = matches!(value.get_ref(), DeValue::Table(_));
            let alike =
                keys.iter().copied().filter(|key| SECTIONS.iter().any(|(name, _)| name == key) == is_section);
            // A key that is right elsewhere was put in the wrong section.
            let nearest = match SECTIONS.iter().find(|(_, keys)| keys.contains(&written)) {
                Some(("", _)) => format!("`{written}` at the top, before any section"),
                Some((section, _)) => format!("`{written}` in [{section}]"),
                None => {
                    format!("`{}`", nearest(written, alike).or(keys.first().copied()).unwrap_or_default())
                }
            };
            let section =
                if self.name.is_empty() { "the top level".to_owned() } else { format!("[{}]", self.name) };
            let line = line_of(self.text, key.span().start);
            return Err(ProfileError::UnknownKey { line, section, key: written.to_owned(), nearest });
        }
        Ok(())
    }

    fn section(&self, name: &'static str) -> Result<Section<'a>, ProfileError> {
        let table = match self.get(name) {
            None => None,
            Some(value) => match value.get_ref() {
                DeValue::Table(table) => Some(table),
                _ => return Err(self.wrong_type(name, value, format!("a section, written `[{name}]`"))),
            },
        };
        let section = Section { name, table, text: self.text };
        section.refuse_unknown_keys()?;
        Ok(section)
    }

    fn string(&self, key: &'static str) -> Result<Option<String>, ProfileError> {
        match self.get(key) {
            None => Ok(None),
            Some(value) => match value.get_ref() {
                DeValue::String(string) => Ok(Some(string.clone().into_owned())),
                _ => Err(self.wrong_type(key, value, "text in quotes".to_owned())),
            },
        }
    }

    fn word<T: Choice>(&self, key: &'static str) -> Result<Option<T>, ProfileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let DeValue::String(word) = value.get_ref() else {
            return Err(self.wrong_type(key, value, words::<T>()));
        };
        T::from_name(word).map(Some).ok_or_else(|| ProfileError::Word {
            line: self.line(value),
            key,
            got: word.clone().into_owned(),
            nearest: nearest(word, T::NAMES.iter().map(|(name, _)| *name)).unwrap_or_default(),
            allowed: words::<T>(),
        })
    }

    fn integer(
        &self,
        key: &'static str,
        allowed: String,
        is_right: impl Fn(u32) -> bool,
    ) -> Result<Option<u32>, ProfileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let DeValue::Integer(integer) = value.get_ref() else {
            return Err(self.wrong_type(key, value, allowed));
        };
        match to_u32(integer).filter(|integer| is_right(*integer)) {
            Some(integer) => Ok(Some(integer)),
            None => Err(ProfileError::Range {
                line: Some(self.line(value)),
                key,
                got: integer.to_string(),
                allowed,
            }),
        }
    }

    fn ranged(&self, key: &'static str, range: Range) -> Result<Option<u32>, ProfileError> {
        self.integer(key, range.to_string(), |value| range.contains(value))
    }

    fn needed(&self, key: &'static str, range: Range) -> Result<u32, ProfileError> {
        self.ranged(key, range)?.ok_or_else(|| self.missing(key, range.to_string()))
    }

    fn missing(&self, key: &'static str, allowed: String) -> ProfileError {
        ProfileError::Missing { section: self.name, key, allowed }
    }

    fn wrong_type(&self, key: &'static str, value: &Spanned<DeValue<'_>>, allowed: String) -> ProfileError {
        let got = match value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) => "a whole number",
            DeValue::Float(_) => "a number with a fraction",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a section",
        };
        ProfileError::Type { line: self.line(value), key, got: got.to_owned(), allowed }
    }
}

fn to_u32(integer: &DeInteger<'_>) -> Option<u32> {
    u32::from_str_radix(integer.as_str(), integer.radix()).ok()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const LEAST: &str = "[frame]\nwidth = 8\nheight = 4\nformat = \"gray8\"\n";

    fn message(text: &str) -> String {
        Profile::from_toml(text).unwrap_err().to_string()
    }

    #[test]
    fn the_rest_has_defaults() {
        let profile = Profile::from_toml(LEAST).unwrap();
        assert_eq!(profile.name, UNNAMED);
        assert_eq!(profile.bus.sync, SyncMode::Gated);
        assert_eq!((profile.timing.hblank, profile.timing.vblank), (16, 16 + 3 * 24));
        for sync in ["marker", "embedded"] {
            Profile::from_toml(&format!("{LEAST}[bus]\nsync = \"{sync}\"")).unwrap();
        }
        let hexadecimal = LEAST.replace("= 8", "= 0x1_0");
        assert_eq!(Profile::from_toml(&hexadecimal).unwrap().frame.width, 16);
    }

    #[test]
    fn what_is_wrong_has_a_place_and_a_remedy() {
        for (text, expected) in [
            ("[bus]\nbit = 8", "line 2: unknown key `bit` in [bus]; did you mean `bits`?"),
            (
                "[bus]\nhblank = 8",
                "line 2: unknown key `hblank` in [bus]; did you mean `hblank` in [timing]?",
            ),
            ("[fame]", "line 1: unknown key `fame` in the top level; did you mean `frame`?"),
            ("width = 8", "line 1: unknown key `width` in the top level; did you mean `width` in [frame]?"),
            (
                "[frame]\nname = \"x\"",
                "line 2: unknown key `name` in [frame]; did you mean `name` at the top",
            ),
            ("[bus]\nbits = 9", "line 2: `bits` is 9; it must be 8, 10, 12 or 14"),
            ("[bus]\nbits = \"8\"", "line 2: `bits` is text; it must be 8, 10, 12 or 14"),
            (
                "\n\n[bus]\nsync = \"markers\"",
                "line 4: `sync` is \"markers\"; did you mean \"marker\"? It must be one of",
            ),
            ("bus = 3", "line 1: `bus` is a whole number; it must be a section, written `[bus]`"),
            ("[frame]\nheight = 4", "[frame] lacks `width`: 1 to 8192 pixels"),
            ("[frame]\nwidth = 0", "line 2: `width` is 0; it must be 1 to 8192 pixels"),
            ("[frame]\nwidth = -1", "line 2: `width` is -1; it must be 1 to 8192 pixels"),
            ("[frame]\nwidth = 1.5", "line 2: `width` is a number with a fraction; it must be"),
            ("[frame]\nwidth = 99999999999999999999999", "line 2: `width` is 99999999999999999999999; it"),
            ("[bus\nbits = 8", "line 1: "),
            ("", "[frame] lacks `width`"),
        ] {
            let message = message(text);
            assert!(message.starts_with(expected), "{text}\n{message}");
        }
    }

    #[test]
    fn what_does_not_go_together_has_a_remedy() {
        let with = |bus: &str, frame: &str, timing: &str| {
            message(&format!("[bus]\n{bus}\n[frame]\nheight = 4\n{frame}\n[timing]\n{timing}"))
        };
        let (gray, raw) = ("width = 8\nformat = \"gray8\"", "width = 8\nformat = \"raw10\"");
        for (message, remedy) in [
            (with("bits = 10", gray, ""), "set `bits = 8`"),
            (with("", raw, ""), "set `bits = 10`"),
            (with("bits = 10\nsync = \"embedded\"", raw, ""), "set `bits = 8` and a format"),
            (with("", "width = 7\nformat = \"yuyv\"", ""), "set `width = 8`"),
            (with("sync = \"marker\"", gray, "hblank = 1"), "set `hblank = 0`"),
            (with("sync = \"marker\"", "width = 1\nformat = \"gray8\"", ""), "set `width` to 2"),
            (with("", gray, "hblank = 0"), "set `hblank` to 1"),
            (with("", gray, "vblank = 0"), "set `vblank` to 1"),
            (with("", gray, "vblank = 5\nvfront = 2\nvback = 3"), "set `vblank` to 6"),
            (with("sync = \"marker\"", gray, "vback = 3"), "remove them"),
            (with("sync = \"embedded\"", gray, "hblank = 7"), "set `hblank` to 8"),
            (with("sync = \"embedded\"", gray, "hblank = 8\nvblank = 23"), "set `vblank` to 24"),
        ] {
            assert!(message.contains(remedy), "{message}");
        }
    }

    fn profiles() -> impl Strategy<Value = Profile> {
        let bus = (
            prop::sample::select(&check::BITS[..]),
            prop::sample::select(Edge::NAMES),
            prop::sample::select(SyncMode::NAMES),
            prop::sample::select(Level::NAMES),
            prop::sample::select(Level::NAMES),
        );
        let frame = (
            1..=8_192u32,
            1..=8_192u32,
            prop::sample::select(Format::NAMES),
            prop::sample::select(BayerOrder::NAMES),
        );
        let timing = (1..=1_000_000_000u32, 0..100_000u32, 0..1_000_000u32, 0..3u32, 0..3u32);
        (any::<String>(), any::<String>(), bus, frame, timing).prop_map(
            |(name, about, bus, frame, timing)| Profile {
                name,
                about,
                bus: Bus {
                    bits: bus.0,
                    clock_edge: bus.1.1,
                    sync: bus.2.1,
                    hsync_blank: bus.3.1,
                    vsync_blank: bus.4.1,
                },
                frame: Frame { width: frame.0, height: frame.1, format: frame.2.1, bayer: frame.3.1 },
                timing: Timing {
                    pclk_hz: timing.0,
                    hblank: timing.1,
                    vblank: timing.2,
                    vfront: timing.3,
                    vback: timing.4,
                },
            },
        )
    }

    proptest! {
        /// Text written is text read, and reading refuses exactly what checking refuses.
        #[test]
        fn written_profiles_read_back(mut profile in profiles()) {
            if !profile.frame.is_bayer() {
                profile.frame.bayer = BayerOrder::Rggb;
            }
            prop_assert_eq!(Profile::from_toml(&profile.to_toml()).map(|read| read == profile), profile.check().map(|()| true));
        }

        /// No text makes the reader panic.
        #[test]
        fn any_text_is_read_or_refused(text in "[a-z_\\[\\]=\" 0-9\n.{}-]{0,80}") {
            let _ = Profile::from_toml(&text);
        }
    }
}
