"""The live view: who may talk to it, and what a person sees in a real browser."""

import asyncio
import base64
import contextlib
import json
import shutil
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

import pictures


@pytest.fixture
def view(device, tmp_path):
    command = [sys.executable, "-m", "camif_inspect", "view", device.url, "--no-browser", "--port", "0"]
    command += ["--save-to", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        yield process.stdout.readline().strip()
        process.terminate()
        assert process.wait(10) == 0


def get(url, **headers):
    return urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=5)


def test_the_page_is_served_and_nothing_else(view):
    with get(view) as page:
        assert b"camif" in page.read()
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
    for path in ("fonts/ibm-plex-sans.woff2", "style.css", "main.js"):
        with get(view + path) as file:
            assert file.read()
    for path in ("../server.py", "%2e%2e/server.py", "fonts/LICENSE"):
        with pytest.raises(urllib.error.HTTPError, match="404"):
            get(view + path)


def test_only_its_own_page_may_listen(view):
    with pytest.raises(urllib.error.HTTPError, match="403"):
        get(view, Host="evil.example")
    address = view.replace("http", "ws") + "live"

    async def listen(origin):
        async with connect(address, origin=origin) as socket:
            return json.loads(await socket.recv())

    assert asyncio.run(listen(view.rstrip("/")))["type"] == "welcome"
    for origin in ("http://evil.example", None):
        with pytest.raises(InvalidStatus, match="403"):
            asyncio.run(listen(origin))


@pytest.fixture
def browser(tmp_path):
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("no browser test: chromium and chromedriver are not installed")
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    flags = "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking"
    for flag in [*flags.split(), "disable-component-update", "disable-sync", f"user-data-dir={tmp_path / 'profile'}"]:
        options.add_argument(f"--{flag}")
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": False}
    )
    try:
        yield driver
    finally:
        with contextlib.suppress(Exception):
            driver.quit()


def wait_for(browser, script, seconds=20):
    until = time.monotonic() + seconds
    while not (value := browser.execute_script(f"return {script}")):
        assert time.monotonic() < until, script
        time.sleep(0.05)
    return value


CROP = """
const entry = inspector.pictures()[arguments[0]], {left, top, scale} = entry.view.place();
const {width, height, sequence} = entry.picture.head, out = document.createElement("canvas");
out.width = width * scale; out.height = height * scale;
out.getContext("2d").drawImage(entry.view.canvas, left, top, out.width, out.height, 0, 0, out.width, out.height);
return [sequence, scale, out.toDataURL("image/png")];
"""


@pytest.mark.browser
def test_a_browser_shows_the_right_picture_and_commands_the_device(view, browser, device, tmp_path):
    browser.get(view)
    wait_for(browser, "inspector.pictures().length == 2")
    wait_for(browser, "document.querySelector('.verdict').textContent == 'good'")
    browser.execute_script("document.getElementById('stop').click()")
    wait_for(browser, "document.getElementById('link-state').textContent == 'stopped'")
    wait_for(browser, "document.querySelectorAll('.view.old').length == 2")
    assert any(command == 3 for command, _ in device.commands)
    # At two screen pixels a pixel, what is on the screen is the picture, to the pixel.
    browser.execute_script("inspector.look.scale = 2")
    time.sleep(0.3)
    for place, truth in enumerate((pictures.colour, pictures.edges)):
        sequence, scale, url = browser.execute_script(CROP, place)
        assert scale == 2
        path = tmp_path / "seen.png"
        path.write_bytes(base64.b64decode(url.split(",")[1]))
        expected = truth(sequence)
        seen = np.asarray(Image.open(path).convert("RGB" if expected.ndim == 3 else "L"))
        assert np.array_equal(seen, expected.repeat(2, axis=0).repeat(2, axis=1))
    browser.execute_script("document.getElementById('registers-read').click()")
    wait_for(browser, "document.querySelector('#register-list td:nth-child(3)').textContent == '000040E3'")
    browser.execute_script("document.getElementById('save').click()")
    wait_for(browser, "document.getElementById('toast').textContent.startsWith('saved 4 files')")
    saved = next(Path(tmp_path).glob("raw-*.png"))
    assert np.array_equal(np.asarray(Image.open(saved)), pictures.colour(int(saved.stem.split("-")[1])))
    browser.execute_script("document.getElementById('start').click()")
    wait_for(browser, "document.getElementById('link-state').textContent == 'live'")
