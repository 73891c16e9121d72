"""``lightflyer`` and ``python -m lightflyer``.

Ctrl-C ends the process at once, with one line; so do the signals TERM and HUP. Raised as an
exception it would come up wherever Python happens to be: in the middle of loading a library, which
then fails in a way of its own, or in a callback of a library that swallows it. Files are written
under another name first and a sweep keeps a journal, so nothing is lost that an orderly end would
keep. A flight is asked to end first.
"""

import codecs
import ctypes
import gc
import io
import logging
import os
import signal
import sys
import threading
from typing import Any

_FAILURE = 2
_LEAST_MEMORY = 480_000_000  # bytes of addresses; with figures and flights libraries take 460 MB
_RAISE_THE_LIMIT = (
    b"lightflyer: error: libraries need 480 MB of memory; raise the limit of it (ulimit -v)\n"
)

_BY_SIGNAL = 128  # what the exit code is of, with a signal's number

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # of malloc.h

_SPELLED_OUT = "lightflyer.spelled_out"
_ASCII = {
    "±": "+-", "²": "^2", "³": "^3", "µ": "u", "μ": "u", "°": "deg ", "·": "*", "×": "x", "−": "-",
    "–": "-", "—": "-", "…": "...", "≤": "<=", "≥": ">=", "≈": "~", "→": "->", "α": "alpha",
    "β": "beta", "δ": "delta", "ε": "eps", "λ": "lambda", "σ": "sigma", "Δ": "Delta", "ω": "omega",
    "χ": "chi", "ν": "nu", "φ": "phi", "ρ": "rho", "τ": "tau", "√": "sqrt", "∞": "inf", "½": "1/2",
    "‘": "'", "’": "'", "“": '"', "”": '"', "─": "-", "━": "-", "═": "=", "│": "|", "┃": "|",
    "╭": "+", "╮": "+", "╰": "+", "╯": "+", "┏": "+", "┓": "+", "┗": "+", "┛": "+", "┳": "+",
    "┻": "+", "╇": "+", "╈": "+", "┡": "+", "┩": "+", "╪": "+", "┼": "+", "├": "+", "┤": "+",
    "┬": "+", "┴": "+", "└": "+", "┘": "+", "┌": "+", "┐": "+", "█": "#", "•": "*",
    "\N{NO-BREAK SPACE}": " ", "\N{NARROW NO-BREAK SPACE}": " ",
}  # fmt: skip

_KEPT = "with --out whole batches of flights are kept; the same command goes on from there"
_GOES_ON = {
    **dict.fromkeys(("fly", "spread"), _KEPT),
    "explore": "the address of the page holds its design, and opens it again",
    "sweep": "what was computed is kept; the same command goes on from there",
}
_BEGINS_ANEW = "the same command begins anew"
_ON_A_TERMINAL = b"\x1b[?25h\n"  # show the cursor, which a progress bar hides; leave the line of ^C


def main() -> None:
    """Run the command line of this process."""
    _open_closed_streams()
    _refuse_little_memory()
    _answer_signals()
    codecs.register_error(_SPELLED_OUT, _spell_out)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_SPELLED_OUT)
    gc.set_threshold(50_000, 20, 100)  # collecting the garbage of imports takes time, saves none
    _keep_memory()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads wait on matrices as small as ours
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # or it asks each package for one
    # of a home that cannot be written, in which Matplotlib would keep its list of fonts
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from lightflyer.cli import main as run  # takes a while
    from lightflyer.cli.code_cache import keep_code
    from lightflyer.core.extras import hide_libraries

    hide_libraries()  # until an extra or a plug-in may need it
    keep_code()
    run()


def _refuse_little_memory() -> None:
    # where memory ends while libraries load, some end the process, with many lines or none
    if sys.platform == "linux":
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit != resource.RLIM_INFINITY and limit < _LEAST_MEMORY:
            os.write(2, _RAISE_THE_LIMIT)
            sys.exit(_FAILURE)


def _open_closed_streams() -> None:
    """Put something in the place of closed streams, or files would get their numbers."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def _answer_signals() -> None:
    """Have threads answer, which do so during a compilation too: Python's handlers outwait it."""
    if not hasattr(signal, "sigwait"):
        signal.signal(signal.SIGINT, _stop)
        return
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    threading.Thread(target=_wait, daemon=True).start()
    # blocked, these would be so in processes that are started too; what is ignored stays so
    to_read, to_write = os.pipe()
    os.set_blocking(to_write, False)
    signal.set_wakeup_fd(to_write, warn_on_full_buffer=False)
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, lambda *_: None)
    threading.Thread(target=_wait_on, args=(to_read,), daemon=True).start()


def _keep_memory() -> None:
    """Let arrays that are freed stay with the process, which soon asks for as much again."""
    # The C library gives 128 KiB and more back to the system each time, and up to a sixth of an
    # answer goes into getting them again.
    library: Any = ctypes.CDLL(None) if sys.platform == "linux" else None
    if hasattr(library, "mallopt"):  # it is not in every such library
        for parameter, size in ((_M_TRIM_THRESHOLD, 64 * 2**20), (_M_MMAP_THRESHOLD, 16 * 2**20)):
            library.mallopt(parameter, size)


def _spell_out(error: UnicodeError) -> tuple[str, int]:
    """What a terminal or a pipe that does not know a character gets in its place."""
    assert isinstance(error, UnicodeEncodeError)
    text = error.object[error.start : error.end]
    return "".join(_ASCII.get(character, "?") for character in text), error.end


def _wait() -> None:
    while True:
        signal.sigwait({signal.SIGINT})
        _stop()


def _wait_on(to_read: int) -> None:
    while number := os.read(to_read, 1):
        if number[0] in (signal.SIGTERM, signal.SIGHUP):
            _stop(number[0])


def _stop(number: int = 0, *_: Any) -> None:
    # of a signal but that of Ctrl-C
    before = _ON_A_TERMINAL if os.isatty(2) else b""
    work = sys.modules.get("lightflyer.core.progress")
    if work is not None and hasattr(work, "ask_to_end") and work.ask_to_end():
        os.write(2, before + b"lightflyer: interrupted; keeps what was done, once more drops it\n")
        return
    files = sys.modules.get("lightflyer.core.atomic_files")
    if files is not None and hasattr(files, "remove_unfinished"):  # it may be half loaded
        files.remove_unfinished()
    what_next = _GOES_ON.get("".join(sys.argv[1:2]), _BEGINS_ANEW)
    os.write(2, before + f"lightflyer: interrupted; {what_next}\n".encode())
    os._exit(_BY_SIGNAL + (number or signal.SIGINT))


if __name__ == "__main__":
    main()
