use super::{LineFilter, LineSink};
use crate::image::Error;

/// Two filters, one after the other; made by [`LineFilter::then`].
#[derive(Debug)]
pub struct Then<A, B> {
    first: A,
    second: B,
}

impl<A, B> Then<A, B> {
    pub(super) fn new(first: A, second: B) -> Self {
        Self { first, second }
    }
}

impl<A: LineFilter, B: LineFilter<Input = A::Output>> LineFilter for Then<A, B> {
    type Input = A::Input;
    type Output = B::Output;

    const LATENCY: usize = A::LATENCY + B::LATENCY;

    fn push(&mut self, line: &[A::Input], sink: &mut impl LineSink<B::Output>) -> Result<(), Error> {
        let second = &mut self.second;
        let mut refused = Ok(());
        self.first.push(line, &mut |middle: &[A::Output]| {
            if refused.is_ok() {
                refused = second.push(middle, sink);
            }
        })?;
        refused
    }

    fn finish(&mut self, sink: &mut impl LineSink<B::Output>) {
        let second = &mut self.second;
        self.first.finish(&mut |middle: &[A::Output]| {
            // A width that fitted while lines were pushed fits now: the first filter's width is fixed.
            let _ = second.push(middle, sink);
        });
        self.second.finish(sink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, ImageMut};
    use crate::lines::{check_width, run};

    /// Adds the line above to each line: the smallest filter with a memory.
    struct AddAbove {
        above: [u8; 3],
    }

    impl LineFilter for AddAbove {
        type Input = u8;
        type Output = u8;
        const LATENCY: usize = 0;

        fn push(&mut self, line: &[u8], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
            check_width(3, line.len())?;
            let sum: [u8; 3] = core::array::from_fn(|x| line[x] + self.above[x]);
            self.above.copy_from_slice(line);
            sink.line(&sum);
            Ok(())
        }

        fn finish(&mut self, _: &mut impl LineSink<u8>) {
            self.above = [0; 3];
        }
    }

    #[test]
    fn a_chain_is_its_parts_in_turn() {
        let mut chain = AddAbove { above: [0; 3] }.then(AddAbove { above: [0; 3] });
        let input = [1, 2, 3, 0, 0, 0, 0, 0, 0];
        let mut output = [0; 9];
        for _ in 0..2 {
            let view = Image::new(&input, 3, 3).unwrap();
            run(&mut chain, view, &mut ImageMut::new(&mut output, 3, 3).unwrap()).unwrap();
            assert_eq!(output, [1, 2, 3, 2, 4, 6, 1, 2, 3], "and the next frame starts afresh");
        }
        assert_eq!(
            chain.push(&[0; 4], &mut |_: &[u8]| {}),
            Err(Error::BufferLength { name: "line", expected: 3, got: 4 })
        );
    }
}
