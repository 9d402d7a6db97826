"""Frames as files: a PNG to look at, and the bytes as they are."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from .files import replacing, uninterrupted
from .frame import Frame

KINDS = ("png", "raw")


def stem(frame: Frame) -> str:
    """Name a frame's files: the stream's name and the frame's number, such as `raw-000041`."""
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", frame.name).strip("-.") or f"stream{frame.stream}"
    return f"{name}-{frame.sequence:06}"


def save_frame(frame: Frame, path: Path, kind: str) -> None:
    """Write a frame: `png`, 8 bits, missing lines as a magenta and black checker; `raw`, the bytes of its format."""
    with uninterrupted(), replacing(path) as file:
        if kind == "raw":
            file.write(frame.data.tobytes())
        else:
            picture = frame.marked() if frame.missing.any() else frame.rgb
            Image.fromarray(np.ascontiguousarray(picture)).save(file, format="PNG")


def summary(frame: Frame) -> dict[str, Any]:
    """Say what a frame is, for JSON."""
    return {
        "stream": frame.stream,
        "name": frame.name,
        "sequence": frame.sequence,
        "width": frame.width,
        "height": frame.height,
        "format": frame.format.name,
        "verdict": frame.verdict_text,
        "missing_lines": frame.missing_lines,
        "crc_ok": frame.crc_ok,
        "whole": frame.whole,
    }


def sentence(frame: Frame) -> str:
    """Say what a frame is, for people."""
    words = [f"{frame.name or frame.stream} {frame.sequence}: {frame.width} × {frame.height} {frame.format.name}"]
    words.append(frame.verdict_text)
    missing = frame.missing_lines
    if missing:
        words.append(f"{len(missing)} of {frame.height} lines missing")
    if frame.crc_ok is False:
        words.append("frame CRC wrong: a fault of the device")
    return ", ".join(words)
