#!/usr/bin/env python3
"""Writes the test vectors of the link from docs/link-protocol.md, with Python's cobs and zlib and nothing of ours.

    pip install cobs && python3 tests/data/link/generate.py          writes
    pip install cobs && python3 tests/data/link/generate.py --check  compares with what is there

What comes out of a stream is put together by hand beside the stream, not by a receiver.
"""

import json
import struct
import sys
import zlib
from pathlib import Path

from cobs import cobs

HERE = Path(__file__).parent
# Others load this file by its path.
sys.path.insert(0, str(HERE))
from link_encodings import (BITS, BITS_RUN_LENGTH, CHOOSE, ENCODING, FORMAT, GRAY8, INDEX8, QOI, RAW, RAW8, RAW10,  # noqa: E402
                            RGB565_LE, RGB888, RUN_LENGTH, UNIT, YUYV, bits, encoded)
from link_packets import (HEARTBEAT, body, command, end, frame, heartbeat, hello, line, log, palette, reply, stream,  # noqa: E402
                          wire)

written = {}


def put(name, data):
    written[name] = bytes(data)
    return name


# Pictures

def scattered(count, seed):
    """Bytes without a pattern: a linear congruential generator (Knuth's MMIX constants)."""
    state, out = seed, bytearray()
    for _ in range(count):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        out.append(state >> 56)
    return bytes(out)


def smooth(width, height, channels):
    """Slopes, a flat patch, and an edge in each line: something for every operation."""
    out = bytearray()
    for y in range(height):
        for x in range(width):
            for c in range(channels):
                value = (x * (c + 1) + y * 3) % 256 if x < width // 2 else 200 - 40 * c if x < width * 3 // 4 else 7 * x + y
                out.append(value % 256)
    return bytes(out)


def edge_map(width, height):
    return bytes(255 if (x == y * 2 or (x + y) % 37 == 0 or y == height - 1) else 0 for y in range(height) for x in range(width))


def lines_of(picture, height):
    size = len(picture) // height
    return [picture[size * y:size * (y + 1)] for y in range(height)]


# The vectors

