import copy
import json
import os
import socket
import threading
import time
from pathlib import Path

import pytest

from lightflyer.explorer import jobs, pages, server

JSON = {"Content-Type": "application/json"}


def test_every_answer_says_what_browsers_may_do(site):
    for path in ("/", "/static/main.js", "/bokeh/bokeh.min.js", "/api/grammar", "/nothing"):
        status, headers, _ = site.request("GET", path)
        assert status == (404 if path == "/nothing" else 200)
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "script-src 'self';" in policy  # neither inline scripts nor eval
        assert "frame-ancestors 'none'" in policy
        assert headers["X-Frame-Options"] == "DENY"
        assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://elsewhere.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Host": "elsewhere.example"},  # its name may be made to mean this address
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"},
    ],
)
def test_strangers_get_403(site, headers):
    for method, path in (
        ("POST", "/api/open"),
        ("GET", "/api/grammar"),
        ("GET", "/static/main.js"),
    ):
        status, _, _ = site.request(method, path, b"{}" if method == "POST" else None, headers)
        assert status == 403


@pytest.mark.parametrize("token", ["", "/", "/none", f"/{'x' * 32}"])
@pytest.mark.parametrize("path", ["/", "/static/main.js", "/api/grammar", "/nothing"])
def test_no_page_without_the_token(site, token, path):
    status, _, content = site.request("GET", path, token=token)
    assert status == 403
    assert site.token not in content.decode()


def test_so_many_questions_wait_and_no_more(site, workplace, monkeypatch):
    begun, go_on = threading.Event(), threading.Event()

    def patient(*_):
        begun.set()
        assert go_on.wait(30)
        return {}

    monkeypatch.setitem(pages.ANSWERS, "move", patient)
    body = json.dumps({"document": workplace.initial}).encode()
    statuses = []
    threads = [
        threading.Thread(
            target=lambda: statuses.append(site.request("POST", "/api/move", body, JSON)[0])
        )
        for _ in range(server.MOST_PENDING + 3)
    ]
    for thread in threads:
        thread.start()
    assert begun.wait(10)
    while len(statuses) < 3:
        time.sleep(0.01)
    go_on.set()
    for thread in threads:
        thread.join()
    assert sorted(statuses) == [200] * server.MOST_PENDING + [429] * 3


def test_own_page_is_answered_and_may_be_linked_to(site):
    own = {"Origin": site.origin, "Sec-Fetch-Site": "same-origin", **JSON}
    assert site.request("POST", "/api/open", b"{}", own)[0] == 200
    linked = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    assert site.request("GET", "/", None, linked)[0] == 200
    assert [listener.getsockname()[0] for listener in site.listeners] == ["127.0.0.1"]


@pytest.mark.parametrize(
    ("path", "body", "headers", "expected"),
    [
        ("/api/open", b"{", JSON, 400),
        ("/api/open", b"[]", JSON, 400),
        ("/api/open", b"[" * 100_000, JSON, 400),
        ("/api/open", b"{}", {"Content-Type": "text/plain"}, 415),
        ("/api/nothing", b"{}", JSON, 404),
        ("/api/job/nothing", b"{}", JSON, 404),
        ("/api/upload/design", b'{"text": 1, "name": "x"}', JSON, 400),
        ("/static/../server.py", None, {}, 404),
    ],
)
def test_wrong_requests(site, path, body, headers, expected):
    status, _, content = site.request("GET" if body is None else "POST", path, body, headers)
    assert status == expected
    if body is not None:
        assert "Traceback" not in content.decode()


@pytest.mark.parametrize(
    "document", [None, [], {"other": {}}, {"flyer": 3}, {"flyer": {}}, {"flyer": {"shape": []}}]
)
@pytest.mark.parametrize("name", ["move", "predict", "pins", "switch"])
def test_wrong_designs_are_told_in_words(site, name, document):
    found = site.ask(name, document=document, section="flyer", tag="saucer")
    assert found["errors"]
    assert all(one["text"] and "\n" not in one["text"] for one in found["errors"])


