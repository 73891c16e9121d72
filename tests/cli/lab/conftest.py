from functools import partial

import pytest

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
    return partial(run, "lab")
