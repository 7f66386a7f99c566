"""A finished inspection served on this machine: the files of one folder, and nothing beside or above it."""

from __future__ import annotations

import ipaddress
import socket
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from ...errors import InputError, OutputError

if TYPE_CHECKING:
    from collections.abc import Mapping

_START = "viewer.html"
_OWN_NAMES = ("localhost", "127.0.0.1", "[::1]")
_TYPES = {".html": "text/html; charset=utf-8", ".toml": "text/plain; charset=utf-8", ".glb": "model/gltf-binary"}


def make_server(
    folder: str | Path, *, host: str = "127.0.0.1", port: int = 0, made: Mapping[str, bytes] | None = None
) -> ThreadingHTTPServer:
    """Return a server of a folder's files, ready for `serve_forever`; `server_address` says where it listens.

    Only files inside the folder are given, links out of it are not followed, folders are not listed. On the loopback
    address, requests that name another host are refused, so that no page from elsewhere can read the files.

    Args:
        folder: Of an inspection, with `viewer.html`.
        host: Address to listen on.
        port: Port to listen on; a free one when 0.
        made: Content to give in place of files, by name.

    Raises:
        InputError: The folder is none of an inspection.
        OutputError: The address cannot be listened on.
    """
    root = Path(folder).resolve()
    if not (root / _START).is_file():
        raise InputError(
            f"no {_START} stands in it", where=folder, expected="a folder that springline inspect has written"
        )
    names = _OWN_NAMES if _is_loopback(host) else None

    class Handler(_Files):
        folder, hosts, contents = root, names, dict(made or {})

    class Server(ThreadingHTTPServer):
        address_family = socket.AF_INET6 if ":" in host else socket.AF_INET

    try:
        return Server((host, port), Handler)
    except (OSError, OverflowError) as error:
        raise OutputError(
            f"cannot be listened on: {error}", where=f"{host}, port {port}", mend="choose another port"
        ) from error


def _is_loopback(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class _Files(SimpleHTTPRequestHandler):
    """Gives files of `folder` to those who ask by one of the names in `hosts`."""

    folder: Path
    hosts: tuple[str, ...] | None
    contents: dict[str, bytes]
    server_version, sys_version = "springline", ""

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the base class names it so
        """Say nothing: the command line speaks for itself."""

    def do_GET(self) -> None:
        """Give a file."""
        self._give(body=True)

    def do_HEAD(self) -> None:
        """Give a file's headers."""
        self._give(body=False)

    def _give(self, *, body: bool) -> None:
        name = self._asked_for()
        if self.hosts is not None and self.headers.get("Host", "").rsplit(":", 1)[0] not in self.hosts:
            self.send_error(HTTPStatus.FORBIDDEN, "this name is not mine")
            return
        if name == "":
            self.send_response(HTTPStatus.FOUND)
            self.send_header("Location", f"/{_START}")
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        content = self.contents.get(name)
        if content is None:
            path = self._inside(name)
            if path is None:
                self.send_error(HTTPStatus.NOT_FOUND, "no such file")
                return
            content = path.read_bytes()
        self.send_response(HTTPStatus.OK)
        suffix = Path(name).suffix.lower()
        self.send_header("Content-Type", _TYPES.get(suffix) or self.guess_type(name))
        self.send_header("Content-Length", str(len(content)))
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        if body:
            self.wfile.write(content)

    def _asked_for(self) -> str:
        return unquote(urlsplit(self.path).path).lstrip("/")

    def _inside(self, name: str) -> Path | None:
        """Return the file of that name, None when there is none inside the folder."""
        try:
            path = (self.folder / name).resolve(strict=True)
        except (OSError, ValueError):
            return None
        return path if path.is_file() and path.is_relative_to(self.folder) else None
