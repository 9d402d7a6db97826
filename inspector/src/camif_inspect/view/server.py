"""HTTP and websocket on one local port, and who may talk to it.

A page of another site must not reach the device through the visitor's browser, so both the Host of every request and
the Origin of the websocket must name this server: that stops DNS rebinding and cross-site websockets.
"""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import json
import logging
import signal
import webbrowser
from concurrent.futures import ThreadPoolExecutor
from http import HTTPStatus
from importlib import resources
from pathlib import Path
from typing import Any

from rich.console import Console
from websockets.asyncio.server import Server, ServerConnection
from websockets.asyncio.server import serve as serve_websocket
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from ..errors import InspectError
from ..session import Session
from .desk import SAMPLE_SECONDS, Desk, History, state, welcome
from .pictures import packed

_TICK_SECONDS = 1 / 30
_STATE_TICKS = 6
# Questions of one page that wait for their answers; further ones wait in its connection.
_QUESTIONS = 16
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".woff2": "font/woff2",
}
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; img-src 'self' data:; connect-src 'self'"
)


def page_files() -> dict[str, tuple[str, bytes]]:
    """Give everything the page is made of: path, type and content. Nothing else is ever served."""
    files = {}
    root = resources.files(__package__).joinpath("page")
    for folder, prefix in ((root, "/"), (root.joinpath("fonts"), "/fonts/")):
        for entry in folder.iterdir():
            kind = _TYPES.get(Path(entry.name).suffix)
            if kind and entry.is_file():
                files[prefix + entry.name] = (kind, entry.read_bytes())
    files["/"] = files["/index.html"]
    return files


