"""The HTML report in a real browser, from a file and without a network.

HOST_SIM names the program; run through .ci/report. With SCREENSHOT=FILE.png the report is photographed as well.
"""

import base64
import io
import json
import os
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PROFILE = "ov7670-qvga-yuv422"


def host_sim(folder, *arguments, status=0):
    done = subprocess.run([os.environ["HOST_SIM"], *arguments], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == status, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A trace with three short lines in it, its frames and its report."""
    folder = tmp_path_factory.mktemp("report")
    host_sim(folder, "generate", "--scene", "demo", "--profile", PROFILE, "--frames", "3", "-o", "clean.camt")
    fault = "short-line:count=3,samples=6"
    host_sim(folder, "inject", "clean.camt", "--fault", fault, "--seed", "7", "-o", "broken.vcd")
    told = host_sim(folder, "diagnose", "broken.vcd", "--profile", PROFILE, "--report", "report.html", "--json", status=1)
    (folder / "told.json").write_text(told)
    host_sim(folder, "replay", "broken.vcd", "--profile", PROFILE, "--out", "frames", status=1)
    return folder


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    flags = "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking disable-sync"
    for flag in [*flags.split(), "disable-component-update", f"user-data-dir={tmp_path_factory.mktemp('profile')}"]:
        options.add_argument(f"--{flag}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    driver.execute_cdp_cmd("Network.enable", {})
    offline = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
    driver.execute_cdp_cmd("Network.emulateNetworkConditions", offline)
    yield driver
    driver.quit()


def size(browser, width, height=900):
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


@pytest.fixture
def report(browser, folder):
    size(browser, 1280)
    browser.get((folder / "report.html").as_uri())
    yield browser
    assert browser.get_log("browser") == [], "the console stays empty"
    asked = browser.execute_script("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    assert [name for name in asked if not name.startswith("data:")] == [], "nothing is loaded"


def run(browser, script):
    return browser.execute_script(f"return {script}")


def pixels(browser, script):
    """What a canvas or picture shows, as bytes of a PNG decoded here."""
    url = browser.execute_script(
        f"""const shown = {script}, canvas = document.createElement("canvas");
        canvas.width = shown.naturalWidth ?? shown.width; canvas.height = shown.naturalHeight ?? shown.height;
        canvas.getContext("2d").drawImage(shown, 0, 0);
        return canvas.toDataURL("image/png");"""
    )
    return Image.open(io.BytesIO(base64.b64decode(url.split(",")[1])))


def test_the_picture_is_the_frame_received(report, folder):
    numbers = json.loads(run(report, 'document.getElementById("numbers").textContent'))
    shown = run(report, "chosen.frame")
    sequence = numbers["frames"][shown]["sequence"]
    expected = Image.open(folder / "frames" / f"frame-{sequence:04}.png").convert("RGB")
    picture = pixels(report, 'document.querySelector("#picture img:not([hidden])")').convert("RGB")
    assert picture.size == (320, 240)
    assert picture.tobytes() == expected.tobytes()


def test_the_numbers_are_those_of_the_command_line(report, folder):
    numbers = json.loads(run(report, 'document.getElementById("numbers").textContent'))
    told = json.loads((folder / "told.json").read_text())
    for key in ("findings", "ambiguous_with", "place", "measured"):
        assert numbers["diagnosis"][key] == told[key]
    first = report.find_element("css selector", ".finding")
    assert told["findings"][0]["fault"] == "short-line"
    assert "short-line" in first.text
    assert told["findings"][0]["evidence"]["text"] in first.text


def test_a_finding_leads_to_its_row_and_its_waveform(report):
    run(report, "chooseRow(3)")
    report.find_element("css selector", ".finding").click()
    row, clock = run(report, "[chosen.row, chosen.clock]")
    place = run(report, "page.places[0]")
    assert (row, clock) == (place["row"], place["clock"])
    mark = run(report, '(({top, height}) => [top, height])(document.getElementById("row-mark").getBoundingClientRect())')
    box = run(report, '(({top, height}) => [top, height])(image().getBoundingClientRect())')
    assert abs((mark[0] + mark[1] / 2 - box[0]) / box[1] * 240 - (row + 0.5)) < 2, "the mark is on the row"
    assert run(report, "pinsAt(chosen.clock)"), "and the waveform holds that clock"
    colours = pixels(report, 'document.getElementById("waveform")').convert("RGBA").getcolors(1 << 20)
    assert len(colours) > 20, "something is drawn"


def test_a_row_leads_to_its_waveform_and_back(report):
    image = report.find_element("css selector", "#picture img:not([hidden])")
    webdriver.ActionChains(report).move_to_element_with_offset(image, 0, 40).click().perform()
    row = run(report, "chosen.row")
    clock = run(report, "chosen.clock")
    assert row is not None
    assert clock == run(report, "page.frames[chosen.frame].row_clocks[chosen.row]")
    # The first sample of a row is where the picture's bytes say: Y of the row's first pixel, gray on the bus.
    assert run(report, "pinsAt(chosen.clock).hsync") == int(not run(report, "page.bus.hsync_blank_high"))
    run(report, f"chooseClock({clock} + 5)")
    assert run(report, "chosen.row") == row
    report.find_element("id", "row-after").click()
    assert run(report, "chosen.row") == row + 1
    report.find_element("id", "line-end").click()
    end = run(report, "chosen.clock")
    assert end > run(report, "page.frames[chosen.frame].row_clocks[chosen.row]")
    assert run(report, "pinsAt(chosen.clock).hsync") != run(report, "pinsAt(chosen.clock + 1).hsync"), "the line ends"


def test_short_lines_stand_out(report):
    lines = run(report, "linesShown().cut.samples")
    assert sum(samples != 640 for samples in lines) >= 1
    assert "differ from the profile's 640" in report.find_element("id", "lines-readout").text
    assert run(report, "page.activity.buckets.reduce((sum, bucket) => sum + bucket.clocks, 0)") == run(
        report, "page.diagnosis.measured.clocks"
    )


@pytest.mark.parametrize("width", [1280, 800, 420])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_the_window(report, width, scheme):
    scheme_is = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    report.execute_cdp_cmd("Emulation.setEmulatedMedia", scheme_is)
    size(report, width)
    assert run(report, "document.documentElement.scrollWidth") <= width
    paper = run(report, "getComputedStyle(document.body).backgroundColor")
    light = sum(int(part) for part in paper[4:-1].split(",")) > 384
    assert light == (scheme == "light")


def test_the_demo_has_a_report_too(browser, tmp_path):
    host_sim(tmp_path, "demo", "--frames", "2", "--out", ".")
    size(browser, 1280)
    browser.get((tmp_path / "report.html").as_uri())
    assert "No fault found" in browser.find_element("tag name", "h1").text
    expected = Image.open(tmp_path / "frame-0000.png").convert("RGB")
    shown = pixels(browser, 'document.querySelector("#picture img:not([hidden])")').convert("RGB")
    assert shown.tobytes() == expected.tobytes()
    assert browser.get_log("browser") == []


@pytest.mark.parametrize("export", ["sr", "vcd", "digital.csv"])
def test_a_capture_as_an_analyser_exports_it_has_a_report(browser, tmp_path, export):
    """sigrok-cli writes what PulseView exports; the files of Logic 2 are as its documents say, written by host-sim."""
    if export != "digital.csv" and not shutil.which("sigrok-cli"):
        pytest.skip("no sigrok-cli (apt install sigrok-cli): its exports are not tried")
    host_sim(tmp_path, "generate", "--scene", "demo", "--profile", PROFILE, "--frames", "2", "-o", "a.camt")
    ours = "digital.csv" if export == "digital.csv" else "b.sr"
    host_sim(tmp_path, "inject", "a.camt", "--fault", "stuck-bit:bit=6,level=low", "-o", ours)
    if export != "digital.csv":
        arguments = ["-i", ours, "-O", {"sr": "srzip", "vcd": "vcd"}[export], "-o", f"export.{export}"]
        subprocess.run(["sigrok-cli", *arguments], cwd=tmp_path, check=True, timeout=120)
    trace = ours if export == "digital.csv" else f"export.{export}"
    host_sim(tmp_path, "diagnose", trace, "--profile", PROFILE, "--report", "report.html", status=1)
    size(browser, 1280)
    browser.get((tmp_path / "report.html").as_uri())
    assert "stuck-bit" in browser.find_element("tag name", "h1").text
    assert "D6" in browser.find_element("css selector", ".finding").text
    assert run(browser, "pinsAt(chosen.clock)")["data"] & 1 << 6 == 0
    assert browser.get_log("browser") == []


def documented():
    """The commands of README.md that make the documented report, as lists of arguments."""
    lines = (Path(__file__).parents[3] / "README.md").read_text().splitlines()
    last = next(index for index, line in enumerate(lines) if "diagnose capture.sr" in line)
    return [shlex.split(line)[2:] for line in lines[last - 2 : last + 1]]


def test_the_readme_commands_name_the_planted_fault(browser, tmp_path):
    *before, diagnose = documented()
    for arguments in before:
        host_sim(tmp_path, *arguments)
    host_sim(tmp_path, *diagnose, status=1)
    host_sim(tmp_path, "replay", "good.camt", "--out", "good")
    size(browser, 1280)
    browser.get((tmp_path / "report.html").as_uri())
    assert "swapped-bits" in browser.find_element("tag name", "h1").text
    rivals = run(browser, "page.rivals.map((rival) => [rival.by, rival.name])")
    assert [by for by, _ in rivals][:2] == ["given", "finding"]
    # The mended picture is the true one; both made small, because each side scales in its own way.
    true = Image.open(tmp_path / "good" / "frame-0000.png").convert("RGB")
    mended = pixels(browser, 'document.querySelector(".rivals .by-finding img")').convert("RGB")
    given = pixels(browser, 'document.querySelector(".rivals .by-given img")').convert("RGB")
    true, mended, given = (shot.resize((60, 45), Image.Resampling.BOX).tobytes() for shot in (true, mended, given))
    apart = [sum(abs(a - b) for a, b in zip(true, shown, strict=True)) / len(true) for shown in (mended, given)]
    assert apart[0] < 3 < 20 < apart[1], apart
    assert browser.get_log("browser") == []
    if wanted := os.environ.get("SCREENSHOT"):
        light = {"features": [{"name": "prefers-color-scheme", "value": "light"}]}
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", light)
        browser.execute_cdp_cmd("Emulation.setScrollbarsHidden", {"hidden": True})
        height = run(browser, "document.querySelector('.tables').getBoundingClientRect().top + scrollY")
        size(browser, 1280, round(height))
        shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
        # 256 colours: a third of the bytes, and no eye sees it.
        photograph = Image.open(io.BytesIO(base64.b64decode(shot["data"]))).convert("RGB")
        photograph.quantize(256, dither=Image.Dither.NONE).save(wanted, optimize=True)
