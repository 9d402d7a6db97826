"""Files that are either whole or not there: written under a temporary name, then renamed."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import IO

from .errors import InspectError


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let Ctrl-C wait until the block, a short one, is over."""
    if threading.current_thread() is not threading.main_thread():
        # Interrupts come to the main thread only.
        yield
        return
    waiting: list[tuple[int, FrameType | None]] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: waiting.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)
        if waiting and callable(before):
            before(*waiting[0])


@contextmanager
def replacing(path: Path, buffering: int = -1) -> Iterator[IO[bytes]]:
    """Open a file for writing that takes its name only when the block ends well; `buffering` is as in `open`.

    An exception, Ctrl-C included, leaves an older file of that name as it was and nothing of the new one. What the
    system refuses, as a full disk does, is raised as `InspectError`.
    """
    if path.is_dir():
        raise InspectError(f"cannot write {path}: it is a directory; name a file")
    temporary: Path | None = None
    try:
        with uninterrupted():
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
            temporary = Path(name)
        with os.fdopen(handle, "wb", buffering) as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes the file private; a saved picture is as readable as any other new file.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except BaseException as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        if isinstance(error, FileExistsError):
            raise InspectError(f"cannot write {path}: {path.parent} is no directory") from error
        if isinstance(error, OSError) and not isinstance(error, ConnectionError):
            raise InspectError(f"cannot write {path}: {error.strerror or error}") from error
        raise
