"""Whatever happens on the line: every undamaged packet is used, and no pixel is misplaced."""

import zlib
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import device as devices
import oracle
import pictures
from camif_inspect import encodings, qoi, walk
from camif_inspect.formats import FORMATS
from camif_inspect.frame import Frame
from camif_inspect.receiver import Receiver
from device import link

WIDTH, HEIGHT = 24, 10
OPENING = [devices.wire(link.hello(7, "t")), devices.wire(link.stream(0, 1, 0, 1, WIDTH, HEIGHT, 0, "", "raw"))]


def small(number):
    return pictures.colour(number, WIDTH, HEIGHT)


def frames_of(events):
    return [event for event in events if isinstance(event, Frame)]


PACKETS = OPENING + [packet for number in (1, 2, 3) for packet in devices.frame_packets(0, number, 1, small(number))]


def checked(receiver, events):
    """No pixel is anywhere but in its own place; gives the lines that came, by frame."""
    found = {}
    open_frames = [stream.open for stream in receiver.streams.values() if stream.open]
    for frame in frames_of(events) + open_frames:
        assert (frame.width, frame.height) == (WIDTH, HEIGHT)
        truth = small(frame.sequence).reshape(HEIGHT, -1)
        assert np.array_equal(frame.data[frame.present], truth[frame.present])
        assert not frame.data[frame.missing].any()
        assert frame.crc_ok in (None, True)
        found[frame.sequence] = set(np.flatnonzero(frame.present).tolist())
    return found


def cut(draw, data):
    places = sorted(draw(st.lists(st.integers(0, len(data)), max_size=5)))
    return [data[a:b] for a, b in zip([0, *places], [*places, len(data)], strict=True)]


@st.composite
def broken(draw):
    """The packets with some lost, hit, doubled or with noise between, and the lines that are whole all the same."""
    out, whole = [], []
    pieces = [("keep", packet) for packet in PACKETS]
    for place, (_, packet) in enumerate(pieces):
        kind = draw(st.sampled_from(["keep"] * 12 + ["lose", "flip", "insert", "remove", "double", "noise"]))
        hit = draw(st.integers(0, len(packet) - 2))
        if kind in ("keep", "double", "noise"):
            out += [packet] * (2 if kind == "double" else 1)
            if kind == "noise":
                out.append(bytes(draw(st.binary(max_size=20))) + b"\0")
            whole.append(place)
        elif kind == "flip":
            value = packet[hit] ^ 1 << draw(st.integers(0, 7))
            out.append(packet[:hit] + bytes([value]) + packet[hit + 1 :])
        elif kind == "insert":
            out.append(packet[:hit] + bytes([draw(st.integers(0, 255))]) + packet[hit:])
        elif kind == "remove":
            out.append(packet[:hit] + packet[hit + 1 :])
    return cut(draw, b"".join(out)), whole


@settings(max_examples=300, deadline=None)
@given(broken())
def test_undamaged_lines_arrive_and_none_is_misplaced(case):
    pieces, whole = case
    receiver = Receiver()
    events = [event for piece in pieces for event in receiver.feed(piece)]
    found = checked(receiver, events)
    if not {0, 1} <= set(whole):
        # Without HELLO or the size, lines before the first FRAME have no place.
        return
    per_frame = HEIGHT + 2
    for place in whole:
        number, part = divmod(place - 2, per_frame)
        if place >= 2 and 1 <= part <= HEIGHT:
            assert part - 1 in found[number + 1]


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=300), st.data())
def test_noise_is_never_a_frame(noise, data):
    receiver = Receiver()
    events = [event for piece in cut(data.draw, noise) for event in receiver.feed(piece)]
    assert events == []
    assert receiver.counts.received == 0


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_pieces_of_any_length_mean_the_same(data):
    wire = b"".join(PACKETS)
    receiver = Receiver()
    events = [event for piece in cut(data.draw, wire) for event in receiver.feed(piece)]
    assert checked(receiver, events) == {number: set(range(HEIGHT)) for number in (1, 2, 3)}
    assert receiver.counts.frames_whole == 3
    assert receiver.counts.damaged == 0


