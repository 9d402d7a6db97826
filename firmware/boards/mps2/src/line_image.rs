//! An image that takes VGA RGB888 line by line through the device's pipeline.

/// Such an image: the scenario, and the words of memory that its pipeline needs.
#[macro_export]
macro_rules! line_image {
    ($scenario:expr, $words:expr) => {
        /// Words of a line of the camera.
        const LINE: usize = exercise::replay::scenario::line_words(640);
        /// Words of the pipeline.
        const PIPELINE: usize = $words;

        static RING: static_cell::ConstStaticCell<[[u32; LINE]; $crate::scene::LINES]> =
            static_cell::ConstStaticCell::new([[0; LINE]; $crate::scene::LINES]);
        static MEMORY: static_cell::ConstStaticCell<[u32; PIPELINE]> =
            static_cell::ConstStaticCell::new([0; PIPELINE]);
        static BUFFER: static_cell::ConstStaticCell<firmware::trace::ChunkBuffer> =
            static_cell::ConstStaticCell::new(firmware::trace::ChunkBuffer::new());

        #[cortex_m_rt::entry]
        fn main() -> ! {
            let (Some(mut core), Some(ring)) = (cortex_m::Peripherals::take(), RING.try_take()) else {
                $crate::exit::failure()
            };
            let (Some(memory), Some(buffer)) = (MEMORY.try_take(), BUFFER.try_take()) else {
                $crate::exit::failure()
            };
            $crate::rig::prioritize(&mut core.NVIC);
            $crate::scene::vision(
                &$scenario,
                buffer,
                ring.each_mut().map(|line| Some(&mut line[..])),
                memory,
            );
            $crate::exit::success()
        }
    };
}
