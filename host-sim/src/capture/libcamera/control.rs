//! Controls by their names, with values as text; rate and crop, which are controls here.

use ::libcamera::camera::Camera;
use ::libcamera::control::{ControlInfo, ControlList};
use ::libcamera::control_value::{ControlType, ControlValue};
use ::libcamera::controls::ControlId;
use ::libcamera::geometry::Rectangle;
use ::libcamera::utils::UniquePtr;

use super::super::device::Settings;
use super::super::error::CaptureError;
use super::library::Library;
use super::stream::find;

/// A control that a camera offers.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct FoundControl {
    /// Its name.
    pub name: String,
    /// What its values are: `bool`, `int32`, `float`…, with `[]` of several.
    pub kind: String,
    /// The least value.
    pub minimum: String,
    /// The greatest.
    pub maximum: String,
    /// What it is where nothing is set; empty if the camera does not say.
    pub default: String,
    /// The names of its values, where they have any.
    pub items: Vec<(i32, String)>,
}

/// The controls of a camera.
///
/// # Errors
/// [`CaptureError::Open`] if libcamera can't be started, [`CaptureError::Unknown`] if there is no such camera.
pub fn controls(id: &str) -> Result<Vec<FoundControl>, CaptureError> {
    let id = id.to_owned();
    Library::open()?.ask(move |cameras| {
        let camera = find(cameras, &id)?;
        let mut found: Vec<FoundControl> = known(&camera).map(|(id, info)| describe(id, info)).collect();
        found.sort_by(|one, other| one.name.cmp(&other.name));
        Ok(found)
    })?
}

/// Controls that these bindings know, of those that a camera has.
fn known<'a>(camera: &'a Camera<'_>) -> impl Iterator<Item = (ControlId, &'a ControlInfo)> {
    camera.controls().into_iter().filter_map(|(id, info)| Some((ControlId::from_id(id)?, info)))
}

fn describe(id: ControlId, info: &ControlInfo) -> FoundControl {
    let kind = format!("{:?}", id.control_type()).to_lowercase();
    let allowed = info.values();
    let mut items: Vec<(i32, String)> = id.enumerators().into_iter().flatten().collect();
    items.retain(|(item, _)| {
        allowed.is_empty()
            || allowed.iter().any(|value| matches!(value, ControlValue::Int32(of) if of[..] == [*item]))
    });
    items.sort_unstable();
    FoundControl {
        name: id.name(),
        kind: if id.is_array() { format!("{kind}[]") } else { kind },
        minimum: text(&info.min()),
        maximum: text(&info.max()),
        default: text(&info.def()),
        items,
    }
}

/// A value as it is given on the command line.
fn text(value: &ControlValue) -> String {
    fn list<T: ToString>(values: impl IntoIterator<Item = T>) -> String {
        values.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(",")
    }
    match value {
        ControlValue::None => String::new(),
        ControlValue::Bool(of) => list(of),
        ControlValue::Byte(of) => list(of),
        ControlValue::Uint16(of) => list(of),
        ControlValue::Uint32(of) => list(of),
        ControlValue::Int32(of) => list(of),
        ControlValue::Int64(of) => list(of),
        ControlValue::Float(of) => list(of),
        ControlValue::String(of) => list(of),
        ControlValue::Rectangle(of) => {
            list(of.iter().map(|part| format!("{}x{}+{}+{}", part.width, part.height, part.x, part.y)))
        }
        ControlValue::Size(of) => list(of.iter().map(|size| format!("{}x{}", size.width, size.height))),
        ControlValue::Point(of) => list(of.iter().map(|point| format!("{}+{}", point.x, point.y))),
    }
}

