"""Formats of pixels: how many bytes they take, what numbers they hold, and how they look.

A frame arrives as rows of bytes. `values` gives the numbers that the sensor or the device meant, `to_rgb` what a screen
can show; both are numpy from end to end. Colours come out as the device's own library makes them, bit by bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

Bytes = npt.NDArray[np.uint8]
Values = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]

RGB888 = 1
RGB565_LE = 2
RGB565_BE = 3
GRAY8 = 4
YUYV = 5
UYVY = 6
RAW8 = 7
RAW10 = 8
RAW12 = 9
INDEX8 = 10

BAYER_ORDERS = ("rggb", "bggr", "grbg", "gbrg")


@dataclass(frozen=True)
class PixelFormat:
    """One row of the protocol's table of formats.

    Attributes:
        code: its number on the link.
        name: its name.
        unit_bytes: bytes of a unit.
        unit_pixels: pixels of a unit; a line is a multiple of them.
        channels: names of the values of a pixel.
        bits: bits of a value.
    """

    code: int
    name: str
    unit_bytes: int
    unit_pixels: int
    channels: tuple[str, ...]
    bits: int = 8

    @property
    def bayer(self) -> bool:
        """Whether a pixel has one colour out of three."""
        return self.code in (RAW8, RAW10, RAW12)

    def row_bytes(self, width: int) -> int:
        """Bytes of a row of `width` pixels."""
        return width // self.unit_pixels * self.unit_bytes


FORMATS: dict[int, PixelFormat] = {
    entry.code: entry
    for entry in (
        PixelFormat(RGB888, "rgb888", 3, 1, ("R", "G", "B")),
        PixelFormat(RGB565_LE, "rgb565-le", 2, 1, ("R", "G", "B")),
        PixelFormat(RGB565_BE, "rgb565-be", 2, 1, ("R", "G", "B")),
        PixelFormat(GRAY8, "gray8", 1, 1, ("Y",)),
        PixelFormat(YUYV, "yuyv", 4, 2, ("Y", "Cb", "Cr")),
        PixelFormat(UYVY, "uyvy", 4, 2, ("Y", "Cb", "Cr")),
        PixelFormat(RAW8, "raw8", 1, 1, ("raw",)),
        PixelFormat(RAW10, "raw10", 2, 1, ("raw",), 10),
        PixelFormat(RAW12, "raw12", 2, 1, ("raw",), 12),
        PixelFormat(INDEX8, "index8", 1, 1, ("index",)),
    )
}


def values(data: Bytes, pixel_format: PixelFormat, width: int) -> Values:
    """Give the numbers of the pixels, of shape (height, width) or (height, width, channels).

    RGB565 is expanded to 8 bits by repeating high bits below; YUV gives every pixel the chroma of its pair; RAW of more
    than 8 bits gives 16-bit numbers, bits above the depth cleared. Gray, RAW8, RGB888 and indices are views of `data`.
    """
    height = data.shape[0]
    code = pixel_format.code
    if code == RGB888:
        return data.reshape(height, width, 3)
    if code in (RGB565_LE, RGB565_BE):
        words = data.view("<u2" if code == RGB565_LE else ">u2").astype(np.uint16)
        red, green, blue = words >> 11, words >> 5 & 0x3F, words & 0x1F
        expanded = (red << 3 | red >> 2, green << 2 | green >> 4, blue << 3 | blue >> 2)
        return np.stack(expanded, axis=-1).astype(np.uint8)
    if code in (YUYV, UYVY):
        units = data.reshape(height, width // 2, 4)
        luma, chroma = (
            (units[:, :, 0::2], units[:, :, 1::2]) if code == YUYV else (units[:, :, 1::2], units[:, :, 0::2])
        )
        planes = np.empty((height, width, 3), np.uint8)
        planes[:, :, 0] = luma.reshape(height, width)
        planes[:, :, 1:] = np.repeat(chroma, 2, axis=1)
        return planes
    if code in (RAW10, RAW12):
        samples: npt.NDArray[np.uint16] = data.view("<u2").astype(np.uint16) & np.uint16((1 << pixel_format.bits) - 1)
        return samples
    return data.reshape(height, width)


def to_rgb(data: Bytes, pixel_format: PixelFormat, width: int, meaning: int = 0, palette: bytes | None = None) -> Bytes:
    """Give the picture as a screen shows it: (height, width, 3) in colour, (height, width) in gray.

    `meaning` is the stream's colour meaning (mosaic order, YUV matrix and range). RAW is demosaiced bilinearly; indices
    without a palette become gray levels.
    """
    numbers = values(data, pixel_format, width)
    code = pixel_format.code
    if code in (YUYV, UYVY):
        return _yuv_to_rgb(numbers, meaning)
    if pixel_format.bayer:
        samples = (numbers >> (pixel_format.bits - 8)).astype(np.uint8)
        if 0 in numbers.shape or numbers.shape[0] < 2 or numbers.shape[1] < 2:
            return samples
        return demosaic(samples, BAYER_ORDERS[meaning & 3])
    if code == INDEX8 and palette is not None:
        table = np.zeros((256, 3), np.uint8)
        table[: len(palette) // 3] = np.frombuffer(palette, np.uint8).reshape(-1, 3)
        return table[numbers]
    return numbers.astype(np.uint8, copy=False)


def _q16(numerator: int, denominator: int) -> int:
    """Divide, in 16 bits after the point, to the nearest."""
    scaled = abs(numerator) * (1 << 17) + denominator
    return (1 if numerator >= 0 else -1) * (scaled // (2 * denominator))


@lru_cache
def _yuv_coefficients(bt709: bool, full: bool) -> tuple[int, int, int, int, int, int]:
    """Black, and the weights of luma, Cr in red, Cb and Cr in green, Cb in blue, in Q16 (BT.601-7, BT.709-6)."""
    kr, kb = (2126, 722) if bt709 else (2990, 1140)
    kg = 10_000 - kr - kb
    black, luma_span, chroma_span = (0, 255, 255) if full else (16, 219, 224)
    return (
        black,
        _q16(255, luma_span),
        _q16(2 * (10_000 - kr) * 255, 10_000 * chroma_span),
        _q16(-2 * (10_000 - kb) * kb * 255, kg * 10_000 * chroma_span),
        _q16(-2 * (10_000 - kr) * kr * 255, kg * 10_000 * chroma_span),
        _q16(2 * (10_000 - kb) * 255, 10_000 * chroma_span),
    )


def _yuv_to_rgb(planes: Values, meaning: int) -> Bytes:
    black, of_luma, red_cr, green_cb, green_cr, blue_cb = _yuv_coefficients(bool(meaning & 0x10), bool(meaning & 0x20))
    wide = planes.astype(np.int32)
    gray = (wide[..., 0] - black) * of_luma + (1 << 15)
    cb, cr = wide[..., 1] - 128, wide[..., 2] - 128
    colours = (gray + red_cr * cr, gray + green_cb * cb + green_cr * cr, gray + blue_cb * cb)
    return np.stack([np.clip(colour >> 16, 0, 255) for colour in colours], axis=-1).astype(np.uint8)


def demosaic(samples: Bytes, order: str) -> Bytes:
    """Interpolate a Bayer mosaic bilinearly: what is missing is the mean of its nearest neighbours.

    Means are rounded to the nearest sample, halves up. The border is mirrored about its outermost pixels, which keeps
    the mosaic's order. At least 2 × 2 samples.
    """
    height, width = samples.shape
    padded = np.pad(samples.astype(np.uint16), 1, mode="reflect")
    centre = padded[1:-1, 1:-1]
    across = (padded[1:-1, :-2] + padded[1:-1, 2:] + 1) >> 1
    down = (padded[:-2, 1:-1] + padded[2:, 1:-1] + 1) >> 1
    beside = (padded[1:-1, :-2] + padded[1:-1, 2:] + padded[:-2, 1:-1] + padded[2:, 1:-1] + 2) >> 2
    corners = (padded[:-2, :-2] + padded[:-2, 2:] + padded[2:, :-2] + padded[2:, 2:] + 2) >> 2
    out = np.empty((height, width, 3), np.uint8)
    for y in range(2):
        for x in range(2):
            place = (slice(y, None, 2), slice(x, None, 2))
            colour = order[2 * y + x]
            if colour == "g":
                red_line = "r" in order[2 * y : 2 * y + 2]
                out[(*place, 0)] = across[place] if red_line else down[place]
                out[(*place, 1)] = centre[place]
                out[(*place, 2)] = down[place] if red_line else across[place]
            else:
                own, other = (0, 2) if colour == "r" else (2, 0)
                out[(*place, own)] = centre[place]
                out[(*place, 1)] = beside[place]
                out[(*place, other)] = corners[place]
    return out
