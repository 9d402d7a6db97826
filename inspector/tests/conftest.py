"""What several tests share."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import device as devices
import pictures


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
