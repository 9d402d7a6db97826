"""What the bytes of a pixel mean, against the definitions written out plainly."""

import numpy as np
import pytest

from camif_inspect.formats import FORMATS, demosaic, to_rgb, values

BY_NAME = {entry.name: entry for entry in FORMATS.values()}


def test_rgb565_repeats_the_high_bits_below():
    words = np.array([[0x0000, 0xFFFF, 0xF800, 0x07E0, 0x001F, 0x8410]])
    expected = [[[0, 0, 0], [255, 255, 255], [255, 0, 0], [0, 255, 0], [0, 0, 255], [132, 130, 132]]]
    for name, kind in (("rgb565-le", "<u2"), ("rgb565-be", ">u2")):
        data = words.astype(kind).view(np.uint8)
        assert values(data, BY_NAME[name], 6).tolist() == expected


@pytest.mark.parametrize("bt709", [False, True])
@pytest.mark.parametrize("full", [False, True])
def test_yuv_is_what_its_matrix_says(bt709, full):
    kr, kb = (0.2126, 0.0722) if bt709 else (0.299, 0.114)
    rng = np.random.default_rng(1)
    units = rng.integers(0, 256, (8, 40), dtype=np.uint8)
    y, cb, cr = (values(units, BY_NAME["yuyv"], 20)[..., place].astype(float) for place in range(3))
    black, luma, chroma = (0, 255, 255) if full else (16, 219, 224)
    y, cb, cr = (y - black) * 255 / luma, (cb - 128) * 255 / chroma, (cr - 128) * 255 / chroma
    red, blue = y + 2 * (1 - kr) * cr, y + 2 * (1 - kb) * cb
    green = (y - kr * red - kb * blue) / (1 - kr - kb)
    expected = np.clip(np.stack([red, green, blue], axis=-1), 0, 255)
    meaning = (0x10 if bt709 else 0) | (0x20 if full else 0)
    got = to_rgb(units, BY_NAME["yuyv"], 20, meaning)
    assert np.abs(got - expected).max() < 0.52
    swapped = units.reshape(8, -1, 2)[..., ::-1].reshape(8, -1)
    assert np.array_equal(to_rgb(np.ascontiguousarray(swapped), BY_NAME["uyvy"], 20, meaning), got)


def test_a_mosaic_is_interpolated_as_on_the_device():
    # The device library's own example: R at (0, 0).
    mosaic = np.array([[10, 100, 20], [120, 200, 140], [40, 160, 80]], np.uint8)
    out = demosaic(mosaic, "rggb")
    assert out[1, 1].tolist() == [38, 130, 200]
    assert out[0, 1].tolist() == [15, 100, 200]
    assert out[0, 0].tolist() == [10, 110, 200]


@pytest.mark.parametrize("order", range(4))
def test_a_flat_colour_comes_out_of_every_mosaic(order):
    colours = {"r": 200, "g": 90, "b": 13}
    names = ("rggb", "bggr", "grbg", "gbrg")[order]
    tile = np.array([colours[name] for name in names], np.uint16).reshape(2, 2)
    for name, bits in (("raw8", 8), ("raw10", 10), ("raw12", 12)):
        samples = np.tile(tile << (bits - 8), (3, 4))
        data = samples.astype(np.uint8) if bits == 8 else samples.astype("<u2").view(np.uint8)
        assert (to_rgb(data, BY_NAME[name], 8, order) == [200, 90, 13]).all()


def test_raw_bits_above_the_depth_are_ignored():
    data = np.array([[0xFFFF, 0x0401]], "<u2").view(np.uint8)
    assert values(data, BY_NAME["raw10"], 2).tolist() == [[0x3FF, 0x001]]


def test_indices_take_the_palettes_colours():
    data = np.array([[0, 1, 2]], np.uint8)
    palette = bytes([10, 20, 30, 40, 50, 60])
    assert to_rgb(data, BY_NAME["index8"], 3, 0, palette).tolist() == [[[10, 20, 30], [40, 50, 60], [0, 0, 0]]]
    assert to_rgb(data, BY_NAME["index8"], 3).tolist() == [[0, 1, 2]]
