import asyncio
import http.client
import json
import shutil
import threading
from importlib import resources

import pytest

from lightflyer.core.progress import report_to
from lightflyer.explorer import jobs, server
from lightflyer.explorer.state import Workplace, keeping_warnings

BROWSERS = ("chromium", "chromium-browser", "google-chrome")

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
"""What a browser needs that may reach nothing but this computer."""


@pytest.fixture(scope="session")
def workplace():
    """What the explorer opens with where it is given no file."""
    return Workplace.of_file(None)


class Site:
    """A server in a thread, and questions to it."""

    def __init__(self, listeners, port, token):
        self.listeners, self.port, self.token = listeners, port, token
        self.origin = f"http://{server.ADDRESS}:{port}"
        self.address = f"{self.origin}/{token}/"

    def request(self, method, path, body=None, headers=None, token=None):
        """Status, headers and content of an answer."""
        connection = http.client.HTTPConnection(server.ADDRESS, self.port, timeout=60)
        begin = f"/{self.token}" if token is None else token
        try:
            connection.request(method, begin + path, body, headers or {})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def ask(self, question, **content):
        """Answer to a question of the page."""
        body = json.dumps(content)
        json_body = {"Content-Type": "application/json"}
        status, _, found = self.request("POST", f"/api/{question}", body, json_body)
        assert status == 200, found
        return json.loads(found)


@pytest.fixture(scope="session")
def site(workplace):
    """The explorer's server, for all tests of it."""
    ready, stop = threading.Event(), asyncio.Event()
    found = {}

    async def run():
        service = server.Service(workplace)
        listening, port = server.listen(service, 0)
        found.update(
            site=Site(list(listening._sockets.values()), port, service.token),
            loop=asyncio.get_running_loop(),
        )
        ready.set()
        await stop.wait()
        listening.stop()
        await listening.close_all_connections()
        service.quick.shutdown()
        service.slow.shutdown()
        service.heavy.shutdown()

    with report_to(jobs.pass_on), keeping_warnings():
        thread = threading.Thread(target=lambda: asyncio.run(run()))
        thread.start()
        assert ready.wait(30)
        yield found["site"]
        found["loop"].call_soon_threadsafe(stop.set)
        thread.join(30)


@pytest.fixture(scope="session")
def browser():
    """Debian's Chromium; tests that need it are skipped where there is none."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip(f"needs a browser: none of {', '.join(BROWSERS)} is installed")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=path, headless=True, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def points_file():
    """Levitation points that come with the package."""
    with resources.as_file(resources.files("lightflyer") / "data" / "points.csv") as path:
        yield path
