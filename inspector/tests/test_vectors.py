"""The vectors that every implementation of the link is held to."""

from dataclasses import asdict

import numpy as np
import pytest

from camif_inspect import encodings, packet
from camif_inspect.formats import FORMATS
from camif_inspect.frame import Frame
from camif_inspect.packet import Kind
from camif_inspect.receiver import Receiver
from vectors import VECTORS, load

FORMAT = {entry.name: entry for entry in FORMATS.values()}
ENCODING = {name: code for code, name in encodings.NAMES.items()}
KINDS = {
    "hello": packet.Hello,
    "stream": packet.StreamInfo,
    "palette": packet.Palette,
    "frame": packet.FrameStart,
    "line": packet.Line,
    "end": packet.FrameEnd,
    "heartbeat": packet.Heartbeat,
    "log": packet.Log,
    "reply": packet.Reply,
}
# What the vectors call otherwise than the classes here.
NAMES = {
    "captured": "captured_at",
    "colours": "colors",
    "newest": "newest_version",
    "oldest": "oldest_version",
    "sends": "largest_sent",
    "takes": "largest_received",
    "text": "name",
}


def named(entries):
    return pytest.mark.parametrize("entry", entries, ids=lambda entry: entry.get("name"))


@named([entry for entry in VECTORS["packets"] if entry["kind"] != "command"])
def test_a_packet_holds_what_was_put_in(entry):
    wire = load(entry["wire"])
    assert wire.endswith(b"\0")
    parsed = packet.parse(packet.body_of(wire.strip(b"\0")))
    assert isinstance(parsed, KINDS[entry["kind"]])
    fields = asdict(parsed)
    compared = 0
    for key, expected in entry.items():
        if key in ("name", "wire", "kind"):
            continue
        got = parsed.crc if key == "crc" else fields[key if key in fields else NAMES[key]]
        if key == "format":
            got = FORMATS[got].name
        elif key == "encoding" and isinstance(expected, str):
            got = encodings.NAMES[got]
        elif isinstance(got, bytes):
            got = got.hex()
        assert got == expected, key
        compared += 1
    assert compared == len(fields) + (1 if "crc" in entry else 0)


@named([entry for entry in VECTORS["packets"] if entry["kind"] == "command"])
def test_a_command_is_what_the_device_expects(entry):
    wire = packet.command_wire(entry["request"], entry["command"], bytes.fromhex(entry["rest"]))
    assert wire == load(entry["wire"]).lstrip(b"\0")


@named(VECTORS["damaged"])
def test_a_bad_packet_is_told_for_what_it_is(entry):
    receiver = Receiver()
    receiver.feed(load(entry["wire"]))
    counts = asdict(receiver.counts)
    field = entry["is"].replace("-", "_")
    assert counts[field] == 1
    others = ("received", "damaged", "malformed", "other_version", "unknown_kind")
    assert sum(counts[name] for name in others) == 1


def encoding_name(entry):
    return f"{entry['format']}-{entry['encoding']}-{entry['pixels']}"


@pytest.mark.parametrize("entry", VECTORS["encodings"], ids=encoding_name)
def test_an_encoding_gives_the_pixels_back(entry):
    payload, pixels = load(entry["payload"]), load(entry["pixels"])
    arguments = ENCODING[entry["encoding"]], entry["unused"]
    # By itself, and in the middle of a batch.
    for payloads in ([payload], [payload] * 3):
        out, counts = encodings.decode(*arguments, payloads, FORMAT[entry["format"]])
        assert out.tobytes() == pixels * len(payloads)
        assert counts.tolist() == [len(pixels)] * len(payloads)


@pytest.mark.parametrize("piece", [1, 7, 1 << 20])
@named(VECTORS["streams"])
def test_a_stream_becomes_its_frames(entry, piece):
    wire = load(entry["wire"])
    receiver = Receiver()
    events = []
    for start in range(0, len(wire), piece):
        events += receiver.feed(wire[start : start + piece])
    counts = asdict(receiver.counts)
    assert {key: counts[key] for key in entry["counts"]} == entry["counts"]
    frames = [event for event in events if isinstance(event, Frame)]
    assert len(frames) == len(entry["frames"])
    for frame, expected in zip(frames, entry["frames"], strict=True):
        assert (frame.stream, frame.sequence) == (expected["stream"], expected["sequence"])
        assert (frame.width, frame.height, frame.format.name) == (
            expected["width"],
            expected["height"],
            expected["format"],
        )
        assert frame.missing_lines == expected["missing"]
        assert frame.verdict == expected["verdict"]
        assert frame.crc_ok == expected["crc_ok"]
        picture = np.where(frame.missing[:, None], np.uint8(0), frame.data)
        assert picture.tobytes() == load(expected["picture"])


def test_the_kinds_are_all_in_the_vectors():
    kinds = {entry["kind"].upper() for entry in VECTORS["packets"]}
    assert kinds == {kind.name for kind in Kind}
