//! Controls: by their names, with values as text.

use v4l2_capture::{Control, ControlKind, Device, Error, Value};

use super::super::error::CaptureError;
use super::refusal::{refused, unknown};

/// A control as the command line shows it, and its value.
pub type ControlValue = (Control, Option<Value>);

/// All controls of a device, and their values.
///
/// # Errors
/// If the device does not answer.
pub fn controls(device: &Device) -> Result<Vec<ControlValue>, CaptureError> {
    let fail = |error: &Error| refused(device, "a list of controls".to_owned(), error, "plug it in again");
    let all = device.controls().map_err(|error| fail(&error))?;
    // A value that can't be read now is none.
    Ok(all
        .into_iter()
        .map(|control| (control.clone(), device.control(&control).unwrap_or_default()))
        .collect())
}

/// Sets a control by its name to a value by its text.
///
/// # Errors
/// [`CaptureError::Unknown`] for a control or an item that there is none of, [`CaptureError::Refused`] for a value that is
/// none.
pub fn set_control(device: &Device, name: &str, value: &str) -> Result<(), CaptureError> {
    let all = device
        .controls()
        .map_err(|error| refused(device, "a list of controls".to_owned(), &error, "plug it in again"))?;
    let Some(control) = all.iter().find(|control| control.name == name) else {
        return Err(unknown(device, "control", name, all.iter().map(|control| control.name.as_str())));
    };
    let wrong = |remedy: String| CaptureError::Refused {
        device: device.path().display().to_string(),
        setting: format!("{name}={value}"),
        what: "not a value of this control".to_owned(),
        remedy,
    };
    if control.is_read_only() {
        return Err(wrong("it can only be read".to_owned()));
    }
    let number = parse_number(value);
    let range = || format!("give a number from {} to {}", control.minimum, control.maximum);
    let value = match control.kind {
        ControlKind::Compound(_) => {
            return Err(wrong("it is a structure or an array, which `v4l2-ctl` can set".to_owned()));
        }
        ControlKind::Text => Value::Text(value.to_owned()),
        ControlKind::Button => Value::Number(1),
        ControlKind::Menu | ControlKind::IntegerMenu => {
            let named = control.items.iter().find(|item| item.name.eq_ignore_ascii_case(value));
            // In a menu of numbers, 8 is the item 8, not the eighth.
            let numbered = control.items.iter().find(|item| Some(item.value) == number);
            match named.or(numbered) {
                Some(item) => Value::Number(item.value),
                None => {
                    let names = control.items.iter().map(|item| item.name.as_str());
                    return Err(unknown(device, "menu item", value, names));
                }
            }
        }
        ControlKind::Boolean => match value {
            "on" | "true" | "yes" => Value::Number(1),
            "off" | "false" | "no" => Value::Number(0),
            _ => Value::Number(number.ok_or_else(|| wrong("give on or off".to_owned()))?),
        },
        ControlKind::Integer | ControlKind::Integer64 => {
            let number = number.ok_or_else(|| wrong(range()))?;
            if !(control.minimum..=control.maximum).contains(&number) {
                return Err(wrong(range()));
            }
            Value::Number(number)
        }
        ControlKind::Bitmask => Value::Number(number.ok_or_else(|| wrong("give a number".to_owned()))?),
    };
    device.set_control(control, &value).map_err(|error| {
        let inactive = control.is_inactive();
        let remedy = if inactive {
            "another control has switched it off".to_owned()
        } else {
            "see --controls".to_owned()
        };
        refused(device, format!("{name}={value}"), &error, remedy)
    })
}

/// A decimal number, or a hexadecimal one after 0x.
fn parse_number(text: &str) -> Option<i64> {
    match text.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decimal_or_hexadecimal() {
        assert_eq!(
            ["12", "-3", "0x1F", "x", ""].map(parse_number),
            [Some(12), Some(-3), Some(31), None, None]
        );
    }
}
