"""The packets of the link, byte by byte as docs/link-protocol.md has them, with Python's cobs and zlib."""

import struct
import zlib

from cobs import cobs


def body(kind, content, version=1, length=None):
    head = struct.pack("<BBH", version, kind, len(content) if length is None else length) + content
    return head + struct.pack("<I", zlib.crc32(head))


def wire(body):
    return cobs.encode(body) + b"\0"


def hello(session, name, streams=2):
    content = struct.pack("<4sBBHHBBIHHI", b"CAMI", 1, 1, 512, 4096, streams, 0, 0x3FFF, 0x1F, 0, session)
    return body(1, content + name.encode())


def stream(number, format, encoding, on, width, height, meaning, pipeline, name):
    text = pipeline.encode()
    content = struct.pack("<BBBBHHBBH", number, format, encoding, on, width, height, meaning, len(text), 0)
    return body(2, content + text + name.encode())


def palette(number, colours):
    return body(3, struct.pack("<BBH", number, 0, len(colours) // 3) + colours)


def frame(number, format, meaning, flags, sequence, width, height, captured, palette_crc=0):
    return body(4, struct.pack("<BBBBIHHQI", number, format, meaning, flags, sequence, width, height, captured, palette_crc))


def line(number, format, encoding, sequence, row, first, payload, unused=0, again=0):
    head = struct.pack("<BBBBHHH", number, format, encoding | unused << 4, again, sequence & 0xFFFF, row, first)
    return body(5, head + payload)


def end(number, format, verdict, lines, sequence, width, height, captured, detail, overruns, dropped, sent, crc):
    counts, least, most, size = captured
    return body(6, struct.pack("<BBBBIHHIIIIIIIIIHH", number, format, verdict, 0, sequence, width, height, counts, size,
                               least, most, detail, overruns, dropped, sent, crc, lines, 0))


HEARTBEAT = ["session", "uptime", "delivered", "dropped", "lost", "skipped", "overruns", "sync_errors", "dma_errors",
             "lines_dropped", "packets_sent", "bytes_sent", "packets_unsent", "packets_received", "packets_damaged",
             "baud", "state", "cause"]


def heartbeat(values):
    return body(7, struct.pack("<IQ14IBBH", *values, 0))


def log(level, cut, lost, time, text):
    return body(8, struct.pack("<BBHQ", level, cut, lost, time) + text.encode())


def reply(request, command, status, rest):
    return body(9, struct.pack("<HBB", request, command, status) + rest)


def command(request, code, rest=b""):
    return body(0x81, struct.pack("<HBB", request, code, 0) + rest)
