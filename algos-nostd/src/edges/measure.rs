//! What a gradient is asked for: its components, its magnitude, its direction.
//!
//! ```text
//!             5  6  7                the eight sectors, each 45° wide,
//!              ╲ │ ╱                 y downwards, so clockwise on the screen;
//!          4 ────┼────► 0            the four are 0 ─, 1 ╲, 2 │, 3 ╱: the same modulo 4
//!              ╱ │ ╲
//!             3  2  1
//! ```
//!
//! All in integers and exact. The border of a sector lies at `tan 22.5° = √2 − 1`; with `a = |x|` and `b = |y|`,
//! `b < a (√2 − 1)` is `a + b < √2 a`, squared `b (b + 2 a) < a²`. √2 is irrational, so nothing but a gradient of zero
//! (which is given sector 0) lies on a border. `a`, `b` ≤ 2¹⁵, so all products fit 32 bits.
//!
//! Cost: the root takes 16 rounds of five operations, without a branch, so that vector units take it on; comparisons
//! should use [`SquaredL2`] instead.

use super::gradient::Gradient;

/// What is made of a gradient.
pub trait Measure {
    /// The result.
    type Output: Copy;

    /// Makes it.
    fn measure(gradient: Gradient) -> Self::Output;
}

/// The gradient itself.
#[derive(Clone, Copy, Debug)]
pub struct Components;

/// `|x| + |y|`, exact.
#[derive(Clone, Copy, Debug)]
pub struct L1;

/// `√(x² + y²)`, the whole part of it, exact.
#[derive(Clone, Copy, Debug)]
pub struct L2;

/// `x² + y²`, exact.
#[derive(Clone, Copy, Debug)]
pub struct SquaredL2;

/// Direction as one of four: 0 to 3, see the top of this file.
#[derive(Clone, Copy, Debug)]
pub struct Sector4;

/// Direction as one of eight: 0 to 7, see the top of this file.
#[derive(Clone, Copy, Debug)]
pub struct Sector8;

/// A magnitude as a gray level: more than 255 is 255.
#[derive(Clone, Copy, Debug)]
pub struct Saturated<M>(core::marker::PhantomData<M>);

impl Measure for Components {
    type Output = Gradient;

    #[inline(always)]
    fn measure(gradient: Gradient) -> Gradient {
        gradient
    }
}

impl Measure for L1 {
    type Output = u16;

    #[inline(always)]
    fn measure(gradient: Gradient) -> u16 {
        // 2 · 2¹⁵ would not fit; no operator gives that, and a caller's pair saturates.
        gradient.x.unsigned_abs().saturating_add(gradient.y.unsigned_abs())
    }
}

impl Measure for L2 {
    type Output = u16;

    #[inline(always)]
    fn measure(gradient: Gradient) -> u16 {
        root(SquaredL2::measure(gradient))
    }
}

impl Measure for SquaredL2 {
    type Output = u32;

    #[inline(always)]
    fn measure(gradient: Gradient) -> u32 {
        let (x, y) = (u32::from(gradient.x.unsigned_abs()), u32::from(gradient.y.unsigned_abs()));
        x * x + y * y
    }
}

impl Measure for Sector4 {
    type Output = u8;

    #[inline(always)]
    fn measure(gradient: Gradient) -> u8 {
        Sector8::measure(gradient) & 3
    }
}

impl Measure for Sector8 {
    type Output = u8;

    #[inline(always)]
    fn measure(Gradient { x, y }: Gradient) -> u8 {
        let (a, b) = (u32::from(x.unsigned_abs()), u32::from(y.unsigned_abs()));
        let horizontal = (b * (b + 2 * a) < a * a) | ((a | b) == 0);
        let vertical = a * (a + 2 * b) < b * b;
        let (left, up) = (u8::from(x < 0), u8::from(y < 0));
        // Right 0, left 4; down 2, up 6; 1, 3, 5, 7 from the lower right clockwise.
        let diagonal = 1 + 2 * (left ^ up) + 4 * up;
        let straight = if vertical { 2 + 4 * up } else { diagonal };
        if horizontal { 4 * left } else { straight }
    }
}

impl<M: Measure<Output = u16>> Measure for Saturated<M> {
    type Output = u8;

    #[inline(always)]
    fn measure(gradient: Gradient) -> u8 {
        M::measure(gradient).min(255) as u8
    }
}

/// The whole part of a square root, bit by bit from the top.
#[inline(always)]
fn root(square: u32) -> u16 {
    let mut root = 0u32;
    let mut bit = 1 << 15;
    while bit > 0 {
        let longer = root | bit;
        root = if longer * longer <= square { longer } else { root };
        bit >>= 1;
    }
    root as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn sectors_go_round() {
        let compass = [(9, 0), (9, 9), (0, 9), (-9, 9), (-9, 0), (-9, -9), (0, -9), (9, -9)];
        for (sector, (x, y)) in compass.into_iter().enumerate() {
            assert_eq!(usize::from(Sector8::measure(Gradient { x, y })), sector);
            assert_eq!(usize::from(Sector4::measure(Gradient { x, y })), sector % 4);
        }
        assert_eq!(Sector8::measure(Gradient::default()), 0);
    }

    #[test]
    fn borders_lie_between_the_best_fractions() {
        // 408/985 < √2 − 1 < 169/408: there are no closer fractions of their size.
        assert_eq!(Sector8::measure(Gradient { x: 985, y: 408 }), 0);
        assert_eq!(Sector8::measure(Gradient { x: 408, y: 169 }), 1);
        assert_eq!(Sector8::measure(Gradient { x: 408, y: 985 }), 2);
        assert_eq!(Sector8::measure(Gradient { x: 169, y: 408 }), 1);
    }

    proptest! {
        #[test]
        fn roots_and_magnitudes_are_exact(x in any::<i16>(), y in any::<i16>()) {
            let gradient = Gradient { x, y };
            let square = SquaredL2::measure(gradient);
            prop_assert_eq!(i64::from(square), i64::from(x).pow(2) + i64::from(y).pow(2));
            prop_assert_eq!(u32::from(L2::measure(gradient)), square.isqrt());
            let sum = i64::from(x).abs() + i64::from(y).abs();
            prop_assert_eq!(i64::from(L1::measure(gradient)), sum.min(65535));
        }
    }
}
