"""Hundreds of requests that mean ill, with a slider moved beside them."""

import contextlib
import copy
import http.client
import itertools
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from lightflyer.explorer.grammar import templates
from lightflyer.explorer.state import plain

JSON = {"Content-Type": "application/json"}
REQUESTS, AT_ONCE = 400, 8
KINDS, STRANGE = 10, (3, 4)  # of requests; those without the token
GROWTH = 20e6  # of memory [byte]; measured 3e6 to 5e6
PATIENCE = 300  # s, until all that waits is done
WAIT = 10.0  # of a slider, in those before: if it stood behind such designs, it were hundreds

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/statm").exists(), reason="memory is read from /proc"
)


def resident(process):
    """Memory of a process [byte]."""
    held = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1])
    return held * os.sysconf("SC_PAGE_SIZE")


def layered(count, thickness=10.0):
    document = copy.deepcopy(plain(templates()["layers"].document))
    layer = {"material": "Al2O3", "thickness": f"{thickness:.3f} nm"}
    document["film"]["layers"] = [layer] * count
    return document


def hostile(number, draw):
    """Path and body of a request; one that begins with // has no token of the page."""
    document = layered(2)
    match number % KINDS:
        case 0:  # too many layers
            return "/api/move", {"document": layered(int(draw.integers(41, 2500)))}
        case 1:  # as many as are allowed, never the same
            return "/api/move", {"document": layered(40, draw.uniform(5.0, 50.0))}
        case 2:
            document["film"]["spectrum"] = draw.choice([" ", "\t", "\u00a0"]) + "/etc/shadow.csv"
            return "/api/predict", {"document": document}
        case 3:
            return f"//{'x' * 32}/api/move", {"document": document}
        case 4:
            return "//", None
        case 5:
            document["flyer"]["diameter"] = "9" * 5000
            return "/api/move", {"document": document}
        case 6:
            document["flyer"]["diameter"] = "2 " + "*".join(["cm"] * 5000)
            return "/api/move", {"document": document}
        case 7:
            return "/api/move", {"document": document, "pins": [layered(40)] * 900}
        case 8:
            return "/api/upload/design", {"name": "x.toml", "text": "[" * 100_000}
        case _:
            return "/api/job/map", {"document": layered(40, draw.uniform(5.0, 50.0))}


def send(address, path, content, wait=0.1):
    """Status and content of the answer; the page goes on after a tenth of a second."""
    port, token = address.split(":")[2].split("/")[:2]
    connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=wait)
    with contextlib.closing(connection), contextlib.suppress(OSError):
        body = None if content is None else json.dumps(content).encode()
        begin = path if path.startswith("//") else f"/{token}{path}"
        connection.request("POST" if body else "GET", begin, body, JSON if body else {})
        answer = connection.getresponse()
        return answer.status, answer.read()
    return None, b""


@pytest.fixture
def explorer(tmp_path):
    """A process of its own: its number, and the address that it prints."""
    # with an empty cache: it loads JAX, larger than the growth that is allowed, at its first answer
    own = os.environ | {"LIGHTFLYER_CACHE": str(tmp_path)}
    command = [sys.executable, "-m", "lightflyer", "explore", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=own) as process:
        address = process.stdout.readline().split()[2]
        yield process.pid, address
        process.terminate()


class Slider(threading.Thread):
    """Moves the diameter of a disk until it is stopped."""

    def __init__(self, address, document):
        super().__init__()
        self.address, self.document = address, copy.deepcopy(document)
        self.waits, self.over = [], threading.Event()

    def move(self, number):
        self.document["flyer"]["diameter"] = f"{1.0 + 0.001 * number:.3f} cm"
        since = time.perf_counter()
        _, answer = send(self.address, "/api/move", {"document": self.document}, wait=60)
        assert json.loads(answer)["errors"] == []
        self.waits.append(time.perf_counter() - since)

    def run(self):
        for number in itertools.count():
            if self.over.wait(0.05):
                break
            self.move(number)


def attack(address, count, draw):
    """Statuses of the answers to hostile requests, by kind."""
    found = []

    def one_thread(first):
        for number in range(first, count, AT_ONCE):
            found.append((number % KINDS, send(address, *hostile(number, draw))[0]))

    threads = [threading.Thread(target=one_thread, args=(first,)) for first in range(AT_ONCE)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


def settle(address, thickness):
    """Wait until all designs of many layers are done: they take turns, as one of eight does."""
    content, end = {"document": layered(8, thickness)}, time.monotonic() + PATIENCE
    for path in ("/api/predict", "/api/job/map"):  # in vain by others, who do not wait for them
        while send(address, path, content, wait=PATIENCE)[0] != 200:
            assert time.monotonic() < end, "the explorer has not settled"
            time.sleep(0.2)


@pytest.mark.slow
def test_a_slider_beside_hundreds_of_hostile_requests(explorer, workplace):
    process, address = explorer
    draw = np.random.default_rng(35)
    slider = Slider(address, workplace.initial)
    slider.move(0)
    attack(address, REQUESTS // 4, draw)  # until what such designs need is there
    settle(address, 20.0)
    for number in range(20):
        slider.move(number)
    quiet = np.median(slider.waits[1:])
    slider.waits.clear()
    before = resident(process)
    slider.start()
    statuses = attack(address, REQUESTS, draw)
    slider.over.set()
    slider.join()
    settle(address, 21.0)
    assert np.median(slider.waits) < WAIT * quiet
    assert resident(process) - before < GROWTH
    for kind, status in statuses:
        assert status in ({None, 403} if kind in STRANGE else {None, 200, 400, 429})
