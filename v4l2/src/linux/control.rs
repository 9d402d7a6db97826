use super::call::{Payload, QUERY_CONTROL, QUERY_MENU, call_control};
use super::device::Device;
use super::error::Error;
use super::raw::{self, Plain, text};

/// Something of a device that can be set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Control {
    /// Its number.
    pub id: u32,
    /// Its name in small letters and underscores, as `v4l2-ctl` writes it.
    pub name: String,
    /// What values it has.
    pub kind: ControlKind,
    /// The least value; of text, the fewest bytes.
    pub minimum: i64,
    /// The greatest value; of text, the most bytes.
    pub maximum: i64,
    /// The step between values.
    pub step: u64,
    /// The value that the driver begins with.
    pub default: i64,
    /// The flags `V4L2_CTRL_FLAG_…`.
    pub flags: u32,
    /// What there is to choose from, of menus.
    pub items: Vec<MenuItem>,
}

/// What values a control has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKind {
    /// A number of 32 bits.
    Integer,
    /// 0 or 1.
    Boolean,
    /// The number of a named item.
    Menu,
    /// None: to set it is to press it.
    Button,
    /// A number of 64 bits.
    Integer64,
    /// Text.
    Text,
    /// 32 flags.
    Bitmask,
    /// The number of an item that is itself a number.
    IntegerMenu,
    /// A structure or an array, which is listed and not set: `V4L2_CTRL_TYPE_…`.
    Compound(u32),
}

/// An item of a menu.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MenuItem {
    /// The control's value that means it.
    pub value: i64,
    /// Its name, or its number.
    pub name: String,
}

/// A control's value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// Of all kinds but text.
    Number(i64),
    /// Text.
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "{text:?}"),
        }
    }
}

/// `V4L2_CTRL_FLAG_DISABLED`, `…_READ_ONLY`, `…_INACTIVE`, `…_WRITE_ONLY`
const DISABLED: u32 = 0x01;
const READ_ONLY: u32 = 0x04;
const INACTIVE: u32 = 0x10;
const WRITE_ONLY: u32 = 0x40;

/// `V4L2_CTRL_TYPE_CTRL_CLASS`: a heading.
const HEADING: u32 = 6;

impl Control {
    /// Whether it can be read and not set.
    #[must_use]
    pub fn is_read_only(&self) -> bool {
        self.flags & READ_ONLY != 0
    }

    /// Whether it can be set and not read.
    #[must_use]
    pub fn is_write_only(&self) -> bool {
        self.flags & WRITE_ONLY != 0
    }

    /// Whether it has no effect as other controls are set.
    #[must_use]
    pub fn is_inactive(&self) -> bool {
        self.flags & INACTIVE != 0
    }

    fn is_wide(&self) -> bool {
        self.kind == ControlKind::Integer64
    }
}

/// A name as `v4l2-ctl` writes it: letters and digits in small, an underscore for what stands between.
fn plain_name(name: &str) -> String {
    let words = name.split(|character: char| !character.is_ascii_alphanumeric());
    words.filter(|word| !word.is_empty()).map(str::to_ascii_lowercase).collect::<Vec<_>>().join("_")
}

fn kind_of(kind: u32) -> ControlKind {
    match kind {
        1 => ControlKind::Integer,
        2 => ControlKind::Boolean,
        3 => ControlKind::Menu,
        4 => ControlKind::Button,
        5 => ControlKind::Integer64,
        7 => ControlKind::Text,
        8 => ControlKind::Bitmask,
        9 => ControlKind::IntegerMenu,
        other => ControlKind::Compound(other),
    }
}

