"""Against `host-sim stream`: the device's own code, from pixel clocks to packets, over TCP and a pseudo-terminal."""

import base64
import itertools
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import camif_inspect
import pictures
from browser import available, headless, wait_for
from camif_inspect import CommandError, Verdict
from camif_inspect.ask import ask
from camif_inspect.command_line import main
from test_view import CROP

WIDTH, HEIGHT = 96, 64
PROFILE = f"""
[bus]
bits = 8
clock_edge = "rising"
sync = "marker"
hsync_blank = "low"
vsync_blank = "low"
[frame]
width = {WIDTH}
height = {HEIGHT}
format = "rgb888"
[timing]
pclk_hz = 27_648_000
"""


def host_sim():
    """The program: what CAMIF_HOST_SIM names, else the newest that cargo has built."""
    named = os.environ.get("CAMIF_HOST_SIM")
    if named:
        return Path(named).resolve(strict=True)
    target = Path(__file__).parents[2] / "target"
    built = [path for kind in ("release", "debug") if (path := target / kind / "host-sim").exists()]
    return max(built, key=lambda path: path.stat().st_mtime, default=None)


PROGRAM = host_sim()
pytestmark = [
    pytest.mark.device,
    pytest.mark.skipif(PROGRAM is None, reason="no host-sim: cargo build --release -p host-sim"),
]


@pytest.fixture(scope="session")
def truth(tmp_path_factory):
    """The scene, and what each stream makes of it by `host-sim process`."""
    folder = tmp_path_factory.mktemp("scene")
    scene = folder / "scene.png"
    Image.fromarray(pictures.colour(3, WIDTH, HEIGHT)).save(scene)
    (folder / "small.toml").write_text(PROFILE)
    made = {"raw": np.asarray(Image.open(scene))}
    for stream, pipeline in (("edges", "gray|canny"), ("palette", "quantize:median-cut,dither=floyd-steinberg")):
        out = folder / f"{stream}.png"
        subprocess.run([PROGRAM, "process", scene, "--op", pipeline, "-o", out], check=True, stdout=subprocess.DEVNULL)
        made[stream] = np.asarray(Image.open(out).convert("L" if stream == "edges" else "RGB"))
    return folder, made


@pytest.fixture
def play(truth):
    """Starts a device that sees the scene; gives its URL."""
    folder, _ = truth
    running = []

    def start(*arguments):
        command = [PROGRAM, "stream", "--image", "scene.png", "--profile", "small.toml", *arguments]
        command += [] if "--rate" in arguments else ["--rate", "40"]
        running.append(subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True))
        return running[-1].stdout.readline().strip()

    yield start
    for process in running:
        process.send_signal(signal.SIGINT)
    for process in running:
        process.wait(10)
        process.stdout.close()


TCP = ("--tcp", "127.0.0.1:0")


@pytest.mark.parametrize("place", [TCP, ("--pty",)], ids=["tcp", "pty"])
def test_every_stream_is_what_the_scene_makes(play, truth, place):
    _, made = truth
    with camif_inspect.open(play(*place)) as camera:
        seen = set()
        for frame in camera.frames(timeout=60):
            assert frame.whole
            assert frame.verdict is Verdict.GOOD
            assert np.array_equal(frame.rgb, made[frame.name])
            seen.add(frame.name)
            if seen == set(made):
                break
        assert "\n".join(ask(camera, ["ping"])).startswith("answered in ")


@pytest.mark.parametrize("encoding", ["raw", "run-length", "qoi", "auto"])
def test_every_encoding_gives_the_same_picture(play, truth, encoding):
    _, made = truth
    with camif_inspect.open(play(*TCP)) as camera:
        list(ask(camera, ["encoding", "all", encoding]))
        frames = camera.frames(timeout=60)
        for _ in range(6):
            frame = next(frames)
            assert frame.whole
            assert np.array_equal(frame.rgb, made[frame.name])


