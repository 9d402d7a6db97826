"""What several tests share."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import device as devices
import pictures

# What is known not to work yet, and why; a test that begins to pass is welcome to.
KNOWN = {
    "test_a_recording_plays_as_a_device": "what a device says before the port is open is lost: the flush of pyserial",
    "test_a_device_of_another_version_is_told_from_noise": "the same",
    "test_stats_and_command": "the same; the session should ask for HELLO once it is open",
    "test_requests_and_their_answers[streams": "the same",
    "test_bad_input_gets_one_clear_line[-`udp:1`": "the progress bar leaves an empty line before the error",
}


def pytest_collection_modifyitems(items):
    """Mark the known failures with their reasons."""
    for item in items:
        for name, reason in KNOWN.items():
            if item.name.startswith(name):
                item.add_marker(pytest.mark.xfail(reason=reason, strict=False))


@pytest.fixture
def device():
    """A device with a colour stream and its edges, on TCP, ready to be talked to."""
    made = devices.Device(
        [
            ("raw", devices.RGB888, devices.RAW, pictures.colour),
            ("edges", devices.GRAY8, 3, pictures.edges),
        ]
    )
    with made:
        made.url = made.on_tcp()
        yield made
