//! Which pixel formats and sizes a camera of libcamera has, by the codes of V4L2.

use ::libcamera::camera::{Camera, CameraConfiguration, CameraConfigurationStatus};
use ::libcamera::color_space::{ColorSpace, Range as Codes, YcbcrEncoding};
use ::libcamera::geometry::Size;
use ::libcamera::pixel_format::PixelFormat;
use ::libcamera::stream::StreamRole;
use algos_nostd::pixel::yuv422::{Matrix, Range};
use v4l2_capture::FourCc;

use super::super::device::{FoundFormat, FoundSize, Settings, YuvMeaning};
use super::super::error::CaptureError;
use super::super::layout::Layout;

/// What cameras are asked for, in this order. Some have their mosaic only as [`StreamRole::Raw`], some have no more than one of
/// the others.
const ROLES: [StreamRole; 4] =
    [StreamRole::VideoRecording, StreamRole::ViewFinder, StreamRole::StillCapture, StreamRole::Raw];

/// A pixel format that a camera offers, and the role in which it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offered {
    pub(super) code: FourCc,
    pub(super) format: PixelFormat,
    role: StreamRole,
}

/// V4L2's code of a pixel format of libcamera, which are those of Linux' Direct Rendering Manager: `RG24` there is `BGR3` here.
/// What V4L2 has no code for keeps its own.
pub(super) fn code_of(format: PixelFormat) -> FourCc {
    let codes = format.info().map(|info| info.v4l2_formats).unwrap_or_default();
    FourCc(codes.first().copied().unwrap_or(format.fourcc()))
}

/// What a camera offers, each code once, and its sizes.
pub(super) fn offered(camera: &Camera<'_>) -> Vec<(Offered, Vec<FoundSize>)> {
    let mut all: Vec<(Offered, Vec<FoundSize>)> = Vec::new();
    for role in ROLES {
        let Some(configuration) = camera.generate_configuration(&[role]) else { continue };
        let Some(stream) = configuration.get(0) else { continue };
        let formats = stream.formats();
        for format in &*formats.pixel_formats() {
            let code = code_of(format);
            if all.iter().any(|(known, _)| known.code == code) {
                continue;
            }
            let size = |size: Size, up_to| FoundSize {
                width: size.width,
                height: size.height,
                up_to,
                rates: Vec::new(),
            };
            let mut sizes: Vec<FoundSize> =
                formats.sizes(format).into_iter().map(|found| size(found, None)).collect();
            if sizes.is_empty() {
                let range = formats.range(format);
                sizes.push(size(range.min, Some((range.max.width, range.max.height))));
            }
            all.push((Offered { code, format, role }, sizes));
        }
    }
    all
}

/// The same, for people.
pub(super) fn listed(camera: &Camera<'_>) -> Vec<FoundFormat> {
    let of = |(offered, sizes): (Offered, Vec<FoundSize>)| FoundFormat {
        code: offered.code.to_string(),
        name: offered.format.to_string(),
        picture: Layout::of(offered.code).is_some(),
        sizes,
    };
    offered(camera).into_iter().map(of).collect()
}

/// The pixel format that is asked for. Where none is, the camera's own if it becomes a picture, else the best that does.
fn choose(
    camera: &Camera<'_>,
    device: &str,
    all: &[(Offered, Vec<FoundSize>)],
    settings: &Settings,
) -> Result<Offered, CaptureError> {
    let known = || all.iter().map(|(offered, _)| offered);
    if let Some(code) = settings.code {
        return known().find(|offered| offered.code == code).copied().ok_or_else(|| {
            let names: Vec<String> = known().map(|offered| offered.code.to_string()).collect();
            CaptureError::unknown(device, "pixel format", &code.to_string(), names.iter().map(String::as_str))
        });
    }
    let own =
        ROLES.iter().find_map(|role| camera.generate_configuration(&[*role])).and_then(|configuration| {
            let stream = configuration.get(0)?;
            Some(code_of(stream.get_pixel_format()))
        });
    let has_size = |code: FourCc| {
        let sizes = all.iter().find(|(offered, _)| offered.code == code).map(|(_, sizes)| sizes);
        sizes.is_some_and(|sizes| {
            sizes.iter().any(|size| settings.size.is_none_or(|asked| size.contains(asked)))
        })
    };
    let pictures: Vec<FourCc> = own
        .into_iter()
        .chain(Layout::codes())
        .filter(|code| Layout::of(*code).is_some() && known().any(|offered| offered.code == *code))
        .collect();
    let best = pictures.iter().find(|code| has_size(**code)).or(pictures.first()).copied().or(own);
    known()
        .find(|offered| Some(offered.code) == best)
        .or_else(|| known().next())
        .copied()
        .ok_or_else(|| CaptureError::refused(device, "a format", "it offers none", "update libcamera"))
}

/// Settles pixel format, size and buffers.
pub(super) fn configuration(
    camera: &Camera<'_>,
    device: &str,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<CameraConfiguration, CaptureError> {
    let all = offered(camera);
    let chosen = choose(camera, device, &all, settings)?;
    let nothing = || CaptureError::refused(device, "a configuration", "it has none", "update libcamera");
    let mut configuration = camera.generate_configuration(&[chosen.role]).ok_or_else(nothing)?;
    // What a crop leaves is taken as it is.
    let asked = settings.size.or(settings.crop.map(|(_, _, width, height)| (width, height)));
    {
        let mut stream = configuration.get_mut(0).ok_or_else(nothing)?;
        stream.set_pixel_format(chosen.format);
        if let Some((width, height)) = asked {
            stream.set_size(Size::new(width, height));
        }
        stream.set_buffer_count(settings.buffers);
    }
    let status = configuration.validate();
    let stream = configuration.get(0).ok_or_else(nothing)?;
    let size = stream.get_size();
    if matches!(status, CameraConfigurationStatus::Invalid) {
        let asked = asked.unwrap_or((size.width, size.height));
        let setting = format!("{} at {} × {}", chosen.code, asked.0, asked.1);
        return Err(CaptureError::refused(device, &setting, "it can't be configured so", "ask for another"));
    }
    if stream.get_pixel_format() != chosen.format {
        let what = format!("the camera takes {} instead", code_of(stream.get_pixel_format()));
        let setting = format!("the pixel format {}", chosen.code);
        return Err(CaptureError::refused(device, &setting, &what, "ask for that"));
    }
    if let Some((width, height)) = asked
        && (size.width, size.height) != (width, height)
    {
        notes.push(format!(
            "asked for {width} × {height} pixels, the camera takes {} × {}",
            size.width, size.height
        ));
    }
    Ok(configuration)
}

/// What a camera says of its colours.
pub(super) fn meaning(space: Option<ColorSpace>) -> YuvMeaning {
    let Some(space) = space else { return YuvMeaning::default() };
    let matrix = match space.ycbcr_encoding {
        YcbcrEncoding::Rec709 | YcbcrEncoding::Rec2020 => Matrix::Bt709,
        YcbcrEncoding::Rec601 | YcbcrEncoding::None => Matrix::Bt601,
    };
    let range = match space.range {
        Codes::Full => Range::Full,
        Codes::Limited => Range::Limited,
    };
    YuvMeaning { matrix, range, whole_hue: false }
}
