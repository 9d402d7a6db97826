"""The live view: a page in the browser, fed over a websocket.

| module | what lives there |
|---|---|
| `pictures` | which rows of which frame a page needs next, and how they are packed |
| `desk` | what one page is told, and what it may ask for |
| `server` | HTTP and websocket on one local port, and who may talk to it |
| `page/` | the page itself: plain HTML, CSS and modules, nothing from elsewhere |
"""

from __future__ import annotations

from .server import serve

__all__ = ["serve"]
