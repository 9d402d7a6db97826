//! Turned, mirrored and cut pictures.

use algos_nostd::image::geometry::{
    CropLines, MirrorLines, flip_horizontal, flip_vertical, rotate_90, rotate_180, rotate_270,
};
use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::lines::run;
use algos_nostd::pixel::rgb888;

use crate::over::over;
use crate::report::{Clock, Done, Exercise, Unit::Pixel};
use crate::space::{HEIGHT, PIXELS, WIDTH, Workspace, view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "flip horizontally", unit: Pixel, run: |s, c| in_place(s, c, flip_horizontal) },
    Exercise { name: "flip vertically", unit: Pixel, run: |s, c| in_place(s, c, flip_vertical) },
    Exercise { name: "rotate by 180", unit: Pixel, run: |s, c| in_place(s, c, rotate_180) },
    Exercise { name: "rotate by 90", unit: Pixel, run: |s, c| turned(s, c, rotate_90) },
    Exercise { name: "rotate by 270", unit: Pixel, run: |s, c| turned(s, c, rotate_270) },
    Exercise { name: "mirror by lines", unit: Pixel, run: mirrored },
    Exercise { name: "crop by lines", unit: Pixel, run: cropped },
];

fn in_place(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    change: fn(&mut ImageMut<'_, Rgb>),
) -> Result<Done, Error> {
    space.pixels.copy_from_slice(&space.picture);
    let mut image = ImageMut::new(&mut space.pixels, WIDTH, HEIGHT)?;
    clock.start();
    change(&mut image);
    clock.stop();
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn turned(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    turn: fn(Image<'_, Rgb>, &mut ImageMut<'_, Rgb>) -> Result<(), Error>,
) -> Result<Done, Error> {
    let mut image = ImageMut::new(&mut space.pixels, HEIGHT, WIDTH)?;
    clock.start();
    turn(view(&space.picture)?, &mut image)?;
    clock.stop();
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn mirrored(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let filter = MirrorLines::new(&mut space.line[..WIDTH]);
    over(filter, view(&space.picture)?, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn cropped(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let (width, height) = (WIDTH / 2, HEIGHT / 2);
    let mut filter = CropLines::<Rgb>::new(WIDTH, (WIDTH / 4, HEIGHT / 4), (width, height))?;
    let out = &mut space.pixels[..width * height];
    clock.start();
    run(&mut filter, view(&space.picture)?, &mut ImageMut::new(out, width, height)?)?;
    clock.stop();
    Ok(Done::new(PIXELS, rgb888::as_bytes(out)))
}