/// A value read from text; `None` if it is no such value.
///
/// Several values stand with commas between them.
fn parse(kind: &ControlType, text: &str) -> Option<ControlValue> {
    fn all<T>(text: &str, one: impl Fn(&str) -> Option<T>) -> Option<Vec<T>> {
        text.split(',').map(|part| one(part.trim())).collect()
    }
    fn number<T: std::str::FromStr>(text: &str) -> Option<T> {
        text.parse().ok()
    }
    let boolean = |text: &str| match text {
        "on" | "true" | "yes" | "1" => Some(true),
        "off" | "false" | "no" | "0" => Some(false),
        _ => None,
    };
    Some(match kind {
        ControlType::Bool => all(text, boolean)?.into(),
        ControlType::Byte => all(text, number::<u8>)?.into(),
        ControlType::Uint16 => all(text, number::<u16>)?.into(),
        ControlType::Uint32 => all(text, number::<u32>)?.into(),
        ControlType::Int32 => all(text, number::<i32>)?.into(),
        ControlType::Int64 => all(text, number::<i64>)?.into(),
        ControlType::Float => all(text, |part| number::<f32>(part).filter(|value| value.is_finite()))?.into(),
        ControlType::String => text.to_owned().into(),
        ControlType::Rectangle => all(text, rectangle)?.into(),
        ControlType::None | ControlType::Size | ControlType::Point => return None,
    })
}

/// Width, height, left and top, as in `320x240+16+8`.
fn rectangle(text: &str) -> Option<Rectangle> {
    let (size, place) = text.split_once('+')?;
    let ((width, height), (x, y)) = (size.split_once('x')?, place.split_once('+')?);
    Some(Rectangle {
        x: x.parse().ok()?,
        y: y.parse().ok()?,
        width: width.parse().ok()?,
        height: height.parse().ok()?,
    })
}

/// The number of a value that is one.
fn scalar(value: &ControlValue) -> Option<f64> {
    match value {
        ControlValue::Byte(of) if of.len() == 1 => Some(of[0].into()),
        ControlValue::Uint16(of) if of.len() == 1 => Some(of[0].into()),
        ControlValue::Uint32(of) if of.len() == 1 => Some(of[0].into()),
        ControlValue::Int32(of) if of.len() == 1 => Some(of[0].into()),
        ControlValue::Int64(of) if of.len() == 1 => Some(of[0] as f64),
        ControlValue::Float(of) if of.len() == 1 => Some(of[0].into()),
        _ => None,
    }
}

/// The limits that all values of a list have to keep, if both are numbers.
fn limits(info: &ControlInfo) -> Option<(f64, f64)> {
    let (least, greatest) = (scalar(&info.min())?, scalar(&info.max())?);
    (least <= greatest).then_some((least, greatest))
}

/// A control with its value, for people.
fn value_of(
    camera: &Camera<'_>,
    device: &str,
    name: &str,
    given: &str,
) -> Result<(ControlId, ControlValue), CaptureError> {
    let all: Vec<(ControlId, &ControlInfo)> = known(camera).collect();
    let names: Vec<String> = all.iter().map(|(id, _)| id.name()).collect();
    let found = names.iter().position(|known| known.eq_ignore_ascii_case(name));
    let Some((id, info)) = found.map(|index| all[index]) else {
        if names.is_empty() {
            return Err(CaptureError::refused(
                device,
                &format!("{name}={given}"),
                "the camera has no controls",
                "leave it out",
            ));
        }
        return Err(CaptureError::unknown(device, "control", name, names.iter().map(String::as_str)));
    };
    let found = describe(id, info);
    let item = found.items.iter().find(|(_, item)| item.eq_ignore_ascii_case(given));
    let value = item.map_or_else(|| parse(&id.control_type(), given), |(item, _)| Some((*item).into()));
    let wrong = |remedy: &str| {
        CaptureError::refused(device, &format!("{name}={given}"), "not a value of this control", remedy)
    };
    let Some(value) = value else {
        if !found.items.is_empty() {
            let items = found.items.iter().map(|(_, item)| item.as_str());
            return Err(CaptureError::unknown(device, "item of this control", given, items));
        }
        return Err(wrong(&format!("give {}, from {} to {}", found.kind, found.minimum, found.maximum)));
    };
    if let (Some(number), Some((least, greatest))) = (scalar(&value), limits(info))
        && !(least..=greatest).contains(&number)
    {
        return Err(wrong(&format!("give a number from {} to {}", found.minimum, found.maximum)));
    }
    Ok((id, value))
}

