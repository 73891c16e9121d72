"""What is shown while a command works, and that it is gone before results are."""

import io
import time

import pytest

from lightflyer.cli import main, output, progress
from lightflyer.core.progress import Counted, report, report_to


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def shown(monkeypatch):
    """The standard error stream of a command whose every moment is long."""
    monkeypatch.setenv("LIGHTFLYER_PROGRESS", "on")
    monkeypatch.setattr(progress, "_QUIET", 0.0)
    monkeypatch.setattr(progress, "_FIRST", 0.01)
    monkeypatch.setattr(progress, "_EVERY", 0.01)

    def use(stream):
        monkeypatch.setattr("sys.stderr", stream)
        return stream

    return use


def wait_for(text, stream):
    end = time.monotonic() + 20.0
    while text not in stream.getvalue():
        assert time.monotonic() < end, stream.getvalue()
        time.sleep(0.01)


def test_a_pipe_gets_a_line_now_and_then(shown):
    stream = shown(io.StringIO())
    with progress.show_progress("optimise"):
        wait_for("lightflyer: optimise, 0 s\n", stream)
        report("computing designs", 3, 1200, "designs")
        wait_for("lightflyer: computing designs 3 of 1,200 designs, ", stream)
    said = stream.getvalue()
    time.sleep(0.05)
    assert stream.getvalue() == said


def test_a_terminal_gets_a_line_that_moves_and_goes(shown, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    stream = shown(Terminal())
    with progress.show_progress("sweep"):
        counted = Counted("computing designs", 1200, "designs")
        counted.add(600)
        wait_for("600/1200", stream)
        output.printer().print("result")  # ends it
        said = stream.getvalue()
        assert said.endswith("\x1b[2K")  # the line is cleared
        counted.add(600)
        report("something else")
    assert stream.getvalue() == said


def test_it_can_be_switched_off(shown, monkeypatch):
    monkeypatch.setenv("LIGHTFLYER_PROGRESS", "off")
    stream = shown(Terminal())
    with progress.show_progress("sweep"):
        report("computing designs")
        time.sleep(0.05)
    assert stream.getvalue() == ""


def test_every_command_is_shown(shown, monkeypatch, tmp_path):
    stream = shown(io.StringIO())
    begun = []
    monkeypatch.setattr(progress.Display, "start", lambda display: begun.append(display._step))
    with pytest.raises(SystemExit):
        main(["init", str(tmp_path / "flyer.toml")])
    assert [step.doing for step in begun] == ["init"]
    assert stream.getvalue() == ""


def test_parts_are_counted_up_to_their_number():
    steps = []
    with report_to(steps.append):
        counted = Counted("drawing", 5, done=1)
        counted.add(2)
        counted.add(100)
    assert [step.done for step in steps] == [1, 3, 5]
    report("nobody listens")
