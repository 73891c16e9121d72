"""The server of the page: on the loopback address, for pages that it served itself.

Its address begins with a token that no other user of the computer knows. It keeps nothing of a
page: each request brings the whole design; programs and recent results are kept for all pages
together. Quick answers, slow jobs, and designs of many layers have threads of their own, for
which only so many wait.
"""

import asyncio
import contextlib
import ctypes
import json
import logging
import os
import secrets
import socket
import sys
import threading
import traceback
from collections import Counter
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bokeh.server
import tornado.httpserver
import tornado.iostream
import tornado.web

import lightflyer
from lightflyer.core.errors import LightflyerError, OutputError
from lightflyer.core.progress import Step, report_to
from lightflyer.explorer import jobs, pages
from lightflyer.explorer.editing import download
from lightflyer.explorer.maps import Choices
from lightflyer.explorer.panes import panes
from lightflyer.explorer.state import Workplace, entries_of, keeping_warnings

ADDRESS = "127.0.0.1"

LARGEST_UPLOAD = 1 << 20  # Bytes of a file that the page takes
LARGEST_BODY = LARGEST_UPLOAD + (1 << 18)  # Bytes of a request: a file in JSON, with a design

QUICK_THREADS, SLOW_THREADS = 4, 3
MOST_PENDING = 40  # Answers or jobs that wait for threads of one kind or run there
MOST_LIGHT_ENTRIES = 6  # Layers of a design beside which others run: each takes 0.2 s and 4 MB

_STATIC = Path(__file__).parent / "static"
_BOKEH = Path(bokeh.server.__file__).parent / "static" / "js"
_PORTS_TRIED = 20
_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",  # Bokeh styles its canvas so; no script comes of it
        "img-src 'self' data: blob:",
        "connect-src 'self'",
        "font-src 'self' data:",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-cache",
}
"""Headers of every answer."""

_LOG = logging.getLogger("lightflyer.explorer")


@dataclass
class Service:
    """What the handlers share."""

    workplace: Workplace
    # Hosts with port by which the page may be asked for
    origins: set[str] = field(default_factory=set)
    # Threads for answers that follow a slider, and for jobs
    quick: ThreadPoolExecutor = field(
        default_factory=lambda: ThreadPoolExecutor(QUICK_THREADS, "quick")
    )
    slow: ThreadPoolExecutor = field(
        default_factory=lambda: ThreadPoolExecutor(SLOW_THREADS, "slow")
    )
    # One thread for designs of many layers
    heavy: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "heavy"))
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))  # First of each path
    # Of each kind of thread: work that waits or runs
    pending: "Counter[ThreadPoolExecutor]" = field(default_factory=Counter)

    def submit(self, pool: ThreadPoolExecutor, work: Callable[[], Any]) -> "asyncio.Future[Any]":
        """Have work done in a thread, unless too much waits already."""
        if self.pending[pool] >= MOST_PENDING:
            raise tornado.web.HTTPError(429)
        self.pending[pool] += 1
        done = asyncio.get_running_loop().run_in_executor(pool, work)

        def finished(_: Any) -> None:
            self.pending[pool] -= 1
            idle = pool is not self.quick and not self.pending[pool]
            if idle and sys.platform == "linux":
                # GNU's allocator keeps up to 200 MB of what big work has freed
                with contextlib.suppress(AttributeError):  # another C library
                    ctypes.CDLL(None).malloc_trim(0)

        done.add_done_callback(finished)
        return done


class _Guarded(tornado.web.RequestHandler):
    """Refuses strangers."""

    service: Service

    def initialize(self, service: Service, **more: Any) -> None:
        """Take what the handlers share."""
        self.service, self.gone, self.heavy = service, threading.Event(), False
        super().initialize(**more)

    def set_default_headers(self) -> None:
        """Say what browsers may do with an answer."""
        for name, value in HEADERS.items():
            self.set_header(name, value)
        self.clear_header("Server")

    def prepare(self) -> None:
        """Refuse another host's name, which may be a stranger's for this address, and origins."""
        request, origins = self.request, self.service.origins
        own = request.host.lower() in origins
        origin = request.headers.get("Origin")
        known = origin is None or origin.lower() in {f"http://{host}" for host in origins}
        site = request.headers.get("Sec-Fetch-Site", "none")
        visits = request.headers.get("Sec-Fetch-Mode", "navigate") == "navigate"
        strange = site not in ("none", "same-origin") and not (visits and request.method == "GET")
        token = request.path.split("/")[1].encode()
        invited = secrets.compare_digest(token, self.service.token.encode())
        if not (own and known and invited) or strange:
            raise tornado.web.HTTPError(403)