class View:
    """The server of one session's live view."""

    def __init__(self, session: Session, host: str, port: int, directory: Path) -> None:
        """Take a note of what to serve, and where files of the page's Save go."""
        self._session = session
        self._host = host
        self._port = port
        self._directory = directory
        self._files = page_files()
        self._history = History(session)
        # Questions may wait for a device for seconds; pictures must not wait for their threads.
        self._packers = ThreadPoolExecutor(2, "camif-inspect pictures")
        self._server: Server | None = None
        self._sampler: asyncio.Task[None] | None = None

    @property
    def url(self) -> str:
        """Where the page is."""
        host = "localhost" if self._host in ("127.0.0.1", "::1") else self._host
        return f"http://{f'[{host}]' if ':' in host else host}:{self._port}/"

    async def start(self) -> None:
        """Begin to serve."""
        quiet = logging.getLogger("camif_inspect.websockets")
        # A browser that goes away in the middle of a handshake is no news.
        quiet.setLevel(logging.CRITICAL)
        try:
            self._server = await serve_websocket(
                self._talk,
                self._host,
                self._port,
                process_request=self._request,
                compression=None,
                max_size=1 << 16,
                logger=quiet,
            )
        except (OSError, OverflowError) as error:
            text = getattr(error, "strerror", None) or str(error)
            hint = "; choose another with --port" if "in use" in str(error) else ""
            raise InspectError(f"cannot serve the page at {self._host} port {self._port}: {text}{hint}") from error
        self._port = next(iter(self._server.sockets)).getsockname()[1]
        self._sampler = asyncio.create_task(self._sample())

    async def stop(self) -> None:
        """Stop serving, and close the session."""
        # Whoever waits for a reply is told that it will not come.
        await asyncio.get_running_loop().run_in_executor(self._packers, self._session.close)
        self._packers.shutdown(wait=False)
        if self._sampler:
            self._sampler.cancel()
        if self._server:
            self._server.close()
            await self._server.wait_closed()

    async def _sample(self) -> None:
        while True:
            await asyncio.sleep(SAMPLE_SECONDS)
            self._history.take()

    # Who may talk.

    def _hosts(self) -> set[str]:
        """Give the values of Host that name this server."""
        names = {"localhost", "127.0.0.1", "[::1]"}
        if self._host not in ("", "0.0.0.0", "::"):
            names.add(f"[{self._host}]" if ":" in self._host else self._host)
        hosts = {f"{name}:{self._port}" for name in names}
        return hosts | names if self._port == 80 else hosts

    def _welcome_host(self, host: str) -> bool:
        if host.lower() in self._hosts():
            return True
        if self._host not in ("0.0.0.0", "::"):
            return False
        # Asked to listen everywhere: any address of digits will do, a name could be anybody's.
        name, _, port = host.rpartition(":")
        try:
            ipaddress.ip_address(name.strip("[]"))
        except ValueError:
            return False
        return port == str(self._port)

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer HTTP; give None for the websocket that may go on."""
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or not self._welcome_host(hosts[0]):
            return connection.respond(HTTPStatus.FORBIDDEN, "This server is known by another name.\n")
        path = request.path.split("?", 1)[0]
        if path == "/live":
            origins = request.headers.get_all("Origin")
            if origins != [f"http://{hosts[0]}"]:
                return connection.respond(HTTPStatus.FORBIDDEN, "Only this server's own page may listen.\n")
            return None
        if path not in self._files:
            return connection.respond(HTTPStatus.NOT_FOUND, "There is no such file.\n")
        kind, content = self._files[path]
        headers = Headers(
            {
                "Content-Type": kind,
                "Content-Length": str(len(content)),
                "Content-Security-Policy": _POLICY,
                "X-Content-Type-Options": "nosniff",
                "Referrer-Policy": "no-referrer",
                "Cache-Control": "no-cache",
                "Connection": "close",
            }
        )
        return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, content)

    # What is said.

    async def _talk(self, connection: ServerConnection) -> None:
        desk = Desk(self._session, self._directory)
        teller = asyncio.create_task(self._tell(connection, desk))
        questions: set[asyncio.Task[None]] = set()
        try:
            async for message in connection:
                while len(questions) >= _QUESTIONS:
                    await asyncio.wait(questions, return_when=asyncio.FIRST_COMPLETED)
                task = asyncio.create_task(self._answer(connection, desk, message))
                questions.add(task)
                task.add_done_callback(questions.discard)
        except ConnectionClosed:
            pass
        finally:
            teller.cancel()
            for task in list(questions):
                task.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionClosed):
                await teller

    async def _answer(self, connection: ServerConnection, desk: Desk, message: str | bytes) -> None:
        try:
            question = json.loads(message)
        except ValueError:
            question = {}
        if not isinstance(question, dict):
            question = {}
        answer = await asyncio.to_thread(desk.answer, question)
        with contextlib.suppress(ConnectionClosed):
            await connection.send(json.dumps(answer))

    async def _tell(self, connection: ServerConnection, desk: Desk) -> None:
        """Tell a page everything that changes, as fast as it takes it."""

        async def say(message: dict[str, Any]) -> None:
            await connection.send(json.dumps(message))

        loop = asyncio.get_running_loop()
        await say(welcome(self._session))
        samples = log = 0
        tick = 0
        while True:
            if tick % _STATE_TICKS == 0:
                await say(state(self._session, self._history))
            new = self._history.count - samples
            if new:
                samples = self._history.count
                await say({"type": "samples", "rates": list(self._history.rates)[-new:]})
            lines, log = self._session.said_since(log)
            if lines:
                now = self._session.source.now()
                await say({"type": "log", "lines": [[level, text, max(0.0, now - at)] for at, level, text in lines]})
            if not desk.paused:
                with self._session.lock:
                    lacking = desk.pictures.lacking(self._session.receiver.streams)
                for rows in lacking:
                    await connection.send(await loop.run_in_executor(self._packers, packed, rows))
            tick += 1
            await asyncio.sleep(_TICK_SECONDS)


def serve(session: Session, host: str, port: int, directory: Path, browser: bool) -> None:
    """Serve the live view until Ctrl-C."""
    console = Console(stderr=True, highlight=False)

    async def run() -> None:
        view = View(session, host, port, directory)
        await view.start()
        session.start()
        print(view.url, flush=True)
        console.print(f"showing {session.source.name} at {view.url}; Ctrl-C ends", markup=False)
        try:
            loopback = host == "localhost" or ipaddress.ip_address(host).is_loopback
        except ValueError:
            loopback = False
        if not loopback:
            console.print("whoever can reach this address can command the device", style="yellow")
        if browser:
            await asyncio.to_thread(webbrowser.open, view.url)
        over = asyncio.Event()
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM):
            # Where there are no signal handlers (Windows), KeyboardInterrupt ends it as well.
            with contextlib.suppress(NotImplementedError):
                loop.add_signal_handler(number, over.set)
        try:
            while not over.is_set():
                session.check()
                with contextlib.suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(over.wait(), 0.5)
        finally:
            await view.stop()

    asyncio.run(run())
