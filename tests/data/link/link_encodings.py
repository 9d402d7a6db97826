"""The encodings of the link, the plain way, and the numbers of formats and encodings."""

import struct

RGB888, RGB565_LE, GRAY8, RAW8, RAW10, YUYV, INDEX8 = 1, 2, 4, 7, 8, 5, 10
FORMAT = {1: "rgb888", 2: "rgb565-le", 3: "rgb565-be", 4: "gray8", 5: "yuyv", 6: "uyvy", 7: "raw8", 8: "raw10",
          9: "raw12", 10: "index8"}
UNIT = {1: 3, 2: 2, 3: 2, 4: 1, 5: 4, 6: 4, 7: 1, 8: 2, 9: 2, 10: 1}
RAW, RUN_LENGTH, QOI, BITS, BITS_RUN_LENGTH, CHOOSE = 0, 1, 2, 3, 4, 15
ENCODING = {0: "raw", 1: "run-length", 2: "qoi", 3: "bits", 4: "bits-run-length"}


def run_length(data, unit):
    units = [data[i:i + unit] for i in range(0, len(data), unit)]
    out, literal, at = b"", [], 0

    def flush():
        nonlocal out, literal
        if literal:
            out += bytes([len(literal) - 1]) + b"".join(literal)
        literal = []

    while at < len(units):
        run = 1
        while at + run < len(units) and units[at + run] == units[at] and run < 129:
            run += 1
        if run >= 2:
            flush()
            out += bytes([run + 126]) + units[at]
        else:
            literal.append(units[at])
            if len(literal) == 128:
                flush()
        at += run
    flush()
    return out


def qoi(data):
    index, before, out, run = [(0, 0, 0, 0)] * 64, (0, 0, 0), b"", 0
    pixels = [tuple(data[i:i + 3]) for i in range(0, len(data), 3)]
    signed = lambda value: (value + 128) % 256 - 128
    for at, pixel in enumerate(pixels):
        if pixel == before:
            run += 1
            if run == 62 or at + 1 == len(pixels):
                out, run = out + bytes([0xC0 | run - 1]), 0
            continue
        if run:
            out, run = out + bytes([0xC0 | run - 1]), 0
        place = (pixel[0] * 3 + pixel[1] * 5 + pixel[2] * 7 + 255 * 11) % 64
        red, green, blue = (signed(new - old) for new, old in zip(pixel, before))
        if index[place] == (*pixel, 255):
            out += bytes([place])
        elif all(-2 <= difference <= 1 for difference in (red, green, blue)):
            out += bytes([0x40 | red + 2 << 4 | green + 2 << 2 | blue + 2])
        elif -32 <= green <= 31 and -8 <= red - green <= 7 and -8 <= blue - green <= 7:
            out += bytes([0x80 | green + 32, red - green + 8 << 4 | blue - green + 8])
        else:
            out += bytes([0xFE, *pixel])
        index[place], before = (*pixel, 255), pixel
    return out


def qoi_gray(data, back):
    signed = lambda value: (value + 128) % 256 - 128
    steps = [signed(value - (data[at - back] if at >= back else 0)) for at, value in enumerate(data)]
    out, at = b"", 0
    fits = lambda count, least, most: len(steps[at:at + count]) == count and all(
        least <= step <= most for step in steps[at:at + count])
    while at < len(steps):
        run = 0
        while at + run < len(steps) and steps[at + run] == 0 and run < 62:
            run += 1
        if run >= 3:
            out, at = out + bytes([0xC0 | run - 1]), at + run
        elif fits(3, -2, 1):
            a, b, c = (step + 2 for step in steps[at:at + 3])
            out, at = out + bytes([0x40 | a << 4 | b << 2 | c]), at + 3
        elif fits(2, -4, 3):
            a, b = (step + 4 for step in steps[at:at + 2])
            out, at = out + bytes([a << 3 | b]), at + 2
        elif fits(1, -32, 31):
            out, at = out + bytes([0x80 | steps[at] + 32]), at + 1
        else:
            out, at = out + bytes([0xFE, data[at]]), at + 1
    return out


def bits(data):
    out = bytearray(-(-len(data) // 8))
    for at, value in enumerate(data):
        assert value in (0, 255)
        out[at // 8] |= (value & 1) << at % 8
    return bytes(out), -len(data) % 8


def encoded(data, format, encoding):
    """The payload, and the unused bits."""
    if encoding == RAW:
        return data, 0
    if encoding == RUN_LENGTH:
        return run_length(data, UNIT[format]), 0
    if encoding == QOI:
        return (qoi(data) if format == RGB888 else qoi_gray(data, 2 if format == RAW8 else 1)), 0
    packed, unused = bits(data)
    if encoding == BITS:
        return packed, unused
    return struct.pack("<H", len(data)) + run_length(packed, 1), 0
