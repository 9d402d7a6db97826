"""A device on TCP and on a pseudo-terminal: frames, commands, ports that vanish, and other versions."""

import contextlib
import os
import pty
import socket
import struct
import threading
import time
import tty
from unittest import mock

import numpy as np
import pytest
from cobs import cobs

import camif_inspect
import device as devices
import pictures
from camif_inspect import Command, CommandError, InspectError, PortError, Verdict
from camif_inspect.ask import ask
from camif_inspect.port import Chunk, SerialSource
from camif_inspect.recording import FROM_DEVICE, RecordingReader, RecordingWriter
from camif_inspect.session import Session


def wait_for(condition, seconds=10):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "it did not come"
        time.sleep(0.01)


@pytest.mark.parametrize("channel", ["on_tcp", "on_pty"])
def test_frames_are_numpy_arrays_with_their_verdicts(channel):
    made = devices.Device([("raw", devices.RGB888, 0, pictures.colour), ("edges", devices.GRAY8, 3, pictures.edges)])
    with made, camif_inspect.open(getattr(made, channel)()) as camera:
        seen = set()
        for frame in camera:
            truth = pictures.colour if frame.stream == 0 else pictures.edges
            assert frame.verdict is Verdict.GOOD
            assert frame.missing_lines == []
            assert frame.whole
            assert np.array_equal(frame.pixels, truth(frame.sequence))
            seen.add(frame.name)
            if seen == {"raw", "edges"}:
                break
        assert "\n".join(ask(camera, ["ping"])).startswith("answered in ")


def test_frames_of_one_stream_by_name(device):
    with camif_inspect.open(device.url) as camera:
        frames = camera.frames("edges")
        assert [next(frames).stream for _ in range(3)] == [1, 1, 1]


def test_lost_lines_are_marked_and_sent_again_on_request(device):
    device.lose = {(number, line) for number in range(1, 100) for line in (3, 4, 20)}
    with camif_inspect.open(device.url) as camera:
        frame = next(camera.frames("raw"))
        truth = pictures.colour(frame.sequence)
        assert frame.missing_lines == [3, 4, 20]
        assert frame.crc_ok is None
        assert not frame.pixels[3].any()
        assert np.array_equal(frame.pixels[frame.present], truth[frame.present])
        assert (frame.marked()[3, 0] == [255, 0, 255]).all()
        device.interval = 0.5
        assert camera.request_missing(frame) == 0
        assert frame.whole
        assert np.array_equal(frame.pixels, truth)


def test_a_port_that_vanishes_is_reported_and_waited_for(device):
    with camif_inspect.open(device.url) as camera:
        frames = camera.frames("raw", timeout=20)
        first = next(frames)
        device.hang_up()
        wait_for(lambda: camera.reconnects == 1)
        assert any("is gone" in text and "waiting" in text for _, _, text in camera.log)
        assert next(frame for frame in frames if frame.sequence > first.sequence + 1).whole


def test_a_port_that_is_not_there_is_an_error_or_waited_for():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"socket://127.0.0.1:{taken.getsockname()[1]}"
    with pytest.raises(PortError, match="cannot open socket://.*refused"):
        camif_inspect.open(url)
    with pytest.raises(PortError, match="cannot open /dev/nothing-here: no such file"):
        camif_inspect.open("/dev/nothing-here")
    made = devices.Device([("raw", devices.RGB888, 0, pictures.colour)])
    with camif_inspect.open(url, wait=True) as camera, made:
        assert camera.trouble
        made._listener = socket.create_server(("127.0.0.1", int(url.rsplit(":", 1)[1])))
        made._listener.settimeout(0.1)
        made._start(made._serve_tcp)
        assert next(camera.frames(timeout=20)).whole


def test_a_device_of_another_version_is_told_from_noise(device):
    device.version = 3
    with camif_inspect.open(device.url) as camera:
        device.running = False
        with pytest.raises(InspectError, match="speaks version .*3 of the protocol.*update this program"):
            next(camera.frames(timeout=1))


def test_a_device_of_another_version_gets_no_command_and_it_is_said_why(device):
    device.version, device.running = 3, False
    with camif_inspect.open(device.url) as camera:
        with pytest.raises(CommandError, match="no reply to PING .*speaks version 3 of .*update this program"):
            camera.command(Command.PING, timeout=0.3)


def test_a_port_that_another_program_has_open_is_not_shared_with_it():
    controller, terminal = pty.openpty()
    try:
        with camif_inspect.open(os.ttyname(terminal)):
            with pytest.raises(PortError, match="cannot open /dev/pts/.*: another program has it open"):
                camif_inspect.open(os.ttyname(terminal))
        camif_inspect.open(os.ttyname(terminal)).close()
    finally:
        os.close(controller)
        os.close(terminal)


