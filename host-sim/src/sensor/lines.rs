use firmware::camif::pins::Samples;

use crate::profile::Profile;

/// Room for the samples of a line, so that no frame allocates anew.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    words: Vec<u16>,
    /// Room for a line with codes around it.
    pub(super) bytes: Vec<u8>,
}

impl Lines {
    /// The samples of a line as DMA wrote it.
    pub(super) fn samples<'a>(&'a mut self, profile: &Profile, line: &'a [u8]) -> Samples<'a> {
        if profile.bus.bits == 8 {
            return Samples::Bytes(line);
        }
        let mask = (1u16 << profile.bus.bits.min(15)) - 1;
        let (pairs, _) = line.as_chunks::<2>();
        self.words.clear();
        self.words.extend(pairs.iter().map(|pair| u16::from_le_bytes(*pair) & mask));
        Samples::Words(&self.words)
    }
}

/// The lines of a frame's bytes.
pub(super) fn lines_of<'a>(profile: &Profile, frame: &'a [u8]) -> std::slice::Chunks<'a, u8> {
    frame.chunks((profile.bytes_per_line() as usize).max(1))
}