class _File(_Guarded, tornado.web.StaticFileHandler):  # type: ignore[misc]
    """A file of the page."""


class _Handler(_Guarded):
    """Answers questions, and mistakes in words."""

    def body(self) -> dict[str, Any]:
        """Content of the request."""
        if not self.request.headers.get("Content-Type", "").startswith("application/json"):
            raise tornado.web.HTTPError(415)
        try:
            content = json.loads(self.request.body)
            if not isinstance(content, dict):
                raise ValueError
            self.heavy = "text" in content or entries_of(content) > MOST_LIGHT_ENTRIES
        except (ValueError, RecursionError):
            raise tornado.web.HTTPError(400) from None
        return content

    def say(self, content: Any) -> None:
        """Answer with JSON, which has neither infinity nor NaN."""
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(json.dumps(content, allow_nan=False))

    async def answer(self, work: Callable[[], Any]) -> None:
        """Say the result of work on the request; none where its page has gone on before."""

        def found() -> Any:
            return None if self.gone.is_set() else work()

        try:
            self.say(await self.submit(self.service.quick, found))
        except LightflyerError as error:
            self.say({"errors": pages.mistakes(str(error))})

    def submit(self, pool: ThreadPoolExecutor, work: Callable[[], Any]) -> "asyncio.Future[Any]":
        """Have work on the request done by a pool, or by that for heavy designs."""
        return self.service.submit(self.service.heavy if self.heavy else pool, work)

    def on_connection_close(self) -> None:
        """Stop work whose page has gone on."""
        self.gone.set()

    def write_error(self, status_code: int, **more: Any) -> None:
        """Say what went wrong in one line, without the program's own."""
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(json.dumps({"errors": [pages.mistake(_STATUS.get(status_code, self._reason))]}))
        del more

    def log_exception(self, *args: Any) -> None:
        """Log what is a defect of the program's, not of a request's."""
        if not isinstance(args[1], tornado.web.HTTPError):
            _LOG.error("%s", "".join(traceback.format_exception(*args)))


_STATUS = {
    400: "the request cannot be read",
    403: "this address is of another program, or of an earlier run: the explorer's terminal has "
    "the one that serves; behind it, # and what followed bring the design back",
    404: "there is no such page",
    413: "this is too large",
    415: "the request is not JSON",
    429: "the explorer still has too much to do; ask again when it has answered",
    500: "the explorer made a mistake; its terminal says which",
}


class _Missing(_Handler):
    def prepare(self) -> None:
        super().prepare()
        raise tornado.web.HTTPError(404)


class _Panes(_Handler):
    def get(self, kind: str) -> None:
        self.say(panes(logarithmic=kind == "logarithmic"))


class _Grammar(_Handler):
    def get(self) -> None:
        self.say(pages.grammar_of_page(self.service.workplace, LARGEST_UPLOAD))


class _Answer(_Handler):
    """What follows a slider: everything that :data:`lightflyer.explorer.pages.ANSWERS` knows."""

    async def post(self, name: str) -> None:
        found = pages.ANSWERS.get(name)
        if found is None:
            raise tornado.web.HTTPError(404)
        content = self.body()
        await self.answer(lambda: found(self.service.workplace, content))


class _Upload(_Handler):
    """A file of the user's: a flyer file, or levitation points."""

    async def post(self, name: str) -> None:
        content = self.body()
        text, file = content.get("text"), content.get("name")
        if not isinstance(text, str) or not isinstance(file, str):
            raise tornado.web.HTTPError(400)
        if len(text.encode("utf-8", "surrogatepass")) > LARGEST_UPLOAD:
            raise tornado.web.HTTPError(413)
        workplace = self.service.workplace
        if name == "points":
            document = content.get("document")
            await self.answer(lambda: pages.points(workplace, text, file, document))
        else:
            await self.answer(lambda: pages.open_upload(workplace, text, file))


class _Download(_Handler):
    async def post(self, what: str) -> None:
        content, workplace = self.body(), self.service.workplace
        document = pages.document_of(content)
        choices = _choices(content)
        try:
            found = await self.submit(
                self.service.slow, lambda: download(what, workplace, document, choices)
            )
        except LightflyerError as error:
            self.set_status(422)
            self.say({"errors": pages.mistakes(str(error))})
            return
        self.set_header("Content-Type", found.kind)
        self.set_header("Content-Disposition", f'attachment; filename="{found.name}"')
        self.finish(found.content)


