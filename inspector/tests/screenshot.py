"""Makes the picture of the manual: the live page with a device, as a headless Chromium shows it.

    python tests/screenshot.py URL -o ../docs/images/inspector.png

URL is a device's, such as `socket://127.0.0.1:7000` of `host-sim stream --tcp 127.0.0.1:7000`.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from browser import headless, resize, wait_for

POINT = """
const head = inspector.pictures()[0].picture.head, {width, height} = head;
inspector.look.pointer = [Math.round(0.62 * width), Math.round(0.3 * height)];
inspector.look.region = {x: Math.round(0.5 * width), y: Math.round(0.15 * height),
                         width: Math.round(0.3 * width), height: Math.round(0.35 * height)};
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("url")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--size", default="1600x1000", help="of the window (%(default)s)")
    parser.add_argument("--theme", choices=("dark", "light"), default="dark")
    parser.add_argument("--seconds", type=float, default=35, help="how long the plots are filled (%(default)s)")
    parser.add_argument("--say", action="append", default=[], help="a command to send before, such as `get`")
    options = parser.parse_args()
    width, height = (int(part) for part in options.size.split("x"))
    command = [sys.executable, "-m", "camif_inspect", "view", options.url, "--no-browser", "--port", "0"]
    with (
        tempfile.TemporaryDirectory() as profile,
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as view,
        headless(profile, width, height) as driver,
    ):
        driver.get(view.stdout.readline().strip())
        wait_for(driver, "inspector.pictures().length > 0")
        if driver.execute_script("return document.documentElement.dataset.theme") != options.theme:
            driver.execute_script("document.getElementById('theme').click()")
        driver.execute_script("document.getElementById('registers-read').click()")
        for words in options.say:
            script = "const box = document.getElementById('ask-words'); box.value = arguments[0];"
            driver.execute_script(script + "document.querySelector('#ask button').click()", words)
            time.sleep(0.5)
        time.sleep(options.seconds)
        driver.execute_script(POINT)
        time.sleep(0.5)
        resize(driver, width, height)
        options.out.write_bytes(driver.get_screenshot_as_png())
        view.terminate()


if __name__ == "__main__":
    main()