def test_no_frame_of_a_stream_is_told_with_the_reason(device):
    with camif_inspect.open(device.url) as camera:
        assert camera.introduced(10)
        with pytest.raises(InspectError, match=r"no frame of stream sides .*: the device has 0 \(raw\), 1 \(edges\)"):
            next(camera.frames("sides", timeout=0.3))
        assert list(ask(camera, ["streams", "0"])) == ["on: 0"]
        wait_for(lambda: not camera.receiver.streams[1].info.on)
        with pytest.raises(InspectError, match="no frame of stream edges for .*it is off; turn it on"):
            next(camera.frames("edges", timeout=0.3))


def test_noise_is_told_for_what_it_is():
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def babble():
            connection, _ = listener.accept()
            rng = np.random.default_rng(1)
            connection.sendall(rng.integers(0, 256, 60_000, dtype=np.uint8).tobytes())
            time.sleep(2)

        threading.Thread(target=babble, daemon=True).start()
        url = f"socket://127.0.0.1:{listener.getsockname()[1]}"
        with camif_inspect.open(url) as camera:
            with pytest.raises(InspectError, match="60,000 bytes came and no packet: no camif device"):
                next(camera.frames(timeout=0.8))
            assert camera.noisy


def test_commands_are_carried_out_once_though_replies_get_lost(device):
    with camif_inspect.open(device.url) as camera:
        real = camera.source.write
        wires = []

        def twice(data):
            # As if the first reply had been lost and the command been sent again.
            wires.append(data)
            real(data)
            real(data)

        wait_for(lambda: device.commands)
        camera.source.write = twice
        assert list(ask(camera, ["set", "gain", "0x20"])) == ["gain = 32 (0 to 255)"]
        assert [command for command, _ in device.commands] == [1] + [9] * 3 + [8]


def test_a_device_that_does_not_answer_is_asked_again_and_then_given_up():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        heard = bytearray()

        def listen():
            connection, _ = listener.accept()
            while data := connection.recv(1000):
                heard.extend(data)

        threading.Thread(target=listen, daemon=True).start()
        with camif_inspect.open(f"socket://127.0.0.1:{listener.getsockname()[1]}") as camera:
            with pytest.raises(CommandError, match="no reply to START from socket://.*asked 4 times"):
                camera.command(2, timeout=0.1)
        asked = [piece for piece in bytes(heard).split(b"\0") if piece]
        kinds = [cobs.decode(piece)[6] for piece in asked]
        assert kinds == [1] * 2 + [2] * 4
        assert len(set(asked)) == 2


def test_a_reply_behind_much_that_waits_is_waited_for():
    """A busy machine reads slowly: what the device sent before its reply takes longer than all four attempts."""
    before = devices.wire(devices.link.log(3, 0, 0, 5, "x" * 200)) * 200
    replied = threading.Event()

    def talk(listener):
        connection, _ = listener.accept()
        heard = b""
        while b"\0" not in heard[1:]:
            heard += connection.recv(1000)
        request, command = struct.unpack_from("<HB", cobs.decode(heard.strip(b"\0").split(b"\0")[0]), 4)
        connection.sendall(before + devices.wire(devices.link.reply(request, command, 0, b"late")))
        replied.set()
        while connection.recv(1000):
            pass

    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=talk, args=(listener,), daemon=True).start()
        source = SerialSource(f"socket://127.0.0.1:{listener.getsockname()[1]}")
        quick, source._read = source._read, lambda: (replied.wait(10) and time.sleep(0.005)) or quick()
        with mock.patch("camif_inspect.port._READ_BYTES", 500), mock.patch.object(Session, "_greet"):
            with Session(source) as camera:
                assert camera.command(Command.PING, timeout=0.05).rest == b"late"
                assert camera.receiver.counts.bytes > len(before)


ANSWERS = [
    (["stop"], ["stopped"]),
    (["start"], ["started"]),
    (["snapshot", "2"], ["captures 2 frames"]),
    (["streams", "1"], ["on: 1"]),
    (["streams", "all"], ["on: 0, 1"]),
    (["encoding", "0", "qoi"], ["stream 0: qoi"]),
    (["stages", "1", "gray|canny:low=50,high=150"], ["stream 1: gray|canny:low=50,high=150"]),
    (["get"], ["exposure = 100 (1 to 1000)", "gain = 16 (0 to 255)"]),
    (["get", "gain"], ["gain = 16 (0 to 255)"]),
    (["set", "0", "250"], ["exposure = 250 (1 to 1000)"]),
    (["read", "CR"], ["CR     0x00 = 0x000040e3  CAPTURE CM=snapshot PCKPOL=rising HSPOL=high VSPOL=high ENABLE"]),
    (["write", "IER", "0x3"], ["IER    0x0c = 0x00000003  FRAME OVR"]),
]