class _Job(_Handler):
    """A slow figure: a line of JSON for each step, and one with the result."""

    async def post(self, name: str) -> None:
        if name not in jobs.JOBS:
            raise tornado.web.HTTPError(404)
        content = self.body()
        document, choices = pages.document_of(content), _choices(content)
        loop, lines = asyncio.get_running_loop(), asyncio.Queue[dict[str, Any] | None]()

        def put(line: dict[str, Any] | None) -> None:
            with contextlib.suppress(RuntimeError):  # the server has ended meanwhile
                loop.call_soon_threadsafe(lines.put_nowait, line)

        def tell(step: Step) -> None:
            share = None if not step.total else (step.done or 0) / step.total
            put({"doing": step.doing, "share": share})

        def work() -> None:
            try:
                if self.gone.is_set():
                    raise jobs.StoppedError
                workplace = self.service.workplace
                put({"result": jobs.run(name, workplace, document, choices, tell, self.gone)})
            except jobs.StoppedError:
                put({"stopped": True})
            except LightflyerError as error:
                put({"errors": pages.mistakes(str(error))})
            except Exception:  # a defect: the page says so, and stays usable
                _LOG.exception("job %s", name)
                put({"errors": [pages.mistake(_STATUS[500])]})
            finally:
                put(None)

        self.set_header("Content-Type", "application/x-ndjson; charset=utf-8")
        self.submit(self.service.slow, work)
        try:
            while (line := await lines.get()) is not None:
                self.write(json.dumps(line, allow_nan=False) + "\n")
                await self.flush()
        except tornado.iostream.StreamClosedError:
            self.gone.set()


def _choices(content: dict[str, Any]) -> Choices:
    given = content.get("choices")
    known = given if isinstance(given, dict) else {}
    return Choices(**{name: str(known[name]) for name in Choices._fields if name in known})


def application(service: Service) -> tornado.web.Application:
    """The server's pages."""
    shared = {"service": service}
    files = {**shared, "path": str(_STATIC)}
    return tornado.web.Application(
        [
            (r"/[\w-]+/()", _File, {**files, "default_filename": "index.html"}),
            (r"/[\w-]+/static/([\w.-]+)", _File, files),
            (r"/[\w-]+/bokeh/(bokeh\.min\.js)", _File, {**shared, "path": str(_BOKEH)}),
            (r"/[\w-]+/api/grammar", _Grammar, shared),
            (r"/[\w-]+/api/panes/(\w+)", _Panes, shared),
            (r"/[\w-]+/api/upload/(design|points)", _Upload, shared),
            (r"/[\w-]+/api/download/([\w.]+)", _Download, shared),
            (r"/[\w-]+/api/job/(\w+)", _Job, shared),
            (r"/[\w-]+/api/(\w+)", _Answer, shared),
        ],
        default_handler_class=_Missing,
        default_handler_args=shared,
        log_function=lambda _: None,
    )


def listen(service: Service, port: int) -> tuple[tornado.httpserver.HTTPServer, int]:
    """Begin to listen on the loopback address; returns ``server``, ``port``."""
    server = tornado.httpserver.HTTPServer(application(service), max_body_size=LARGEST_BODY)
    ports = range(port, min(port + _PORTS_TRIED, 65_536)) if port else (0,)
    for tried in ports:
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if os.name == "posix":  # elsewhere it would share the port with another program
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((ADDRESS, tried))
            break
        except OSError:
            listener.close()
    else:
        raise OutputError(f"ports {ports[0]} to {ports[-1]} are in use; --port chooses another")
    listener.listen(128)
    listener.setblocking(False)
    server.add_sockets([listener])
    found = int(listener.getsockname()[1])
    service.origins |= {f"{name}:{found}" for name in (ADDRESS, "localhost")}
    return server, found


def serve(workplace: Workplace, port: int, opened: Callable[[str], Awaitable[None] | None]) -> None:
    """Serve the page until interrupted."""

    async def run() -> None:
        service = Service(workplace)
        _, found = listen(service, port)
        service.slow.submit(pages.warm, workplace)
        opened(f"http://{ADDRESS}:{found}/{service.token}/")
        await asyncio.Event().wait()

    _LOG.info("lightflyer %s", lightflyer.__version__)
    with report_to(jobs.pass_on), keeping_warnings():
        asyncio.run(run())