LINES = {
    "gray8": st.binary(min_size=1, max_size=200),
    "map": st.lists(st.sampled_from([0, 255]), min_size=1, max_size=200).map(bytes),
    "runs": st.lists(st.tuples(st.sampled_from([0, 1, 128, 255]), st.integers(1, 150)), min_size=1, max_size=6).map(
        lambda runs: b"".join(bytes([value]) * count for value, count in runs)
    ),
    "slopes": st.lists(st.integers(-5, 5), min_size=1, max_size=200).map(
        lambda steps: bytes(int(value) & 255 for value in np.cumsum(steps))
    ),
}
CASES = [
    ("gray8", "gray8", encodings.RUN_LENGTH),
    ("gray8", "runs", encodings.RUN_LENGTH),
    ("gray8", "gray8", encodings.QOI),
    ("gray8", "slopes", encodings.QOI),
    ("raw8", "gray8", encodings.QOI),
    ("raw8", "slopes", encodings.QOI),
    ("gray8", "map", encodings.BITS_RUN_LENGTH),
    ("rgb888", "gray8", encodings.QOI),
    ("rgb888", "runs", encodings.QOI),
    ("rgb888", "slopes", encodings.RUN_LENGTH),
    ("rgb565-le", "runs", encodings.RUN_LENGTH),
    ("yuyv", "runs", encodings.RUN_LENGTH),
]
BY_NAME = {entry.name: entry for entry in FORMATS.values()}


@pytest.mark.parametrize(("name", "kind", "encoding"), CASES)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_batches_decode_as_the_plain_encoder_encoded(name, kind, encoding, data):
    pixel_format = BY_NAME[name]
    lines = data.draw(st.lists(LINES[kind], min_size=1, max_size=5))
    lines = [line * pixel_format.unit_bytes if len(line) % pixel_format.unit_bytes else line for line in lines]
    payloads = [link.encoded(line, pixel_format.code, encoding)[0] for line in lines]
    out, counts = encodings.decode(encoding, 0, payloads, pixel_format)
    assert out.tobytes() == b"".join(lines)
    assert counts.tolist() == [len(line) for line in lines]


ORACLES = [
    ("rgb888", encodings.QOI, oracle.qoi_colour),
    ("gray8", encodings.QOI, lambda payload: oracle.qoi_samples(payload, 1)),
    ("raw8", encodings.QOI, lambda payload: oracle.qoi_samples(payload, 2)),
    ("gray8", encodings.RUN_LENGTH, lambda payload: oracle.run_length(payload, 1)),
    ("rgb888", encodings.RUN_LENGTH, lambda payload: oracle.run_length(payload, 3)),
    ("uyvy", encodings.RUN_LENGTH, lambda payload: oracle.run_length(payload, 4)),
    ("gray8", encodings.BITS_RUN_LENGTH, oracle.bits_run_length),
]


@pytest.mark.parametrize(("name", "encoding", "plain"), ORACLES)
@settings(max_examples=100, deadline=None)
@given(
    payloads=st.lists(st.binary(max_size=300), min_size=1, max_size=6),
    cells=st.sampled_from([0, walk._MOST_CELLS]),
    few=st.sampled_from([0, qoi._FEW]),
)
def test_any_payloads_mean_what_the_oracle_says(name, encoding, plain, payloads, cells, few):
    """Also where they are walked in groups of like length, as payloads of very different lengths are."""
    expected = [plain(payload) for payload in payloads]
    with mock.patch.object(walk, "_MOST_CELLS", cells), mock.patch.object(qoi, "_FEW", few):
        if None in expected:
            with pytest.raises(encodings.Malformed):
                encodings.decode(encoding, 0, payloads, BY_NAME[name])
            payloads = [payload for payload, pixels in zip(payloads, expected, strict=True) if pixels is not None]
            expected = [pixels for pixels in expected if pixels is not None]
        if payloads:
            out, counts = encodings.decode(encoding, 0, payloads, BY_NAME[name])
            assert out.tobytes() == b"".join(expected)
            assert counts.tolist() == [len(pixels) for pixels in expected]


