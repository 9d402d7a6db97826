"""The command: files that are whole or not there, exit status, one clear line."""

import errno
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from PIL import Image

import camif_inspect
import device as devices
import pictures
from camif_inspect.command_line import main
from camif_inspect.recording import RecordingReader, RecordingWriter
from camif_inspect.session import Session


def test_save_writes_png_and_raw(device, tmp_path, capsys):
    assert main(["save", device.url, "-n", "3", "--stream", "raw", "-o", str(tmp_path), "--json"]) == 0
    frames = json.loads(capsys.readouterr().out)["frames"]
    assert len(frames) == 3
    for frame in frames:
        truth = pictures.colour(frame["sequence"])
        png, raw = frame["files"]
        assert np.array_equal(np.asarray(Image.open(png)), truth)
        assert (tmp_path / raw).read_bytes() == truth.tobytes()
        assert (frame["verdict"], frame["whole"]) == ("good", True)
    assert len(list(tmp_path.iterdir())) == 6


def test_save_to_one_file(device, tmp_path):
    path = tmp_path / "deep" / "edges.png"
    assert main(["save", device.url, "--stream", "edges", "-o", str(path)]) == 0
    assert Image.open(path).mode == "L"
    assert main(["save", device.url, "-n", "2", "-o", str(path)]) == 2


def test_a_frame_with_lost_lines_is_mended_or_marked(device, tmp_path):
    device.lose = {(number, 5) for number in range(1, 1000)}
    path = tmp_path / "a.png"
    assert main(["save", device.url, "--stream", "raw", "-o", str(path)]) == 0
    assert main(["save", device.url, "--stream", "raw", "-o", str(path), "--no-resend"]) == 1
    picture = np.asarray(Image.open(path))
    assert picture[5, 0].tolist() == [255, 0, 255]


def test_record_play_and_save_again(device, tmp_path, capsys):
    recording = tmp_path / "run.camr"
    assert main(["record", device.url, "-o", str(recording), "--seconds", "0.6"]) == 0
    reader = RecordingReader(recording)
    times = [record.time for record in reader]
    assert times == sorted(times)
    assert times[-1] < 1.5
    whole = [frame for frame in camif_inspect.open(recording) if frame.whole]
    assert len(whole) >= 4
    for frame in whole:
        truth = pictures.colour if frame.stream == 0 else pictures.edges
        assert np.array_equal(frame.pixels, truth(frame.sequence))
    capsys.readouterr()
    assert main(["stats", str(recording), "--json"]) == 0
    counts = json.loads(capsys.readouterr().out)["counts"]
    assert counts["frames_whole"] == len(whole)
    assert counts["damaged"] == 0