def test_noise_costs_lines_and_misplaces_none_and_they_come_again(play, truth):
    _, made = truth
    with camif_inspect.open(play(*TCP, "--rate", "2", "--noise", "bits=1e-5,lost=0.02", "--seed", "7")) as camera:
        holes = mended = 0
        for place, frame in enumerate(camera.frames("raw", timeout=60)):
            assert np.array_equal(frame.rgb[frame.present], made["raw"][frame.present])
            assert frame.crc_ok in (None, True)
            if frame.missing.any():
                holes += 1
                try:
                    mended += camera.request_missing(frame, 2) == 0 and np.array_equal(frame.rgb, made["raw"])
                except CommandError:
                    # The frame was given up meanwhile, or every reply was hit.
                    continue
            if place > 3 and mended:
                break
            assert place < 40
        assert holes
        assert camera.receiver.counts.lines_lost


def test_commands_change_what_comes(play, truth):
    _, made = truth
    with camif_inspect.open(play(*TCP)) as camera:
        assert list(ask(camera, ["set", "brightness", "20"])) == ["brightness (levels) = 20 (-255 to 255)"]
        brighter = np.clip(made["raw"].astype(int) + 20, 0, 255)
        frames = itertools.islice(camera.frames("raw", timeout=60), 50)
        assert any(np.array_equal(frame.pixels, brighter) for frame in frames)
        assert list(ask(camera, ["streams", "0"])) == ["on: 0"]
        assert list(ask(camera, ["stop"])) == ["stopped"]
        (line,) = ask(camera, ["read", "CR"])
        assert "CR     0x00" in line
        with pytest.raises(CommandError, match="no such register"):
            list(ask(camera, ["read", "0x3c"]))
        with pytest.raises(CommandError, match="cany"):
            list(ask(camera, ["stages", "1", "gray|cany"]))


def test_a_device_that_ends_is_waited_for_and_found_again(play):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
    url = play("--tcp", address, "--frames", "6")
    with camif_inspect.open(url) as camera:
        frames = camera.frames("raw", timeout=60)
        assert next(frames).whole
        session = camera.receiver.session
        while camera.trouble is None:
            time.sleep(0.05)
        assert any("is gone" in text and "waiting" in text for _, _, text in camera.log)
        play("--tcp", address)
        assert next(frame for frame in frames if camera.receiver.session != session).whole


def test_save_record_and_play(play, truth, tmp_path, capsys):
    _, made = truth
    url = play(*TCP)
    assert main(["save", url, "-n", "2", "--stream", "raw", "-o", str(tmp_path / "saved"), "--json"]) == 0
    for frame in json.loads(capsys.readouterr().out)["frames"]:
        png, raw = frame["files"]
        assert np.array_equal(np.asarray(Image.open(png)), made["raw"])
        assert Path(raw).read_bytes() == made["raw"].tobytes()
    recording = tmp_path / "run.camr"
    assert main(["record", url, "-o", str(recording), "--seconds", "2"]) == 0
    frames = list(camif_inspect.open(recording))
    assert sum(frame.whole for frame in frames) > 3
    for frame in frames:
        assert np.array_equal(frame.rgb[frame.present], list(made.values())[frame.stream][frame.present])


@pytest.mark.browser
def test_the_page_shows_the_scene_and_its_button_stops_the_device(play, truth, tmp_path):
    if not available():
        pytest.skip("no browser test: chromium and chromedriver are not installed")
    _, made = truth
    command = [sys.executable, "-m", "camif_inspect", "view", play(*TCP), "--no-browser", "--port", "0"]
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as view,
        headless(tmp_path / "profile", 1280, 800) as driver,
    ):
        try:
            driver.get(view.stdout.readline().strip())
            wait_for(driver, "inspector.pictures().length == 3", 60)
            wait_for(driver, "document.querySelector('.verdict').textContent == 'good'", 60)
            driver.execute_script("document.getElementById('stop').click()")
            wait_for(driver, "document.querySelectorAll('.view.old').length == 3", 60)
            driver.execute_script("inspector.look.scale = 2")
            time.sleep(0.3)
            for place, expected in enumerate(made.values()):
                _, _, url = driver.execute_script(CROP, place)
                path = tmp_path / "seen.png"
                path.write_bytes(base64.b64decode(url.split(",")[1]))
                seen = np.asarray(Image.open(path).convert("RGB" if expected.ndim == 3 else "L"))
                assert np.array_equal(seen, expected.repeat(2, axis=0).repeat(2, axis=1))
        finally:
            view.terminate()