@pytest.mark.parametrize("encoding", [encodings.RUN_LENGTH, encodings.QOI, encodings.BITS_RUN_LENGTH, encodings.BITS])
@pytest.mark.parametrize("name", list(BY_NAME))
@settings(max_examples=40, deadline=None)
@given(payloads=st.lists(st.binary(max_size=60), min_size=1, max_size=4))
def test_any_payload_is_pixels_or_malformed(name, encoding, payloads):
    def one_by_one():
        parts = [encodings.decode(encoding, 0, [payload], BY_NAME[name])[0].tobytes() for payload in payloads]
        return b"".join(parts)

    try:
        together = encodings.decode(encoding, 0, payloads, BY_NAME[name])[0].tobytes()
    except encodings.Malformed:
        with pytest.raises(encodings.Malformed):
            one_by_one()
    else:
        assert together == one_by_one()


def test_a_device_of_another_version_is_no_noise():
    body = bytearray(link.hello(7, "future")[:-4])
    body[0] = body[9] = 2
    packet = devices.wire(bytes(body) + zlib.crc32(body).to_bytes(4, "little"))
    receiver = Receiver()
    (event,) = receiver.feed(packet)
    assert (event.version, event.newest_version) == (2, 2)
    assert receiver.counts.damaged == 0
    assert receiver.versions == {2: 1}


def test_the_end_of_a_packet_is_forgiven_at_the_beginning():
    receiver = Receiver(joins_midway=True)
    receiver.feed(PACKETS[3][5:] + PACKETS[4])
    assert (receiver.counts.fragments, receiver.counts.damaged) == (1, 0)
    receiver.feed(PACKETS[3][5:])
    assert receiver.counts.damaged == 1


def test_what_is_too_long_is_dropped_and_counted_once():
    receiver = Receiver()
    for _ in range(10):
        receiver.feed(b"\x01" * 1000)
    assert receiver.counts.damaged == 1
    receiver.feed(b"\x01\0" + PACKETS[0])
    assert (receiver.counts.damaged, receiver.counts.received) == (1, 1)


def test_lines_of_a_later_frame_do_not_go_to_this_one():
    first, second = (devices.frame_packets(0, number, 1, small(number)) for number in (1, 2))
    receiver = Receiver()
    events = receiver.feed(b"".join(OPENING + first[:4] + second[3:]))
    assert checked(receiver, events) == {1: {0, 1, 2}, 2: set(range(2, HEIGHT))}
    assert [frame.verdict for frame in frames_of(events)] == [None, 0]
    assert receiver.counts.lines_lost == HEIGHT - 3 + 2


def test_lines_sent_again_mend_a_frame_that_is_over():
    packets = devices.frame_packets(0, 1, 1, small(1))
    receiver = Receiver()
    (frame,) = frames_of(receiver.feed(b"".join(OPENING + packets[:5] + packets[6:])))
    assert frame.missing_lines == [4]
    assert receiver.counts.lines_lost == 1
    assert not frame.whole
    receiver.feed(packets[5])
    assert frame.whole
    assert frame.crc_ok
    assert (receiver.counts.lines_lost, receiver.counts.frames_whole) == (0, 1)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_streams_and_encodings_that_take_turns_are_kept_apart(data):
    """Line by line, each in an encoding of its own, as a sender does that chooses; old lines come again in between."""
    kinds = [(1, small, (0, 1, 2)), (4, lambda number: pictures.edges(number, WIDTH, HEIGHT), (0, 1, 2, 3, 4))]
    wire = [*list(OPENING), devices.wire(link.stream(1, 4, 0, 1, WIDTH, HEIGHT, 0, "", "edges"))]
    for number in (1, 2, 3):
        takes = [
            {choice: devices.frame_packets(stream, number, code, make(number), choice) for choice in choices}
            for stream, (code, make, choices) in enumerate(kinds)
        ]
        again = [packets[0][3] for packets in takes] if number > 1 else []
        for place in range(HEIGHT + 2):
            for packets in takes:
                wire.append(packets[data.draw(st.sampled_from(sorted(packets)))][place])
            if place == 4:
                wire += again
    receiver = Receiver()
    frames = frames_of([event for piece in cut(data.draw, b"".join(wire)) for event in receiver.feed(piece)])
    assert [(frame.sequence, frame.stream) for frame in frames] == [(n, s) for n in (1, 2, 3) for s in (0, 1)]
    for frame in frames:
        assert frame.whole
        assert np.array_equal(frame.pixels, kinds[frame.stream][1](frame.sequence))