def packet_vectors():
    colours = bytes([0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255])
    values = [0x12345678, 61_000_123, 100, 5, 2, 93, 7, 1, 0, 44, 48_000, 93_456_789, 12, 31, 2, 921_600, 1, 6]
    pixels = smooth(640, 1, 3)
    no_zero = bytes(1 + i % 255 for i in range(240 * 3))
    entries = []

    def entry(name, kind, packet, **fields):
        entries.append({"name": name, "wire": put(f"packet-{name}.bin", wire(packet)), "kind": kind, **fields})

    entry("hello", "hello", hello(0xCAFE0001, "camif vectors 1"), oldest=1, newest=1, takes=512, sends=4096, streams=2,
          commands=0x3FFF, encodings=0x1F, session=0xCAFE0001, text="camif vectors 1")
    entry("stream", "stream", stream(1, GRAY8, CHOOSE, 1, 640, 480, 0, "gray|canny:low=50,high=150", "edges"), stream=1,
          format="gray8", encoding=15, on=True, width=640, height=480, meaning=0,
          pipeline="gray|canny:low=50,high=150", text="edges")
    entry("palette", "palette", palette(2, colours), stream=2, colours=colours.hex(), crc=zlib.crc32(colours))
    entry("frame", "frame", frame(0, RGB888, 0, 1, 0x00012345, 640, 480, 5_000_000_000, 0), stream=0, format="rgb888",
          meaning=0, snapshot=True, sequence=0x12345, width=640, height=480, captured=5_000_000_000, palette_crc=0)
    entry("frame-longer", "frame", body(4, frame(2, INDEX8, 0x31, 0, 9, 16, 8, 1, zlib.crc32(colours))[4:-4] + b"\1\2\3\4"),
          stream=2, format="index8", meaning=0x31, snapshot=False, sequence=9, width=16, height=8, captured=1,
          palette_crc=zlib.crc32(colours))
    for name, data, at in [("line-vga", pixels, 0), ("line-no-zero", no_zero, 0), ("line-all-zero", bytes(720), 40)]:
        entry(name, "line", line(0, RGB888, RAW, 0x12345, 479, at, data), stream=0, format="rgb888", encoding="raw", unused=0,
              again=False, sequence=0x2345, line=479, first=at, payload=data.hex())
    # A body that ends with one or two full groups of 254 bytes without a zero: no empty group follows.
    for groups in (1, 2):
        for salt in range(1000):
            data = b"\0" + bytes(1 + (i * 7 + salt) % 255 for i in range(254 * groups - 4))
            packet = line(1, GRAY8, RAW, 0x0102, 0x0304, 0x0506, data, again=1)
            if 0 not in packet[-4:]:
                break
        assert len(cobs.encode(packet)) == len(packet) + groups
        entry(f"line-group-{groups}", "line", packet, stream=1, format="gray8", encoding="raw", unused=0, again=True,
              sequence=0x0102, line=0x0304, first=0x0506, payload=data.hex())
    largest = scattered(4078, 3)
    entry("line-largest", "line", line(0, GRAY8, RAW, 1, 2, 0, largest), stream=0, format="gray8", encoding="raw", unused=0,
          again=False, sequence=1, line=2, first=0, payload=largest.hex())
    map_line = edge_map(643, 3)[643:1286]
    payload, unused = encoded(map_line, GRAY8, BITS)
    entry("line-bits", "line", line(1, GRAY8, BITS, 7, 1, 0, payload, unused), stream=1, format="gray8", encoding="bits",
          unused=unused, again=False, sequence=7, line=1, first=0, payload=payload.hex())
    entry("end", "end", end(0, RGB888, 5, 470, 0x12345, 640, 480, (480, 1920, 1920, 921_600), 10, 3, 2, 902_400, 0xDEADBEEF),
          stream=0, format="rgb888", verdict=5, lines_sent=470, sequence=0x12345, width=640, height=480, lines_captured=480, bytes_captured=921_600,
          min_line_bytes=1920, max_line_bytes=1920, detail=10, overruns=3, dropped=2, bytes_sent=902_400,
          frame_crc=0xDEADBEEF)
    entry("heartbeat", "heartbeat", heartbeat(values), **dict(zip(HEARTBEAT, values)))
    entry("log", "log", log(2, 1, 3, 1_234_567, "overrun: µs matter"), level=2, cut=True, lost=3, time=1_234_567,
          text="overrun: µs matter")
    entry("reply-read", "reply", reply(77, 10, 0, struct.pack("<BBHIII", 0, 2, 0, 4, 0x11223344, 5)), request=77, command=10,
          status=0, rest=struct.pack("<BBHIII", 0, 2, 0, 4, 0x11223344, 5).hex())
    entry("reply-error", "reply", reply(78, 7, 3, "no stage `cany`; is it `canny`?".encode()), request=78, command=7, status=3,
          rest="no stage `cany`; is it `canny`?".encode().hex())
    arguments = [("ping", 0, b"abc\0def"), ("hello", 1, b""), ("start", 2, b""), ("stop", 3, b""),
                 ("snapshot", 4, struct.pack("<H", 3)), ("streams", 5, struct.pack("<I", 5)), ("encoding", 6, bytes([255, 15])),
                 ("stages", 7, b"\1\0\0\0gray|canny:low=50,high=150"), ("set", 8, struct.pack("<HHi", 2, 0, -7)),
                 ("get", 9, struct.pack("<H", 0)), ("read", 10, struct.pack("<BBHI", 0, 2, 0, 4)),
                 ("write", 11, struct.pack("<BBHII", 0, 0, 0, 0x0C, 0x1F)),
                 ("resend", 12, struct.pack("<BBHIH", 1, 0, 100, 0x12345, 20)), ("heartbeat", 13, b"")]
    for number, (name, code, rest) in enumerate(arguments):
        entry(f"command-{name}", "command", command(100 + number, code, rest), request=100 + number, command=code,
              rest=rest.hex())
    return entries


