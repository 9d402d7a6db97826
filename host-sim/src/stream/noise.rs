use std::str::FromStr;

use crate::fault::Random;

/// How often something goes wrong on a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Bits that are flipped, of all bits.
    pub bits: f64,
    /// Packets that are lost whole, of all packets.
    pub lost: f64,
    /// Bytes that are lost, of all bytes.
    pub dropped: f64,
    /// Bytes of noise that come between others, for each byte.
    pub inserted: f64,
}

/// Why text is no noise.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{part}` is no noise; write KEY=RATE and commas between, with rates from 0 to 1 of the keys bits (flipped), lost (packets), \
     dropped and inserted (bytes), for instance bits=1e-5,lost=0.01"
)]
pub struct NoiseSyntaxError {
    /// The part that could not be read.
    pub part: String,
}

impl FromStr for Rates {
    type Err = NoiseSyntaxError;

    fn from_str(text: &str) -> Result<Self, NoiseSyntaxError> {
        let mut rates = Self::default();
        for part in text.split(',') {
            let wrong = || NoiseSyntaxError { part: part.to_owned() };
            let (key, value) = part.split_once('=').ok_or_else(wrong)?;
            let rate = match key.trim() {
                "bits" => &mut rates.bits,
                "lost" => &mut rates.lost,
                "dropped" => &mut rates.dropped,
                "inserted" => &mut rates.inserted,
                _ => return Err(wrong()),
            };
            *rate = value.trim().parse().ok().filter(|rate| (0.0..=1.0).contains(rate)).ok_or_else(wrong)?;
        }
        Ok(rates)
    }
}

/// What went wrong so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Bits flipped.
    pub bits: u64,
    /// Packets lost.
    pub lost: u64,
    /// Bytes lost.
    pub dropped: u64,
    /// Bytes inserted.
    pub inserted: u64,
}

/// Trials of one rate: which of them hit. Gaps between hits are drawn, so that a rare event costs next to nothing.
#[derive(Clone, Debug)]
struct Trials {
    rate: f64,
    random: Random,
    /// Misses before the next hit.
    misses: u64,
}

impl Trials {
    fn new(rate: f64, seed: u64) -> Self {
        let mut trials = Self { rate, random: Random::new(seed), misses: 0 };
        trials.draw();
        trials
    }

    /// A gap of the geometric distribution.
    fn draw(&mut self) {
        let uniform = ((self.random.bits() >> 11) + 1) as f64 / (1u64 << 53) as f64;
        self.misses = match self.rate {
            rate if rate <= 0.0 => u64::MAX,
            rate if rate >= 1.0 => 0,
            // Casts of floats saturate.
            rate => (uniform.ln() / (-rate).ln_1p()) as u64,
        };
    }

    /// The first hit among so many trials; those up to it are used up.
    fn hit_within(&mut self, trials: u64) -> Option<u64> {
        let misses = self.misses;
        if misses >= trials {
            // Without a rate there is nothing to count down from.
            if self.rate > 0.0 {
                self.misses -= trials;
            }
            return None;
        }
        self.draw();
        Some(misses)
    }
}

/// Noise on one direction of a line, the same for the same seed and the same bytes.
#[derive(Clone, Debug)]
pub struct Noise {
    bits: Trials,
    lost: Trials,
    dropped: Trials,
    inserted: Trials,
    random: Random,
    /// The packet that passes is being lost.
    losing: bool,
    /// The last byte ended a packet.
    between: bool,
    quiet: bool,
    damage: Damage,
}

impl Noise {
    /// With these rates.
    #[must_use]
    pub fn new(rates: Rates, seed: u64) -> Self {
        let mut seeds = Random::new(seed);
        let mut trials = |rate| Trials::new(rate, seeds.bits());
        Self {
            bits: trials(rates.bits),
            lost: trials(rates.lost),
            dropped: trials(rates.dropped),
            inserted: trials(rates.inserted),
            random: Random::new(seed ^ 0x006E_6F69_7365),
            losing: false,
            between: true,
            quiet: rates == Rates::default(),
            damage: Damage::default(),
        }
    }

