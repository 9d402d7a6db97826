"""A frame while it arrives and afterwards: its pixels, what is missing of it, and the device's word on it."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from .formats import Bytes, PixelFormat, Values, to_rgb, values
from .packet import FrameEnd, Verdict, verdict_name


class Placement(Enum):
    """What became of a line."""

    PUT = "put in its place"
    DROPPED = "not needed, or not usable without what was lost before it"
    UNFIT = "outside the picture"


@dataclass(eq=False)
class Frame:
    """One frame of one stream.

    Pixels of a line that has not come, or not whole, are 0 and the line is marked in `present`; nothing ever moves up
    into the gap. Lines that the device sends again on request are put into their place even after the end.

    Attributes:
        stream: number of the stream.
        name: the stream's name, such as `raw` or `edges`; empty until the device has said it.
        sequence: number of the frame on the camera's wires; streams made of one capture share it.
        format: how its bytes are pixels.
        meaning: mosaic order, YUV matrix and range, as in the protocol.
        width: pixels.
        height: lines.
        data: bytes of the lines, of shape (height, bytes of a line).
        reached: for each line the pixels that have come from the left on.
        captured_at: microseconds since the device started; None when the frame's beginning was lost.
        snapshot: whether a snapshot was asked for.
        palette_crc: the palette that it wants.
        palette: red, green, blue of index 0, 1, …; None if it has none, or has not come.
        closed: whether it is over.
        end: what the device said when it was over; None when that was lost.
        crc_ok: whether the frame's own CRC is right; None when lines are missing, or the end.
        changes: goes up whenever anything of it changes.
    """

    stream: int
    sequence: int
    format: PixelFormat
    width: int
    height: int
    name: str = ""
    meaning: int = 0
    captured_at: int | None = None
    snapshot: bool = False
    palette_crc: int = 0
    palette: bytes | None = None
    closed: bool = False
    end: FrameEnd | None = None
    crc_ok: bool | None = None
    data: Bytes = field(init=False, repr=False)
    reached: npt.NDArray[np.int32] = field(init=False, repr=False)
    changes: int = field(default=0, repr=False)
    sequence_known: bool = field(default=True, repr=False)
    lost_counted: int = field(default=0, repr=False)

    def __post_init__(self) -> None:
        """Make room for the lines."""
        self.width -= self.width % self.format.unit_pixels
        self.data = np.zeros((self.height, self.format.row_bytes(self.width)), np.uint8)
        self.reached = np.zeros(self.height, np.int32)

    # What it shows.

    @property
    def pixels(self) -> Values:
        """The numbers of the pixels, (height, width) or (height, width, channels): see `formats.values`."""
        return values(self.data, self.format, self.width)

    @property
    def rgb(self) -> Bytes:
        """The picture as a screen shows it, (height, width, 3) or gray (height, width); missing lines are black."""
        return to_rgb(self.data, self.format, self.width, self.meaning, self.palette)

    def marked(self) -> Bytes:
        """The picture in colour with missing lines as a magenta and black checker, which no scene has."""
        picture = self.rgb
        if picture.ndim == 2:
            picture = np.repeat(picture[:, :, None], 3, axis=2)
        missing = self.missing
        if missing.any():
            picture = picture.copy()
            rows, columns = np.flatnonzero(missing)[:, None], np.arange(self.width)[None, :]
            light = (rows // 8 + columns // 8) % 2 == 0
            picture[missing] = np.where(light[:, :, None], np.array([255, 0, 255], np.uint8), np.uint8(0))
        return picture

    # How it is.

    @property
    def present(self) -> npt.NDArray[np.bool_]:
        """For each line whether it is there, whole."""
        return np.equal(self.reached, self.width)

    @property
    def missing(self) -> npt.NDArray[np.bool_]:
        """For each line whether it is missing, or a part of it."""
        return np.not_equal(self.reached, self.width)

    @property
    def missing_lines(self) -> list[int]:
        """Numbers of the lines that are missing, or a part of them."""
        return [int(line) for line in np.flatnonzero(self.missing)]

    @property
    def lost_lines(self) -> int:
        """Lines that the link lost: missing ones, less those that the device says it never sent."""
        missing = int(np.count_nonzero(self.missing))
        unsent = self.height - self.end.lines_sent if self.end else 0
        return max(0, missing - max(0, unsent))

    @property
    def verdict(self) -> Verdict | int | None:
        """The device's verdict on the capture; a number if this version has no name for it; None if it was lost."""
        if self.end is None:
            return None
        try:
            return Verdict(self.end.verdict)
        except ValueError:
            return self.end.verdict

    @property
    def verdict_text(self) -> str:
        """The verdict in words, with its number where it has one."""
        if self.end is None:
            return "end lost" if self.closed else "arriving"
        text = verdict_name(self.end.verdict)
        return f"{text} ({self.end.detail})" if self.end.detail else text

    @property
    def whole(self) -> bool:
        """Whether nothing at all is wrong: every line there, a good verdict, and the CRC right."""
        return self.verdict == Verdict.GOOD and self.crc_ok is True and not self.missing.any()

    # How it is put together.

    def put_lines(self, lines: npt.NDArray[np.integer], rows: Bytes) -> bool:
        """Put whole lines in their places, all or none: none if one lies outside, is there already or comes twice."""
        if lines.size == 0 or rows.shape[1] != self.data.shape[1] or self.width == 0:
            return False
        if np.any(np.diff(lines) <= 0) or lines[0] < 0 or lines[-1] >= self.height:
            return False
        first, last = int(lines[0]), int(lines[-1]) + 1
        place = slice(first, last) if last - first == lines.size else lines
        if np.any(self.reached[place] == self.width):
            return False
        self.data[place] = rows
        self.reached[place] = self.width
        self.changes += 1
        return True

    def put_piece(self, line: int, first: int, pixels: Bytes) -> Placement:
        """Put a line, or a piece of one, in its place."""
        unit = self.format
        until = first + pixels.size // unit.unit_bytes * unit.unit_pixels
        if line >= self.height or first % unit.unit_pixels or until > self.width:
            return Placement.UNFIT
        reached = self.reached[line]
        if reached == self.width or first not in (0, reached):
            # There already: what came first stays. Or a piece whose left neighbour is lost.
            return Placement.DROPPED
        begin = unit.row_bytes(first)
        self.data[line, begin : begin + pixels.size] = pixels
        self.reached[line] = until
        self.changes += 1
        return Placement.PUT

    def resize(self, width: int, height: int) -> None:
        """Take another size: lines and pixels keep their places; a line longer than that is missing."""
        width -= width % self.format.unit_pixels
        if (width, height) == (self.width, self.height):
            return
        data, reached = self.data, self.reached
        self.width, self.height = width, height
        self.data = np.zeros((height, self.format.row_bytes(width)), np.uint8)
        self.reached = np.zeros(height, np.int32)
        lines, row = min(height, data.shape[0]), min(data.shape[1], self.data.shape[1])
        self.data[:lines, :row] = data[:lines, :row]
        self.reached[:lines] = reached[:lines]
        too_long = self.reached > width
        self.data[too_long] = 0
        self.reached[too_long] = 0
        self.changes += 1

    def close(self, end: FrameEnd | None) -> None:
        """Say that it is over."""
        if end is not None:
            self.resize(end.width, end.height)
            self.end = end
        self.closed = True
        self.changes += 1
        self.check()

    def check(self) -> None:
        """Check the frame's own CRC, if every line that was sent is there."""
        self.crc_ok = None
        if self.end is None:
            return
        present = self.present
        if np.count_nonzero(present) == self.end.lines_sent:
            rows = self.data if present.all() else self.data[present]
            self.crc_ok = zlib.crc32(np.ascontiguousarray(rows).data) == self.end.frame_crc
