use std::fmt::Write as _;

use super::{Choice, Profile};

impl Profile {
    /// The profile as TOML text, which [`Profile::from_toml`] reads back to the same profile.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let mut text = String::new();
        let mut line = |arguments: std::fmt::Arguments<'_>| {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{arguments}");
        };
        line(format_args!("name = {}", quoted(&self.name)));
        line(format_args!("about = {}", quoted(&self.about)));
        line(format_args!("\n[bus]"));
        line(format_args!("bits = {}", self.bus.bits));
        line(format_args!("clock_edge = \"{}\"", self.bus.clock_edge.name()));
        line(format_args!("sync = \"{}\"", self.bus.sync.name()));
        line(format_args!("hsync_blank = \"{}\"", self.bus.hsync_blank.name()));
        line(format_args!("vsync_blank = \"{}\"", self.bus.vsync_blank.name()));
        line(format_args!("\n[frame]"));
        line(format_args!("width = {}", self.frame.width));
        line(format_args!("height = {}", self.frame.height));
        line(format_args!("format = \"{}\"", self.frame.format.name()));
        if self.frame.is_bayer() {
            line(format_args!("bayer = \"{}\"", self.frame.bayer.name()));
        }
        line(format_args!("\n[timing]"));
        line(format_args!("pclk_hz = {}", self.timing.pclk_hz));
        line(format_args!("hblank = {}", self.timing.hblank));
        line(format_args!("vblank = {}", self.timing.vblank));
        line(format_args!("vfront = {}", self.timing.vfront));
        line(format_args!("vback = {}", self.timing.vback));
        text
    }
}
