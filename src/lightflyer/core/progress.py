"""What long work says about where it is.

Work reports its steps here and knows nothing of who listens. The command line listens and shows
them; from Python nobody does unless :func:`report_to` is used.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

_listening, _asked = threading.Event(), threading.Event()


class Step(NamedTuple):
    """Where long work is."""

    doing: str  # What is done, such as ``"searching from several starts"``
    done: int | None = None  # How much of it, where that is known
    total: int | None = None  # How much of it, where that is known
    unit: str = ""  # What is counted, such as ``"designs"``; empty where a rate would say nothing


Listener = Callable[[Step], None]

_LISTENERS: list[Listener] = []


def report(doing: str, done: int | None = None, total: int | None = None, unit: str = "") -> None:
    """Say where the work is; costs nothing where nobody listens."""
    if _LISTENERS:
        _LISTENERS[-1](Step(doing, done, total, unit))


@contextmanager
def report_to(listener: Listener) -> Iterator[None]:
    """Have the steps of long work reported to a function within the block."""
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        _LISTENERS.remove(listener)


@contextmanager
def reported_as_part(before: int, total: int, unit: str) -> Iterator[None]:
    """Have what is counted within the block reported as a part of something larger."""
    outer = _LISTENERS[-1] if _LISTENERS else None

    def tell(step: Step) -> None:
        if outer is not None and step.unit == unit:
            outer(step._replace(done=min(before + (step.done or 0), total), total=total))

    with report_to(tell):
        yield


class Counted:
    """Work whose parts are counted as they end, in whatever thread."""

    def __init__(self, doing: str, total: int, unit: str = "", done: int = 0) -> None:
        self._step = Step(doing, done, total, unit)
        self._lock = threading.Lock()
        report(*self._step)

    def add(self, count: int = 1) -> None:
        """Count further parts, and report them."""
        with self._lock:
            _, done, total, _ = self._step
            self._step = self._step._replace(done=min((done or 0) + count, total or 0))
            report(*self._step)


@contextmanager
def ends_early() -> Iterator[None]:
    """Context of work that looks at :func:`asked_to_end` now and then."""
    _listening.set()
    try:
        yield
    finally:
        _listening.clear()
        _asked.clear()


def asked_to_end() -> bool:
    """Whether the work should end and keep what it has."""
    return _asked.is_set()


def ask_to_end() -> bool:
    """Ask work to end; whether there is some that listens and was not asked before."""
    asks = _listening.is_set() and not _asked.is_set()
    if asks:
        _asked.set()
    return asks
