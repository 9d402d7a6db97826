"""The live view: who may talk to it, and what a person sees in a real browser."""

import asyncio
import base64
import json
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from selenium.webdriver import ActionChains, Keys
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

import pictures
from browser import available, headless, resize, wait_for


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


def ask_all(view, questions):
    """Ask as the page does; gives the answers by their questions' numbers."""

    async def talk():
        async with connect(view.replace("http", "ws") + "live", origin=view.rstrip("/"), max_size=None) as page:
            answers = {}
            for number, question in enumerate(questions):
                await page.send(json.dumps({"id": number, **question}))
            while len(answers) < len(questions):
                message = await asyncio.wait_for(page.recv(), 20)
                if isinstance(message, str) and (told := json.loads(message))["type"] == "answer":
                    answers[told["id"]] = told
            return answers

    return asyncio.run(talk())


def test_every_question_is_answered_whatever_it_is(view):
    questions = [
        {"do": "jump"},
        {},
        {"do": "ask", "request": ["read", "0"], "block": 300},
        {"do": "write", "offset": 1e400, "value": 0},
        {"do": "read", "offsets": [1 << 40]},
        {"do": "set", "parameter": 1 << 40, "value": 1},
        {"do": "ask", "request": ["stages", "0", "gray|" * 200]},
    ]
    questions += [{"do": "read", "offsets": [0]}] * 40
    answers = ask_all(view, questions)
    assert not any(answers[number]["ok"] for number in range(7))
    assert all(answers[number].get("text") for number in range(7))
    assert all(answers[number]["ok"] for number in range(7, len(questions)))