def test_uploads_are_limited_and_mistakes_name_the_file(site):
    too_large = json.dumps({"text": "#" * (server.LARGEST_UPLOAD + 1), "name": "x.toml"})
    assert site.request("POST", "/api/upload/design", too_large, JSON)[0] == 413
    found = site.ask("upload/design", text="[flyer]\nshape = disk\n", name="../x.toml")
    assert found["errors"][0]["text"].startswith("x.toml:2: is not valid TOML")
    found = site.ask("upload/points", text="pressure [Pa]\n1\n", name="y.csv", document={})
    assert found["errors"][0]["text"].startswith("y.csv")
    opened = site.ask("upload/design", text='[flyer]\ndiameter = "2 cm"\n[film]\n', name="z.toml")
    assert "[film] needs" in opened["errors"][0]["text"]


def lines_of(site, name, document):
    body = json.dumps({"document": document})
    _, _, content = site.request("POST", f"/api/job/{name}", body, JSON)
    return [json.loads(line) for line in content.decode().splitlines()]


def test_job_tells_its_steps_then_its_result(site, workplace):
    *steps, last = lines_of(site, "map", workplace.initial)
    assert any(step.get("share") for step in steps)
    assert "cells" in last["result"]["sources"]
    (last,) = lines_of(site, "film", workplace.initial)
    assert "choose layers" in last["errors"][0]["text"]


def test_defect_of_a_job_is_told_and_the_server_goes_on(site, workplace, monkeypatch, caplog):
    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setitem(jobs.JOBS, "map", broken)
    (last,) = lines_of(site, "map", workplace.initial)
    assert "its terminal says which" in last["errors"][0]["text"]
    assert "ZeroDivisionError" in caplog.text
    assert site.ask("open")["document"] == workplace.initial


def test_job_of_one_page_does_not_hold_up_another(site, workplace, monkeypatch):
    """A job, as busy as Python can be, beside questions of other pages."""
    begun, asked = threading.Event(), threading.Event()

    def busy(*_):
        begun.set()
        while not asked.is_set():
            sum(range(1000))
        return {}

    site.ask("move", document=workplace.initial)  # compiled
    alone = []
    for _ in range(5):
        since = time.perf_counter()
        site.ask("move", document=workplace.initial)
        alone.append(time.perf_counter() - since)
    monkeypatch.setitem(jobs.JOBS, "map", busy)
    thread = threading.Thread(target=lambda: lines_of(site, "map", workplace.initial))
    thread.start()
    waits = []
    try:
        assert begun.wait(10)
        for _ in range(8):
            since = time.perf_counter()
            site.ask("move", document=workplace.initial)
            waits.append(time.perf_counter() - since)
    finally:
        asked.set()
        thread.join()
    assert sorted(waits)[4] - sorted(alone)[2] < 0.3


def test_job_ends_where_its_page_has_gone(site, workplace, monkeypatch):
    begun, ended = threading.Event(), threading.Event()

    def patient(*_):
        begun.set()
        try:
            for done in range(2000):
                jobs.report("waiting", done, 2000)
                time.sleep(0.01)
        finally:
            ended.set()
        return {}

    monkeypatch.setitem(jobs.JOBS, "map", patient)
    body = json.dumps({"document": workplace.initial}).encode()
    with socket.create_connection((server.ADDRESS, site.port)) as connection:
        head = f"POST /{site.token}/api/job/map HTTP/1.1\r\nHost: 127.0.0.1:{site.port}\r\n"
        head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
        connection.sendall(head.encode() + body)
        assert begun.wait(10)
    assert ended.wait(5)


def resident():
    """Memory of this process [byte]."""
    pages_held = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages_held * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_eight_pages_are_apart_and_need_little_memory(site, workplace):
    """Each holds another design; none sees another's, and the server keeps hardly anything."""
    documents = []
    for number in range(8):
        document = copy.deepcopy(workplace.initial)
        document["flyer"]["diameter"] = f"{1.0 + 0.1 * number:.1f} cm"
        documents.append(document)
    site.ask("predict", document=documents[0])
    found = {}

    def visit(number):
        document = documents[number]
        moved = site.ask("move", document=document, at="75 km")
        found[number] = moved["url"], site.ask("predict", document=document)["summary"]

    before = resident()
    threads = [threading.Thread(target=visit, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert resident() - before < 8 * 5e6
    areas = set()
    for number, document in enumerate(documents):
        url, summary = found[number]
        assert f"flyer.diameter={1.0 + 0.1 * number:.1f}+cm" in url
        assert summary == site.ask("predict", document=document)["summary"]
        areas.add(summary["best"]["payload_mg"])
    assert len(areas) == 8
