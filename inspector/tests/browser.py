"""A headless Chromium, for the tests and for the screenshot of the manual."""

import contextlib
import shutil
import time


def available():
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


@contextlib.contextmanager
def headless(profile, width, height):
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    flags = "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking"
    for flag in [*flags.split(), "disable-component-update", "disable-sync", f"user-data-dir={profile}"]:
        options.add_argument(f"--{flag}")
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    try:
        resize(driver, width, height)
        yield driver
    finally:
        with contextlib.suppress(Exception):
            driver.quit()


def resize(driver, width, height):
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def wait_for(driver, script, seconds=20):
    """Wait for something to be so, and for the page to be so far that it can be asked."""
    until = time.monotonic() + seconds
    while not (value := driver.execute_script(f"try {{ return {script} }} catch {{ return null }}")):
        assert time.monotonic() < until, script
        time.sleep(0.05)
    return value