def test_ctrl_c_does_not_wait_for_a_device_that_does_not_answer():
    with socket.create_server(("127.0.0.1", 0)) as mute:
        url = f"socket://127.0.0.1:{mute.getsockname()[1]}"
        command = [sys.executable, "-m", "camif_inspect", "view", url, "--no-browser", "--port", "0"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
            view = process.stdout.readline().strip()

            async def ask_and_leave():
                async with connect(view.replace("http", "ws") + "live", origin=view.rstrip("/")) as page:
                    for number in range(30):
                        await page.send(json.dumps({"id": number, "do": "ask", "request": ["ping"]}))
                    await asyncio.sleep(0.3)

            asyncio.run(ask_and_leave())
            process.terminate()
            assert process.wait(4) == 0


@pytest.fixture
def browser(tmp_path):
    if not available():
        pytest.skip("no browser test: chromium and chromedriver are not installed")
    with headless(tmp_path / "profile", 1280, 800) as driver:
        yield driver


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


CUT = """
const cut = [];
for (const element of document.querySelectorAll("h1, h2, button, dt, dd, label, .now *, .fields *, .register-head *")) {
  const box = element.getBoundingClientRect();
  if (box.width && element.scrollWidth > element.clientWidth + 1 && element.clientWidth) cut.push(element.textContent);
}
const over = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
  && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
const laps = [];
for (const group of ["#stage, aside, #dock", ".plot", "aside .panel", "#dock .panel", "header > *"]) {
  const parts = [...document.querySelectorAll(group)].map((part) => part.getBoundingClientRect());
  parts.forEach((a, i) => parts.slice(i + 1).forEach((b) => over(a, b) && laps.push(group)));
}
return [cut, laps, document.documentElement.scrollWidth <= innerWidth];
"""


@pytest.mark.browser
def test_nothing_is_cut_or_lies_on_another_in_any_window(view, browser):
    browser.get(view)
    wait_for(browser, "inspector.pictures().length == 2")
    browser.execute_script("document.getElementById('registers-read').click()")
    wait_for(browser, "document.querySelector('#register-list td:nth-child(3)').textContent == '000040E3'")
    for size in ((1280, 800), (1600, 1000), (1920, 1080), (900, 800), (420, 900)):
        resize(browser, *size)
        time.sleep(0.3)
        cut, laps, fits = browser.execute_script(CUT)
        assert (size, cut, laps, fits) == (size, [], [], True)


@pytest.mark.browser
def test_a_command_in_words_is_answered_in_the_log(view, browser, device):
    browser.get(view)
    wait_for(browser, "inspector.pictures().length == 2")
    say = "document.getElementById('ask-words').value = arguments[0]; document.querySelector('#ask button').click()"
    browser.execute_script(say, "stages 1 'gray|canny:low=50, high=150'")
    wait_for(browser, "document.getElementById('log').textContent.includes('stream 1: gray|canny:low=50, high=150')")
    assert device.pipelines[1] == "gray|canny:low=50, high=150"
    browser.execute_script(say, "jump")
    wait_for(browser, "document.querySelector('#log .error').textContent.includes('`jump` is no request')")


@pytest.mark.browser
def test_the_keyboard_moves_pictures_flips_bits_and_shifts_the_divider(view, browser):
    keys = ActionChains(browser)
    browser.get(view)
    wait_for(browser, "inspector.pictures().length == 2")
    browser.execute_script("document.getElementById('registers-read').click()")
    wait_for(browser, "document.querySelector('#register-list td:nth-child(3)').textContent == '000040E3'")
    # The bit that was flipped keeps the focus, so that a blank flips it back and does not pause the picture.
    browser.execute_script("document.querySelector('[data-bit=\"2\"]').focus()")
    for edited in (1, 0):
        keys.send_keys(" ").perform()
        wait_for(browser, f"document.querySelectorAll('.bits .edited').length == {edited}")
        assert browser.execute_script("return document.activeElement.dataset.bit") == "2"
    assert browser.execute_script("return document.getElementById('pause').textContent") == "Pause"
    browser.execute_script("document.querySelector('.view canvas').focus()")
    keys.send_keys("+" * 3 + Keys.ARROW_RIGHT).perform()
    assert browser.execute_script("return inspector.look.scale") > 1
    assert browser.execute_script("return inspector.look.x") > 0.5
    before = browser.execute_script("return document.getElementById('dock').clientHeight")
    browser.execute_script("document.getElementById('divider').focus()")
    keys.send_keys(Keys.ARROW_UP).perform()
    assert browser.execute_script("return document.getElementById('dock').clientHeight") > before


CONTRAST = """
const channel = (value) => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
const numbers = (text) => text.match(/[\\d.]+/g).map(Number);
const light = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
const ground = (element) => {
  for (; element; element = element.parentElement) {
    const colour = getComputedStyle(element).backgroundColor;
    if (numbers(colour).length < 4 || numbers(colour)[3] > 0) return colour;
  }
  return "rgb(255, 255, 255)";
};
const faint = new Set();
for (const element of document.querySelectorAll("body *")) {
  const said = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  if (!said || !element.getClientRects().length || element.matches(":disabled")) continue;
  if (element.closest("[hidden], .nothing")) continue;
  const [a, b] = [getComputedStyle(element).color, ground(element)].map(numbers).map(light).sort((x, y) => y - x);
  const ratio = (a + 0.05) / (b + 0.05);
  if (ratio < 4.5) faint.add(`${element.tagName} ${element.className} ${element.textContent.trim()}: ${ratio}`);
}
return [...faint];
"""


@pytest.mark.browser
def test_all_text_stands_out_from_its_ground_dark_and_light(view, browser):
    browser.get(view)
    wait_for(browser, "inspector.pictures().length == 2")
    browser.execute_script("document.getElementById('registers-read').click()")
    wait_for(browser, "document.querySelector('#register-list td:nth-child(3)').textContent == '000040E3'")
    browser.execute_script(
        "Object.assign(document.getElementById('toast'), {textContent: 'no', className: 'shown bad'})"
    )
    for _ in range(2):
        assert browser.execute_script(CONTRAST) == []
        browser.execute_script("document.getElementById('theme').click()")