@pytest.mark.parametrize(("request_", "answer"), ANSWERS, ids=lambda value: " ".join(value[:2]))
def test_requests_and_their_answers(device, request_, answer):
    with camif_inspect.open(device.url) as camera:
        if request_ == ["streams", "all"]:
            wait_for(lambda: camera.receiver.hello is not None)
        assert list(ask(camera, request_)) == answer


REFUSALS = [
    (["jump"], "`jump` is no request; there are ping"),
    (["snapshot", "0"], "the number of frames is 1 to 65535, not 0"),
    (["stages", "0", "cany"], "finds an argument out of range: no stage `cany`; is it `canny`"),
    (["encoding", "0", "zip"], "`zip` is no encoding; there are raw"),
    (["set", "gain", "999"], "gain is 0 to 255"),
    (["set", "focus", "1"], "has no parameter `focus`; it has exposure, gain"),
    (["read", "0x34"], "has no such register"),
    (["read", "CR", "x"], "the number of registers is a number"),
    (["start", "now"], "start takes 0 arguments"),
]


@pytest.mark.parametrize(("request_", "words"), REFUSALS, ids=lambda value: value if isinstance(value, str) else "")
def test_refusals_are_one_clear_line(device, request_, words):
    with camif_inspect.open(device.url) as camera, pytest.raises(CommandError, match=".") as error:
        list(ask(camera, request_))
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("channel", ["tcp", "pty"])
def test_what_a_device_said_before_the_port_was_opened_is_heard(channel):
    """Such as the only HELLO of a device that takes no commands."""
    said = b"".join(devices.wire(body) for body in (devices.link.hello(9, "early"), devices.link.log(3, 0, 0, 5, "up")))
    with contextlib.ExitStack() as stack:
        if channel == "tcp":
            listener = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
            url = f"socket://127.0.0.1:{listener.getsockname()[1]}"
            talker = threading.Thread(target=lambda: listener.accept()[0].sendall(said) or time.sleep(1), daemon=True)
            talker.start()
        else:
            controller, terminal = pty.openpty()
            stack.callback(os.close, controller)
            stack.callback(os.close, terminal)
            tty.setraw(terminal)
            os.write(controller, said)
            url = os.ttyname(terminal)
        with camif_inspect.open(url) as camera:
            wait_for(lambda: any(text == "up" for _, _, text in camera.log))
            assert camera.receiver.hello.name == "early"


def test_a_device_introduces_itself_or_does_not(device):
    with camif_inspect.open(device.url) as camera:
        assert camera.introduced(10)
        assert camera.receiver.hello.name == device.name
        assert [stream.name for stream in camera.receiver.streams.values()] == ["raw", "edges"]
    with socket.create_server(("127.0.0.1", 0)) as mute:
        with camif_inspect.open(f"socket://127.0.0.1:{mute.getsockname()[1]}") as camera:
            assert not camera.introduced(0.2)


def test_who_is_there_is_asked_at_once_and_after_every_loss(device):
    with camif_inspect.open(device.url) as camera:
        wait_for(lambda: [command for command, _ in device.commands] == [1])
        wait_for(lambda: camera.receiver.hello is not None)
        device.hang_up()
        wait_for(lambda: [command for command, _ in device.commands] == [1, 1])
    assert sum("protocol version 1" in text for _, _, text in camera.log) == 1


class AtOnce:
    """A port whose device speaks the moment it is opened, and hears nothing."""

    name, live = "at once", True

    def __init__(self, data):
        """Speak once."""
        self.waiting = data
        self.read_once = threading.Event()

    def open(self):
        """Do nothing."""

    def read(self):
        """Give all of it, then nothing."""
        data, self.waiting = self.waiting, b""
        if not data:
            self.read_once.set()
            time.sleep(0.01)
        return Chunk(self.now(), data)

    def write(self, _):
        """Be deaf, and slow to say so: by then all has been read."""
        assert self.read_once.wait(10)

    def now(self):
        """Give the clock."""
        return time.monotonic()

    def close(self):
        """Do nothing."""


def test_a_recording_has_what_the_device_said_first(tmp_path):
    path = tmp_path / "run.camr"
    with path.open("wb") as file, Session(AtOnce(b"said at once\0"), recorder=RecordingWriter(file)):
        pass
    heard = b"".join(record.data for record in RecordingReader(path) if record.direction == FROM_DEVICE)
    assert heard == b"said at once\0"