@pytest.mark.parametrize("place", ["tcp:127.0.0.1:0", "pty"])
def test_a_recording_plays_as_a_device(device, tmp_path, place):
    recording = tmp_path / "run.camr"
    assert main(["record", device.url, "-o", str(recording), "--seconds", "0.5"]) == 0
    expected = sum(frame.whole for frame in camif_inspect.open(recording))
    command = [sys.executable, "-m", "camif_inspect", "play", str(recording), "--to", place, "--speed", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as player:
        url = player.stdout.readline().strip()
        with camif_inspect.open(url) as camera:
            until = time.monotonic() + 10
            while camera.receiver.counts.frames_whole < expected and time.monotonic() < until:
                time.sleep(0.02)
            assert camera.receiver.counts.frames_whole == expected
        player.communicate(timeout=10)


def heeding_ctrl_c() -> None:
    """A script's background job ignores SIGINT, and so would all that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_ctrl_c_leaves_a_whole_recording(device, tmp_path):
    recording = tmp_path / "run.camr"
    command = [sys.executable, "-m", "camif_inspect", "record", device.url, "-o", str(recording)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, preexec_fn=heeding_ctrl_c) as recorder:
        until = time.monotonic() + 10
        while not list(tmp_path.glob(".run.camr.*.part")) and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(0.7)
        assert not recording.exists()
        os.kill(recorder.pid, signal.SIGINT)
        assert recorder.wait(10) == 0
    assert sum(frame.whole for frame in camif_inspect.open(recording)) > 0
    assert [path.name for path in tmp_path.iterdir()] == ["run.camr"]


def test_ctrl_c_while_saving_leaves_nothing_half_written(device, tmp_path):
    device.interval = 0.02
    command = [sys.executable, "-m", "camif_inspect", "save", device.url, "-n", "100000", "-o", str(tmp_path)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stderr=pipe, stdout=pipe, preexec_fn=heeding_ctrl_c) as saver:
        until = time.monotonic() + 10
        while len(list(tmp_path.glob("*.png"))) < 5 and time.monotonic() < until:
            time.sleep(0.02)
        os.kill(saver.pid, signal.SIGINT)
        assert saver.wait(10) == 130
    assert not list(tmp_path.glob(".*"))
    for path in tmp_path.glob("*.png"):
        Image.open(path).load()


def test_a_recording_cut_short_is_read_up_to_there(tmp_path):
    path = tmp_path / "cut.camr"
    with path.open("wb") as file:
        writer = RecordingWriter(file)
        writer.write(0.5, b"one")
        writer.write(0.7, b"two")
    path.write_bytes(path.read_bytes()[:-1])
    assert [record.data for record in RecordingReader(path)] == [b"one"]


CASES = [
    (["view"], "view shows either a URL or, with --play, a recording"),
    (["save", "/dev/nothing-here"], "cannot open /dev/nothing-here: no such file or directory"),
    (["stats", "socket://nohost"], "cannot open socket://nohost"),
    (["play", "{text}"], "is no recording: it does not start with CAMIFREC"),
    (["stats", "{text}"], "is a file but no recording"),
    (["stats", "{later}"], "is a recording of version 9; this program reads version 1"),
    (["play", "{empty}", "--to", "udp:1"], "`udp:1` is neither tcp:HOST:PORT nor pty"),
    (["view", "--play", "nothing.camr"], "cannot read nothing.camr: No such file"),
    (["view", "socket://localhost"], "cannot open socket://localhost: write socket://HOST:PORT"),
    (["view", "socket://localhost:70000"], "cannot open socket://localhost:70000: write socket://HOST:PORT"),
    (["view", "socket://:7000"], "cannot open socket://:7000: write socket://HOST:PORT"),
    (["view", "sokcet://localhost:7000"], "cannot open sokcet://localhost:7000: invalid URL, protocol 'sokcet'"),
    (["stats", "/dev/null"], "cannot open /dev/null: it is no serial port"),
    (["record", "{empty}", "-o", "."], "cannot write .: it is a directory; name a file"),
    (["record", "{empty}", "-o", "{text}/a.camr"], "text is no directory"),
    (["save", "{empty}", "-o", "picture.jpg"], "picture.jpg: a picture is written as .png, or its bytes as .raw"),
    (["save", "{empty}", "-o", "a.png", "--kind", "raw"], "a.png is a .png file, and --kind asks for raw"),
]


@pytest.mark.parametrize(("arguments", "words"), CASES, ids=lambda value: value if isinstance(value, str) else "")
def test_bad_input_gets_one_clear_line(tmp_path, capsys, arguments, words):
    text, later, empty = (tmp_path / name for name in ("text", "later", "empty"))
    text.write_text("hello")
    later.write_bytes(b"CAMIFREC" + bytes([9, 0, 0, 0]) + bytes(12))
    with empty.open("wb") as file:
        RecordingWriter(file)
    assert main([part.format(text=text, later=later, empty=empty) for part in arguments]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert re.fullmatch(r"camif-inspect: [^\n]+\n", error)


USAGE = [
    (["save"], "the following arguments are required: URL"),
    (["stats", "x", "--seconds", "-1"], "--seconds: it takes a number above zero, not `-1`"),
    (["record", "x", "-o", "y", "--seconds", "nan"], "--seconds: it takes a number above zero, not `nan`"),
    (["play", "x", "--speed", "-1"], "--speed: it takes zero or a number above zero, not `-1`"),
    (["save", "x", "-n", "0"], "-n/--frames: it takes a whole number from 1 on, not `0`"),
    (["view", "x", "--port", "70000"], "--port: it takes a whole number from 0 to 65535, not `70000`"),
    (["command", "x", "ping", "--block", "256"], "--block: it takes a whole number from 0 to 255, not `256`"),
    (["stats", "x", "--baud", "fast"], "--baud: it takes a whole number from 1 on, not `fast`"),
]


@pytest.mark.parametrize(("arguments", "words"), USAGE, ids=lambda value: value if isinstance(value, str) else "")
def test_usage_is_one_line_too(capsys, arguments, words):
    with pytest.raises(SystemExit, match="2"):
        main(arguments)
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_a_request_that_makes_no_sense_is_bad_usage_and_a_refusal_is_not(device, capsys):
    for request, status in ((["jump"], 2), (["read"], 2), (["snapshot", "0"], 2), (["read", "0x99"], 1)):
        assert main(["command", device.url, *request]) == status
    assert main(["command", device.url, "stages", "0", "gray|" * 110 + "gray"]) == 2
    assert "a command of 558 bytes is too long: the device takes 500" in capsys.readouterr().err


def test_paths_with_brackets_are_only_paths(device, tmp_path, capsys):
    recording = tmp_path / "[red]run[/red].camr"
    assert main(["record", device.url, "-o", str(recording), "--seconds", "0.3"]) == 0
    assert recording.exists()
    assert "[red]run[/red].camr" in capsys.readouterr().err


class FullDisk:
    """A file that takes so many bytes, and then no more."""

    def __init__(self, room):
        """Have room for `room` bytes."""
        self.data = b""
        self.room = room

    def write(self, data):
        """Take what there is room for, as the system does."""
        taken = bytes(data[: self.room - len(self.data)])
        if not taken:
            raise OSError(errno.ENOSPC, "No space left on device")
        self.data += taken
        return len(taken)


def test_a_full_disk_ends_a_recording_that_is_good_up_to_there(tmp_path):
    file = FullDisk(24 + 2 * (16 + 5) + 18)
    writer = RecordingWriter(file)
    for at in range(5):
        writer.write(at, b"12345")
    assert writer.failure.errno == errno.ENOSPC
    assert writer.bytes_written == 10
    path = tmp_path / "full.camr"
    path.write_bytes(file.data)
    reader = RecordingReader(path)
    assert [record.data for record in reader] == [b"12345"] * 2
    assert reader.cut_short


def test_a_full_disk_is_one_clear_line(device, tmp_path, capsys, monkeypatch):
    def full(self, at, data, direction=0):  # noqa: ARG001
        self.failure = OSError(errno.ENOSPC, "No space left on device")

    def no_room(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    recording = tmp_path / "run.camr"
    with monkeypatch.context() as patch:
        patch.setattr(RecordingWriter, "write", full)
        assert main(["record", device.url, "-o", str(recording)]) == 2
    assert "run.camr ends early, but is good up to there: No space left on device" in capsys.readouterr().err
    assert list(RecordingReader(recording)) == []
    monkeypatch.setattr(Image.Image, "save", no_room)
    assert main(["save", device.url, "-o", str(tmp_path / "a.png")]) == 2
    assert re.search(r"^camif-inspect: cannot write \S+a.png: No space left on device$", capsys.readouterr().err, re.M)
    assert [path.name for path in tmp_path.iterdir()] == ["run.camr"]


def test_what_is_cut_short_is_said(device, tmp_path, capsys, monkeypatch):
    path = tmp_path / "run.camr"
    assert main(["record", device.url, "-o", str(path), "--seconds", "0.5"]) == 0
    path.write_bytes(path.read_bytes()[:-1])
    assert main(["stats", str(path)]) == 0
    told = "run.camr is at its end, cut short within a record"
    assert told in capsys.readouterr().err

    # Read to its end before anybody has looked what there is to be told.
    start = Session.start
    monkeypatch.setattr(Session, "start", lambda session: (start(session), session.ended.wait(10)))
    for command in (["stats", str(path)], ["save", str(path), "-o", str(tmp_path / "all"), "--frames", "1000"]):
        main(command)
        assert told in capsys.readouterr().err, command


def test_a_port_that_is_not_there_yet_is_waited_for(capsys):
    made = devices.Device([("raw", devices.RGB888, devices.RAW, pictures.colour)])
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]

    def appear():
        made._listener = socket.create_server(("127.0.0.1", port))
        made._listener.settimeout(0.1)
        made._start(made._serve_tcp)

    with made:
        threading.Timer(0.5, appear).start()
        assert main(["command", f"socket://127.0.0.1:{port}", "--wait", "ping"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("answered in ")
    assert "refused; waiting for it" in told.err


def test_stats_and_command(device, capsys):
    assert main(["stats", device.url, "--seconds", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["bytes_per_second"] > 1000
    assert [stream["name"] for stream in told["streams"]] == ["raw", "edges"]
    assert told["device"]["state"] == "running"
    assert main(["command", device.url, "stop"]) == 0
    assert capsys.readouterr().out == "stopped\n"
    assert main(["command", device.url, "read", "0x99"]) == 1
    assert "has no such register" in capsys.readouterr().err


def test_no_thread_is_left(device):
    before = threading.active_count()
    with camif_inspect.open(device.url) as camera:
        next(camera.frames())
    assert not any(thread.name == "camif-inspect listener" for thread in threading.enumerate())
    assert threading.active_count() <= before + 3
