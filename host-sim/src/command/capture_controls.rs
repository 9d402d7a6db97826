use super::capture::Source;

/// Prints the controls of a camera, after those that are asked for are set.
pub(super) fn list_controls(
    source: &Source,
    input: Option<u32>,
    set: &[(String, String)],
    json: bool,
) -> anyhow::Result<()> {
    match source {
        #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
        Source::V4l2(path) => list_v4l2(path, input, set, json),
        #[cfg(all(target_os = "linux", feature = "libcamera"))]
        Source::Libcamera(_) if input.is_some() || !set.is_empty() => anyhow::bail!(
            "controls of libcamera's cameras last as long as a capture: give --set there, without --controls"
        ),
        #[cfg(all(target_os = "linux", feature = "libcamera"))]
        Source::Libcamera(id) => list_libcamera(id, json),
        #[allow(unreachable_patterns, reason = "which of them is left is a matter of the build")]
        other => {
            let _ = (input, set, json);
            Err(other.is_not_built())
        }
    }
}

#[cfg(all(target_os = "linux", feature = "libcamera"))]
fn list_libcamera(id: &str, json: bool) -> anyhow::Result<()> {
    let controls = crate::capture::libcamera::controls(id)?;
    if json {
        println!("{:#}", serde_json::json!({ "device": id, "controls": controls }));
        return Ok(());
    }
    if controls.is_empty() {
        println!("{id}: no controls");
    }
    for control in controls {
        let default =
            if control.default.is_empty() { String::new() } else { format!(", default {}", control.default) };
        let items: Vec<String> = control.items.iter().map(|(_, name)| name.clone()).collect();
        let range = if items.is_empty() {
            format!("{} to {}", control.minimum, control.maximum)
        } else {
            items.join(" · ")
        };
        println!("{:32} {:>12}   {range}{default}", control.name, control.kind);
    }
    Ok(())
}

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
fn list_v4l2(
    path: &std::path::Path,
    input: Option<u32>,
    set: &[(String, String)],
    json: bool,
) -> anyhow::Result<()> {
    use v4l2_capture::ControlKind;

    use crate::capture::v4l2;

    let device = v4l2::open(path)?;
    if let Some(input) = input {
        v4l2::set_input(&device, input)?;
    }
    for (name, value) in set {
        v4l2::set_control(&device, name, value)?;
    }
    let controls = v4l2::controls(&device)?;
    if json {
        let controls: Vec<_> = controls
            .iter()
            .map(|(control, value)| {
                serde_json::json!({
                    "name": control.name,
                    "kind": format!("{:?}", control.kind).to_lowercase(),
                    "minimum": control.minimum,
                    "maximum": control.maximum,
                    "step": control.step,
                    "default": control.default,
                    "value": value.as_ref().map(ToString::to_string),
                    "read_only": control.is_read_only(),
                    "inactive": control.is_inactive(),
                    "items": control.items.iter().map(|item| (item.value, &item.name)).collect::<Vec<_>>(),
                })
            })
            .collect();
        println!("{:#}", serde_json::json!({ "device": path, "controls": controls }));
        return Ok(());
    }
    for (control, value) in controls {
        let value = value.map_or_else(|| "–".to_owned(), |value| value.to_string());
        let range = match control.kind {
            ControlKind::Integer | ControlKind::Integer64 => {
                format!("{} to {}, default {}", control.minimum, control.maximum, control.default)
            }
            ControlKind::Boolean => format!("on or off, default {}", control.default),
            ControlKind::Menu | ControlKind::IntegerMenu => {
                let items = control.items.iter().map(|item| format!("{} {}", item.value, item.name));
                items.collect::<Vec<_>>().join(" · ")
            }
            ControlKind::Button => "press it by any value".to_owned(),
            ControlKind::Text => format!("{} to {} characters", control.minimum, control.maximum),
            ControlKind::Bitmask => format!("bits of {:#x}", control.maximum as u32),
            ControlKind::Compound(_) => "a structure or an array".to_owned(),
        };
        let state = match (control.is_read_only(), control.is_inactive()) {
            (true, _) => ", read only",
            (_, true) => ", switched off by another",
            _ => "",
        };
        println!("{:32} {value:>12}   {range}{state}", control.name);
    }
    Ok(())
}