    /// What went wrong so far.
    #[must_use]
    pub fn damage(&self) -> Damage {
        self.damage
    }

    /// Appends to `out` what becomes of some bytes.
    pub fn pass(&mut self, bytes: &[u8], out: &mut Vec<u8>) {
        if self.quiet {
            return out.extend_from_slice(bytes);
        }
        for &byte in bytes {
            let ends = byte == 0;
            if self.between && !ends && self.lost.hit_within(1).is_some() {
                self.losing = true;
                self.damage.lost += 1;
            }
            let lost = self.losing;
            self.between = ends;
            self.losing &= !ends;
            if lost {
                continue;
            }
            if self.inserted.hit_within(1).is_some() {
                out.push(self.random.below(256) as u8);
                self.damage.inserted += 1;
            }
            if self.dropped.hit_within(1).is_some() {
                self.damage.dropped += 1;
                continue;
            }
            out.push(self.flipped(byte));
        }
    }

    fn flipped(&mut self, mut byte: u8) -> u8 {
        let mut start = 0;
        while let Some(misses) = self.bits.hit_within(8 - start) {
            byte ^= 1 << (start + misses);
            self.damage.bits += 1;
            start += misses + 1;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(rates: Rates, bytes: &[u8]) -> (Vec<u8>, Damage) {
        let (mut noise, mut out) = (Noise::new(rates, 11), Vec::new());
        // In pieces, which makes no difference.
        bytes.chunks(997).for_each(|piece| noise.pass(piece, &mut out));
        (out, noise.damage())
    }

    #[test]
    fn a_quiet_line_changes_nothing() {
        let bytes: Vec<u8> = (0..100_000_u32).map(|at| at as u8).collect();
        assert_eq!(passed(Rates::default(), &bytes), (bytes, Damage::default()));
    }

    /// Counts within four standard deviations of what the rates say, and what is counted is what happened.
    #[test]
    fn rates_are_kept() {
        let bytes = vec![0x55; 1_000_000];
        let near = |count: u64, trials: f64, rate: f64| {
            let expected = trials * rate;
            (count as f64 - expected).abs() < 4.0 * expected.sqrt()
        };
        let (out, damage) = passed(Rates { bits: 1e-3, ..Rates::default() }, &bytes);
        let flips: u64 = out.iter().map(|byte| u64::from((byte ^ 0x55).count_ones())).sum();
        assert!(flips == damage.bits && near(flips, 8e6, 1e-3), "{flips}");
        let (out, damage) = passed(Rates { dropped: 2e-3, ..Rates::default() }, &bytes);
        assert!(out.len() as u64 == 1_000_000 - damage.dropped && near(damage.dropped, 1e6, 2e-3));
        let (out, damage) = passed(Rates { inserted: 5e-4, ..Rates::default() }, &bytes);
        assert!(out.len() as u64 == 1_000_000 + damage.inserted && near(damage.inserted, 1e6, 5e-4));
        let (out, _) = passed(Rates { bits: 1.0, ..Rates::default() }, &bytes);
        assert!(out.iter().all(|&byte| byte == 0xAA));
    }

    #[test]
    fn packets_are_lost_whole() {
        let packets = [0, 1, 2, 3, 0].repeat(10_000);
        let (out, damage) = passed(Rates { lost: 0.25, ..Rates::default() }, &packets);
        assert!((2_300..2_700).contains(&damage.lost), "{damage:?}");
        let whole = out.split(|&byte| byte == 0).filter(|packet| !packet.is_empty());
        assert_eq!(
            whole.inspect(|packet| assert_eq!(packet, &[1, 2, 3])).count() as u64,
            10_000 - damage.lost
        );
    }

    #[test]
    fn noise_is_read_from_text() {
        let rates = "bits=1e-5, lost=0.01,dropped=1e-6,inserted=1".parse::<Rates>().unwrap();
        assert_eq!(rates, Rates { bits: 1e-5, lost: 0.01, dropped: 1e-6, inserted: 1.0 });
        for wrong in ["bits", "bit=1", "bits=2", "bits=-1", "bits=nan", ""] {
            assert_eq!(wrong.parse::<Rates>().unwrap_err().part, wrong);
        }
    }
}