impl Device {
    /// All controls.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn controls(&self) -> Result<Vec<Control>, Error> {
        let mut controls: Vec<Control> = Vec::new();
        let mut raw = raw::QueryControl::ZERO;
        loop {
            let before = raw.id;
            raw = raw::QueryControl { id: before | raw::NEXT_CONTROL, ..raw::QueryControl::ZERO };
            match self.call(&QUERY_CONTROL, &mut raw) {
                Err(error) if error.is_unsupported() => break,
                other => other?,
            }
            if raw.id <= before {
                // A driver that does not go on would not end.
                break;
            }
            // An element of an array is not the array.
            let kind = if raw.dimensions > 0 { ControlKind::Compound(raw.kind) } else { kind_of(raw.kind) };
            if raw.kind == HEADING || raw.flags & DISABLED != 0 {
                continue;
            }
            let mut control = Control {
                id: raw.id,
                name: plain_name(&text(&raw.name)),
                kind,
                minimum: raw.minimum,
                maximum: raw.maximum,
                step: raw.step,
                default: raw.default,
                flags: raw.flags,
                items: Vec::new(),
            };
            if matches!(kind, ControlKind::Menu | ControlKind::IntegerMenu) {
                control.items = self.items(&control);
            }
            controls.push(control);
        }
        Ok(controls)
    }

    /// The items of a menu; numbers may be left out.
    fn items(&self, control: &Control) -> Vec<MenuItem> {
        let (first, last) = (control.minimum.max(0), control.maximum.min(control.minimum.max(0) + 1023));
        let item = |index: i64| {
            let mut raw =
                raw::QueryMenu { id: control.id, index: u32::try_from(index).ok()?, ..raw::QueryMenu::ZERO };
            self.call(&QUERY_MENU, &mut raw).ok()?;
            let name = if control.kind == ControlKind::IntegerMenu {
                let [a, b, c, d, e, f, g, h, ..] = raw.name;
                i64::from_ne_bytes([a, b, c, d, e, f, g, h]).to_string()
            } else {
                text(&raw.name)
            };
            Some(MenuItem { value: index, name })
        };
        (first..=last).filter_map(item).collect()
    }

    /// A control's value; `None` of buttons and structures, which have none that could be said.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn control(&self, control: &Control) -> Result<Option<Value>, Error> {
        let error = |errno| self.error("VIDIOC_G_EXT_CTRLS", errno);
        match control.kind {
            _ if control.is_write_only() => Ok(None),
            ControlKind::Button | ControlKind::Compound(_) => Ok(None),
            ControlKind::Text => {
                let mut bytes = vec![0; usize::try_from(control.maximum).unwrap_or(0).min(1 << 16) + 1];
                let payload = &mut Payload::Bytes(&mut bytes);
                call_control(self.fd(), false, control.id, false, payload).map_err(error)?;
                let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
                Ok(Some(Value::Text(String::from_utf8_lossy(&bytes[..end]).into_owned())))
            }
            _ => {
                let mut payload = Payload::Number(0);
                call_control(self.fd(), false, control.id, control.is_wide(), &mut payload).map_err(error)?;
                Ok(match payload {
                    Payload::Number(number) => Some(Value::Number(number)),
                    Payload::Bytes(_) => None,
                })
            }
        }
    }

    /// Sets a control.
    ///
    /// # Errors
    /// If the device refuses: the value is out of range, or the control cannot be set now.
    pub fn set_control(&self, control: &Control, value: &Value) -> Result<(), Error> {
        let mut bytes: Vec<u8>;
        let mut payload = match value {
            Value::Number(number) => Payload::Number(*number),
            Value::Text(text) => {
                bytes = [text.as_bytes(), &[0]].concat();
                Payload::Bytes(&mut bytes)
            }
        };
        call_control(self.fd(), true, control.id, control.is_wide(), &mut payload)
            .map_err(|errno| self.error("VIDIOC_S_EXT_CTRLS", errno))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_v4l2_ctl() {
        assert_eq!(plain_name("White Balance, Automatic"), "white_balance_automatic");
        assert_eq!(plain_name("Inject V4L2_BUF_FLAG_ERROR"), "inject_v4l2_buf_flag_error");
        assert_eq!(plain_name("U32 1 Element Array"), "u32_1_element_array");
        assert_eq!(plain_name("--"), "");
    }
}
