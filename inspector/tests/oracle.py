"""The encodings undone as the protocol's page tells it, byte by byte: slow, and plain enough to be believed.

Each function gives the bytes of the pixels, or None for a payload that is malformed.
"""


def run_length(payload, unit):
    out, at = b"", 0
    while at < len(payload):
        control = payload[at]
        length = unit * (control + 1 if control < 128 else 1)
        part = payload[at + 1 : at + 1 + length]
        if len(part) < length:
            return None
        out += part if control < 128 else part * (control - 126)
        at += 1 + length
    return out


def bits_run_length(payload):
    if len(payload) < 2:
        return None
    pixels = payload[0] | payload[1] << 8
    packed = run_length(payload[2:], 1)
    if packed is None or len(packed) != (pixels + 7) // 8:
        return None
    return bytes(255 * (packed[place // 8] >> place % 8 & 1) for place in range(pixels))


def qoi_colour(payload):
    out, at = b"", 0
    pixel, index = (0, 0, 0), [(0, 0, 0)] * 64
    while at < len(payload):
        code, rest, times = payload[at], payload[at + 1 :], 1
        at += 1
        red, green, blue = pixel
        if code == 0xFF:
            return None
        if code == 0xFE:
            if len(rest) < 3:
                return None
            pixel = tuple(rest[:3])
            at += 3
        elif code >= 0xC0:
            times = (code & 63) + 1
        elif code >= 0x80:
            if not rest:
                return None
            luma = (code & 63) - 32
            pixel = (red + luma + (rest[0] >> 4) - 8, green + luma, blue + luma + (rest[0] & 15) - 8)
            at += 1
        elif code >= 0x40:
            pixel = (red + (code >> 4 & 3) - 2, green + (code >> 2 & 3) - 2, blue + (code & 3) - 2)
        else:
            pixel = index[code]
        pixel = tuple(channel % 256 for channel in pixel)
        index[(3 * pixel[0] + 5 * pixel[1] + 7 * pixel[2] + 11 * 255) % 64] = pixel
        out += bytes(pixel) * times
    return out


def qoi_samples(payload, lag):
    out, at = [], 0

    def add(difference):
        out.append(((out[-lag] if len(out) >= lag else 0) + difference) % 256)

    while at < len(payload):
        code = payload[at]
        at += 1
        if code == 0xFF or (code == 0xFE and at == len(payload)):
            return None
        if code == 0xFE:
            out.append(payload[at])
            at += 1
        elif code >= 0xC0:
            for _ in range((code & 63) + 1):
                add(0)
        elif code >= 0x80:
            add((code & 63) - 32)
        elif code >= 0x40:
            for shift in (4, 2, 0):
                add((code >> shift & 3) - 2)
        else:
            for shift in (3, 0):
                add((code >> shift & 7) - 4)
    return bytes(out)