/// Microseconds of a frame at a rate.
fn duration_of(rate: f64) -> i64 {
    (1e6 / rate).round() as i64
}

/// Least and greatest frames a second, if the camera says.
pub(super) fn rates(camera: &Camera<'_>) -> Option<(f64, f64)> {
    let info = camera.controls().find(ControlId::FrameDurationLimits.id()).ok()?;
    let (shortest, longest) = (scalar(&info.min())?, scalar(&info.max())?);
    (shortest > 0.0 && longest >= shortest).then(|| (1e6 / longest, 1e6 / shortest))
}

/// The controls with which a camera starts, and the rate that was granted.
pub(super) fn start_list(
    camera: &Camera<'_>,
    device: &str,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<(UniquePtr<ControlList>, Option<f64>), CaptureError> {
    let mut list = ControlList::from_info_map(camera.controls()).unwrap_or_default();
    let mut set = |id: ControlId, value: ControlValue, setting: &str| {
        let accepted = list.set_raw(id.id(), value).is_ok() && list.contains(id.id());
        if accepted {
            Ok(())
        } else {
            Err(CaptureError::refused(device, setting, "the camera does not take it", "see --controls"))
        }
    };
    let mut granted = None;
    if let Some(rate) = settings.rate {
        match rates(camera) {
            None => notes
                .push(format!("asked for {rate} frames a second, the camera does not let that be chosen")),
            Some((least, greatest)) => {
                let near = rate.clamp(least, greatest);
                if (near - rate).abs() > rate / 100.0 {
                    notes.push(format!("asked for {rate} frames a second, the camera takes {near:.2}"));
                }
                let duration = duration_of(near);
                set(ControlId::FrameDurationLimits, [duration, duration].into(), "the rate")?;
                granted = Some(near);
            }
        }
    }
    if let Some((x, y, width, height)) = settings.crop {
        let part = Rectangle { x, y, width, height };
        let setting = format!("the crop {width}x{height}+{x}+{y}");
        let Ok(info) = camera.controls().find(ControlId::ScalerCrop.id()) else {
            let remedy = "leave it out, or use `--op crop:…`";
            return Err(CaptureError::refused(device, &setting, "this camera can't crop", remedy));
        };
        if let ControlValue::Rectangle(bounds) = info.max()
            && let [bounds] = bounds[..]
            && let inside = part.bounded_to(bounds)
            && (inside.width < width || inside.height < height)
        {
            let within = text(&info.max());
            return Err(CaptureError::refused(
                device,
                &setting,
                "it is not within the sensor's picture",
                &format!("it can be within {within}"),
            ));
        }
        set(ControlId::ScalerCrop, part.into(), &setting)?;
    }
    for (name, given) in &settings.controls {
        let (id, value) = value_of(camera, device, name, given)?;
        set(id, value, &format!("{name}={given}"))?;
    }
    Ok((list, granted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_they_are_written() {
        for (kind, written) in [
            (ControlType::Bool, "true"),
            (ControlType::Int32, "-3"),
            (ControlType::Int64, "33333,66666"),
            (ControlType::Float, "1.5,2"),
            (ControlType::Rectangle, "320x240+16+8"),
        ] {
            assert_eq!(text(&parse(&kind, written).unwrap()), written);
        }
        for (kind, wrong) in [
            (ControlType::Bool, "perhaps"),
            (ControlType::Byte, "256"),
            (ControlType::Float, "NaN"),
            (ControlType::Int32, "1,x"),
            (ControlType::Rectangle, "320x240"),
            (ControlType::Size, "1x1"),
        ] {
            assert!(parse(&kind, wrong).is_none(), "{wrong}");
        }
    }
}