def damaged_vectors():
    good = hello(1, "x")
    entries = []

    def entry(name, data, what):
        entries.append({"name": name, "wire": put(f"damaged-{name}.bin", data), "is": what})

    flipped = bytearray(good)
    flipped[9] ^= 4
    entry("crc", wire(bytes(flipped)), "damaged")
    entry("short", wire(b"\1\2\3\4\5\6\7"), "damaged")
    entry("group-past-end", b"\x09\1\2\3\0", "damaged")
    entry("too-long", wire(body(5, bytes([1] * 4089))), "damaged")
    entry("length", wire(body(8, b"\3\0\0\0" + bytes(8) + b"text", length=15)), "malformed")
    entry("hello-short", wire(body(1, b"CAMI" + bytes(10))), "malformed")
    entry("hello-magic", wire(body(1, b"CAMX" + bytes(24))), "malformed")
    entry("line-unused", wire(line(0, GRAY8, BITS, 1, 1, 0, b"", unused=3)), "malformed")
    entry("palette-count", wire(body(3, struct.pack("<BBH", 0, 0, 300) + bytes(900))), "malformed")
    entry("stream-text", wire(body(2, struct.pack("<BBBBHHBBH", 0, 1, 0, 1, 4, 4, 0, 9, 0) + b"short")), "malformed")
    entry("version-2", wire(body(1, hello(5, "from the future")[4:-4], version=2)), "other-version")
    entry("version-0", wire(body(0x44, b"anything", version=0)), "other-version")
    entry("kind", wire(body(0x33, b"a kind of later days")), "unknown-kind")
    return entries


