"""Where the test vectors of the link are, and how they are read."""

import json
import os
from pathlib import Path

DIRECTORY = Path(os.environ.get("CAMIF_LINK_VECTORS") or Path(__file__).parents[2] / "tests" / "data" / "link")
VECTORS = json.loads((DIRECTORY / "vectors.json").read_text())


def load(name: str) -> bytes:
    return (DIRECTORY / name).read_bytes()
