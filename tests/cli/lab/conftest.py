import pytest

from lightflyer.files.result_text import NARROW, unwrap
from lightflyer.lab.synthetic import example_files


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def examples(folder):
    """Write the synthetic files of a measurement."""

    def write(name, seed=0):
        for file, content in example_files(name, seed).files.items():
            data = content if isinstance(content, bytes) else content.encode()
            (folder / file).write_bytes(data)
        return folder

    return write


@pytest.fixture
def lab(run, monkeypatch):
    """Run ``lightflyer lab``; returns exit code, output and errors."""
    monkeypatch.setenv("COLUMNS", "200")

    def command(*arguments):
        code, out, err = run("lab", *arguments)
        lines = out.splitlines()
        # tables keep their digits; of texts only a word may be wider, such as a path
        wide = [line for line in lines if len(line) > NARROW and not line.startswith((" ", "{"))]
        assert all(
            len(word) > NARROW // 3 for line in wide for word in [max(line.split(), key=len)]
        )
        return code, "\n".join([*unwrap(out), ""]) if lines else out, err

    return command


@pytest.fixture
def lab_prints(lab):
    """What a command prints that ends well and says nothing on the error stream."""

    def command(*arguments):
        code, text, errors = lab(*arguments)
        assert (code, errors) == (0, "")
        return text

    return command


@pytest.fixture
def lab_refuses(lab):
    """The one line in which a command says why it does nothing."""

    def command(*arguments):
        code, text, errors = lab(*arguments)
        assert (code, text, errors.count("\n")) == (2, "", 1), errors
        assert errors.startswith("lightflyer: error: ")
        return errors

    return command
