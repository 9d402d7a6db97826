//! What a kernel with integer weights makes of its sums: gray levels for a picture, or the sums themselves, on a scale of
//! their own, for a derivative that must not lose their fraction.

/// The last step of a kernel.
///
/// A trait and not a closure, so that it is compiled with the vector unit that the caller has chosen.
pub(crate) trait Finish {
    /// What is made.
    type Output: Copy + Default;

    /// Of one sum.
    fn one(sum: u16) -> Self::Output;

    /// Of four in a row, which come as two pairs: the even ones and the odd ones.
    fn four(sums: [u32; 2]) -> [Self::Output; 4];
}
