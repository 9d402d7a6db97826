//! Numbers of variable length out of bytes. Seven bits a byte, the lowest first; the highest bit says that there is more.

use super::error::FstProblem;

/// Bytes that are taken from the front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    #[inline]
    pub(super) fn byte(&mut self) -> Result<u8, FstProblem> {
        let (&first, rest) = self.0.split_first().ok_or(FstProblem::Short)?;
        self.0 = rest;
        Ok(first)
    }

    #[inline]
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], FstProblem> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(FstProblem::Short)?;
        self.0 = rest;
        Ok(taken)
    }

    /// An unsigned number of up to 64 bits.
    #[inline]
    pub(super) fn number(&mut self) -> Result<u64, FstProblem> {
        let (mut value, mut shift) = (0_u64, 0);
        loop {
            let byte = self.byte()?;
            if shift > 63 || shift == 63 && byte > 1 {
                return Err(FstProblem::Wrong("number"));
            }
            value |= u64::from(byte & 0x7F) << shift;
            shift += 7;
            if byte < 0x80 {
                return Ok(value);
            }
        }
    }

    /// A signed number, whose last byte's bit 6 is the sign.
    pub(super) fn signed(&mut self) -> Result<i64, FstProblem> {
        let (mut value, mut shift) = (0_i64, 0);
        loop {
            let byte = self.byte()?;
            if shift > 63 {
                return Err(FstProblem::Wrong("number"));
            }
            value |= i64::from(byte & 0x7F) << shift;
            shift += 7;
            if byte < 0x80 {
                let negative = byte & 0x40 != 0 && shift < 64;
                return Ok(if negative { value | -1 << shift } else { value });
            }
        }
    }

    /// A text that ends with 0.
    pub(super) fn text(&mut self) -> Result<String, FstProblem> {
        let end = self.0.iter().position(|&byte| byte == 0).ok_or(FstProblem::Short)?;
        let text = String::from_utf8_lossy(self.take(end)?).into_owned();
        self.byte()?;
        Ok(text)
    }
}