def encoding_vectors():
    entries = []
    for format, encodings, pixels in [
        (RGB888, (RAW, RUN_LENGTH, QOI), smooth(97, 1, 3)), (RGB888, (RUN_LENGTH, QOI), scattered(96, 1)),
        (RGB888, (QOI,), smooth(97, 1, 3) + bytes([9, 9, 9] * 200) + smooth(97, 1, 3)),
        (RGB888, (RUN_LENGTH, QOI), bytes(3 * 640)), (RGB565_LE, (RUN_LENGTH,), smooth(97, 1, 2)),
        (GRAY8, (RAW, RUN_LENGTH, QOI), smooth(97, 1, 1)), (GRAY8, (RUN_LENGTH, QOI), scattered(200, 2)),
        (GRAY8, (RUN_LENGTH, QOI, BITS, BITS_RUN_LENGTH), edge_map(643, 5)[643:1286]),
        (GRAY8, (BITS, BITS_RUN_LENGTH), bytes(643)), (GRAY8, (RUN_LENGTH, BITS), bytes([255]) * 640),
        (RAW8, (QOI,), smooth(97, 1, 1)), (YUYV, (RUN_LENGTH,), smooth(98, 1, 2)), (RAW10, (RUN_LENGTH,), smooth(50, 1, 2)),
        (INDEX8, (RUN_LENGTH,), bytes(x // 9 for x in range(100))), (GRAY8, (RAW, RUN_LENGTH, QOI, BITS), b"\xff"),
    ]:
        name = f"pixels-{FORMAT[format]}-{len(pixels)}-{zlib.crc32(pixels):08x}.raw"
        put(name, pixels)
        for encoding in encodings:
            payload, unused = encoded(pixels, format, encoding)
            file = put(name.replace("pixels-", "payload-").replace(".raw", f"-{ENCODING[encoding]}.bin"), payload)
            entries.append({"format": FORMAT[format], "encoding": ENCODING[encoding], "unused": unused, "pixels": name,
                            "payload": file})
    return entries


class Sent:
    """Frames of two streams: raw in colour, and a map."""

    def __init__(self, sequence):
        self.sequence = sequence
        self.raw = bytes((value + sequence) % 256 for value in smooth(40, 12, 3))
        self.map = edge_map(40, 12)

    def picture(self, number):
        return self.raw if number == 0 else self.map

    def begin(self, number):
        return frame(number, (RGB888, GRAY8)[number], 0, 0, self.sequence, 40, 12, self.sequence * 33_333)

    def line(self, number, row, again=0, cut=None, piece=0):
        format, encoding = ((RGB888, (RAW, RUN_LENGTH, QOI)[row % 3]), (GRAY8, (RAW, BITS, BITS_RUN_LENGTH, QOI)[row % 4]))[number]
        data, first = lines_of(self.picture(number), 12)[row], 0
        if cut is not None:
            size = UNIT[format]
            data, first = (data[:cut * size], 0) if piece == 0 else (data[cut * size:], cut)
        payload, unused = encoded(data, format, encoding)
        return line(number, format, encoding, self.sequence, row, first, payload, unused, again)

    def end(self, number, verdict=0):
        picture = self.picture(number)
        return end(number, (RGB888, GRAY8)[number], verdict, 12, self.sequence, 40, 12, (12, 120, 120, 1440), 0, 0, 0, len(picture), zlib.crc32(picture))

    def both(self):
        return [self.begin(0), self.begin(1), *(self.line(n, y) for y in range(12) for n in (0, 1)), self.end(0), self.end(1)]


OPENING = [hello(0xCAFE0001, "camif vectors 1"), stream(0, RGB888, CHOOSE, 1, 40, 12, 0, "", "raw"),
           stream(1, GRAY8, CHOOSE, 1, 40, 12, 0, "gray|canny", "edges")]


def stream_vectors():
    entries = []

    def expected(number, sent, missing=(), verdict=0, crc_ok="by missing"):
        picture = bytearray(sent.picture(number))
        size = len(picture) // 12
        for row in missing:
            picture[size * row:size * (row + 1)] = bytes(size)
        if crc_ok == "by missing":
            crc_ok = None if missing or verdict is None else True
        return {"stream": number, "sequence": sent.sequence, "width": 40, "height": 12,
                "format": ("rgb888", "gray8")[number], "picture": bytes(picture), "missing": list(missing),
                "verdict": verdict, "crc_ok": crc_ok}

    def entry(name, data, frames, **counts):
        for at, one in enumerate(frames):
            one["picture"] = put(f"stream-{name}-{at}.raw", one["picture"])
        zero = {"received": 0, "damaged": 0, "malformed": 0, "other_version": 0, "unknown_kind": 0, "unfit": 0}
        counts = zero | counts
        entries.append({"name": name, "wire": put(f"stream-{name}.bin", data), "counts": counts, "frames": frames})

    def whole(packets):
        return b"\0" + b"".join(map(wire, packets))

    one, two, wrapped = Sent(41), Sent(42), Sent(0x1FFFF)
    packets = OPENING + one.both() + two.both()
    entry("clean", whole(packets), [expected(n, s) for s in (one, two) for n in (0, 1)], received=len(packets))

    after = Sent(0x20000)
    packets = OPENING + wrapped.both() + after.both()
    entry("wrap", whole(packets), [expected(n, s) for s in (wrapped, after) for n in (0, 1)], received=len(packets))

    # Lines 0, 5 and 11 of the colours are lost, line 7 comes twice and out of order, line 3 of the map is lost.
    rows = [one.line(0, y) for y in (1, 2, 3, 4, 7, 6, 7, 8, 9, 10)] + [one.line(1, y) for y in range(12) if y != 3]
    packets = OPENING + [one.begin(0), one.begin(1), *rows, one.end(0), one.end(1)]
    entry("lost", whole(packets), [expected(0, one, (0, 5, 11)), expected(1, one, (3,))], received=len(packets))

    # FRAME of the colours is lost (STREAM stands in); END of both is lost: the next frame ends them.
    packets = OPENING + [one.begin(1), *(one.line(n, y) for y in range(12) for n in (0, 1))] + two.both()
    entry("no-frame-no-end", whole(packets), [expected(0, one, verdict=None), expected(1, one, verdict=None),
                                              expected(0, two), expected(1, two)], received=len(packets))

    # A flip in line 1, one byte lost in line 2, one put into line 3, the end of line 4 hit: it and line 5 are one then;
    # a zero put into line 6; noise between lines 7 and 8, closed by nothing, takes line 8 with it.
    parts = [bytearray(wire(one.line(0, y))) for y in range(12)]
    parts[1][30] ^= 0x10 if parts[1][30] != 0x10 else 0x20
    del parts[2][20]
    parts[3].insert(25, 0x55)
    parts[4][-1] ^= 0x40
    parts[6].insert(30, 0)
    parts[8][0:0] = bytes([9, 8, 7, 6])
    data = whole(OPENING + [one.begin(0)]) + b"".join(parts) + wire(one.end(0))
    entry("hit", data, [expected(0, one, (1, 2, 3, 4, 5, 6, 8))], received=3 + 1 + 5 + 1, damaged=7)

    # The receiver joins in the middle of a packet, without having seen STREAM: FRAME of frame 42 is the first it knows.
    data = wire(one.line(0, 11))[17:] + b"".join(map(wire, [one.end(1), *two.both()]))
    joined = expected(1, one, range(12))
    entry("joined", data, [joined, expected(0, two), expected(1, two)], received=1 + len(two.both()), damaged=1)

    # Line 4 is in two pieces; of line 5 only the second, of line 6 only the first comes: both are missing.
    # Line 7 comes as second, first, second.
    rows = []
    for y in range(12):
        piece = lambda which: one.line(0, y, cut=16, piece=which)
        rows += {4: [piece(0), piece(1)], 5: [piece(1)], 6: [piece(0)], 7: [piece(1), piece(0), piece(1)]}.get(
            y, [one.line(0, y)])
    packets = OPENING + [one.begin(0), *rows, one.end(0)]
    pieces = expected(0, one, (5, 6))
    entry("pieces", whole(packets), [pieces], received=len(packets))

    # Line 3 is sent again before END because it was asked for; line 6 of frame 41 comes again within frame 42, which lacks it.
    packets = OPENING + [one.begin(0), *(one.line(0, y) for y in range(12) if y != 3), one.line(0, 3, again=1), one.end(0)]
    packets += [two.begin(0), *(two.line(0, y) for y in range(6)), one.line(0, 6), *(two.line(0, y) for y in range(7, 12)), two.end(0)]
    entry("again", whole(packets), [expected(0, one), expected(0, two, (6,))], received=len(packets))

    # Lines past the height, pixels past the width, a payload that is no such encoding: not used.
    bad = [line(0, RGB888, RAW, 41, 12, 0, bytes(120)), line(0, RGB888, RAW, 41, 5, 0, bytes(123)),
           line(0, RGB888, QOI, 41, 5, 0, b"\xff"), line(0, RGB888, RUN_LENGTH, 41, 5, 0, b"\x05\1\2\3"),
           line(0, GRAY8, RAW, 41, 5, 0, bytes(40))]
    packets = OPENING + [one.begin(0), *(one.line(0, y) for y in range(12) if y != 5), *bad, one.end(0, verdict=2)]
    entry("unfit", whole(packets), [expected(0, one, (5,), verdict=2)], received=len(packets), unfit=len(bad))

    # The device starts anew in the middle of a frame.
    anew = [hello(0xCAFE0002, "camif vectors 1"), *OPENING[1:]]
    packets = OPENING + [one.begin(0), *(one.line(0, y) for y in range(5))] + anew + one.both()
    cut = expected(0, one, range(5, 12), verdict=None)
    entry("restart", whole(packets), [cut, expected(0, one), expected(1, one)], received=len(packets))
    return entries


def main():
    vectors = {"version": 1, "packets": packet_vectors(), "damaged": damaged_vectors(), "encodings": encoding_vectors(),
               "streams": stream_vectors()}
    put("vectors.json", (json.dumps(vectors, indent=1, ensure_ascii=False) + "\n").encode())
    if sys.argv[1:] == ["--check"]:
        wrong = [name for name, data in written.items() if not (HERE / name).exists() or (HERE / name).read_bytes() != data]
        wrong += [path.name for path in HERE.iterdir() if path.suffix in (".bin", ".raw", ".json") and path.name not in written]
        sys.exit(f"differ from what is generated: {', '.join(wrong)}" if wrong else 0)
    for name, data in written.items():
        (HERE / name).write_bytes(data)


if __name__ == "__main__":
    main()
