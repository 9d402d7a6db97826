"""The command: files that are whole or not there, exit status, one clear line."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from PIL import Image

import camif_inspect
import pictures
from camif_inspect.command_line import main
from camif_inspect.recording import RecordingReader, RecordingWriter


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


def test_usage_is_one_line_too(capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["save"])
    assert capsys.readouterr().err.count("\n") == 1


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
