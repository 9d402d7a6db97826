use std::fs;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageReader, RgbImage};

/// Why a picture file could not be read or a file not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {what}; {remedy}", path.display())]
pub struct PictureError {
    /// The file.
    pub path: PathBuf,
    /// What happened.
    pub what: String,
    /// What to do.
    pub remedy: &'static str,
}

/// Reads a PNG or JPEG file, told apart by content, into 8-bit RGB.
///
/// Deeper samples are rounded to 8 bits, gray becomes RGB, transparent pixels are seen against black, and a camera's
/// note on how it was held is followed. Files that would take more than 512 MiB in memory are refused.
///
/// # Errors
/// [`PictureError`] with the file and what is wrong with it.
pub fn read(path: &Path) -> Result<RgbImage, PictureError> {
    let fail = |what: String, remedy| PictureError { path: path.to_owned(), what, remedy };
    let reader = fs::File::open(path)
        .and_then(|file| ImageReader::new(BufReader::new(file)).with_guessed_format())
        .map_err(|error| fail(error.to_string(), "check the path"))?;
    if reader.format().is_none() {
        return Err(fail("neither a PNG nor a JPEG picture".to_owned(), "convert it to PNG"));
    }
    let broken = |error: image::ImageError| fail(error.to_string(), "give a whole PNG or JPEG picture");
    let mut decoder = reader.into_decoder().map_err(broken)?;
    // A note that can't be read leaves the picture as it is.
    let orientation = decoder.orientation().unwrap_or(image::metadata::Orientation::NoTransforms);
    let mut picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
    picture.apply_orientation(orientation);
    Ok(against_black(picture))
}

fn against_black(picture: DynamicImage) -> RgbImage {
    if !picture.color().has_alpha() {
        return picture.into_rgb8();
    }
    let transparent = picture.into_rgba8();
    RgbImage::from_fn(transparent.width(), transparent.height(), |x, y| {
        let [r, g, b, alpha] = transparent.get_pixel(x, y).0;
        image::Rgb([r, g, b].map(|value| ((u16::from(value) * u16::from(alpha) + 127) / 255) as u8))
    })
}

/// Writes a picture as PNG: 8 bits, RGB.
///
/// The file appears whole or not at all: it is written under a temporary name in the same folder and then renamed.
///
/// # Errors
/// [`PictureError`] with the file and what the system says.
pub fn write_png(path: &Path, picture: &RgbImage) -> Result<(), PictureError> {
    write_whole(path, |file| {
        PngEncoder::new(file)
            .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(std::io::Error::other)
    })
}

/// Writes the bytes of a frame as they are, whole or not at all like [`write_png`].
///
/// # Errors
/// [`PictureError`] with the file and what the system says.
pub fn write_raw(path: &Path, bytes: &[u8]) -> Result<(), PictureError> {
    write_pieces(path, &[bytes])
}

/// The same, of bytes that stand in several places.
///
/// # Errors
/// As [`write_raw`].
pub fn write_pieces(path: &Path, pieces: &[&[u8]]) -> Result<(), PictureError> {
    write_whole(path, |file| pieces.iter().try_for_each(|piece| file.write_all(piece)))
}

fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> std::io::Result<()>,
) -> Result<(), PictureError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let result = (|| {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".").suffix(".part");
        #[cfg(unix)]
        {
            // As any file the user makes; the library's own choice is a file for the user alone.
            use std::os::unix::fs::PermissionsExt as _;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder)?;
        let mut buffered = BufWriter::new(file.as_file_mut());
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        file.persist(path)?;
        Ok(())
    })();
    result.map_err(|error: std::io::Error| PictureError {
        path: path.to_owned(),
        what: error.to_string(),
        remedy: "check that the folder exists, may be written to and has room",
    })
}

#[cfg(test)]
mod tests {
    use image::{Rgb, Rgba, RgbaImage};

    use super::*;

    #[test]
    fn png_reads_back_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let picture = RgbImage::from_fn(5, 3, |x, y| Rgb([x as u8 * 50, y as u8 * 80, 9]));
        write_png(&path, &picture).unwrap();
        write_png(&path, &picture).unwrap();
        assert_eq!(read(&path).unwrap(), picture);
        write_raw(&folder.path().join("a.raw"), &[1, 2, 3]).unwrap();
        assert_eq!(fs::read(folder.path().join("a.raw")).unwrap(), [1, 2, 3]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn files_are_as_open_as_any_the_user_makes() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_raw(&ours, b"x").unwrap();
        fs::write(&plain, b"x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn jpeg_and_transparency_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("told-apart-by-content");
        DynamicImage::ImageRgb8(RgbImage::from_pixel(16, 8, Rgb([200, 200, 200])))
            .save_with_format(&path, image::ImageFormat::Jpeg)
            .unwrap();
        let picture = read(&path).unwrap();
        assert_eq!(picture.dimensions(), (16, 8));
        assert!(picture.iter().all(|value| value.abs_diff(200) <= 2));
        DynamicImage::ImageRgba8(RgbaImage::from_pixel(1, 1, Rgba([200, 100, 50, 51])))
            .save_with_format(&path, image::ImageFormat::Png)
            .unwrap();
        assert_eq!(read(&path).unwrap().get_pixel(0, 0).0, [40, 20, 10]);
    }

    #[test]
    fn what_is_no_picture_is_said_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        assert!(read(&path).unwrap_err().to_string().contains("x.png: "), "it is not there");
        fs::write(&path, b"hello").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("neither a PNG nor a JPEG"));
        write_png(&path, &RgbImage::new(40, 40)).unwrap();
        let whole = fs::read(&path).unwrap();
        for length in 8..whole.len() - 12 {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(read(&path).is_err(), "cut after {length} bytes");
        }
        let nowhere = folder.path().join("no/such/folder/y.png");
        assert!(write_png(&nowhere, &RgbImage::new(1, 1)).unwrap_err().to_string().contains("y.png: "));
    }
}
