#!/usr/bin/env -S uv run --script

# /// script
# dependencies = ["nox>=2025.10.14"]
# ///
"""Sessions beside ``make``, in environments of their own: other Pythons and other versions."""

import nox

nox.needs_version = ">=2025.10.14"
nox.options.default_venv_backend = "uv"

COMPILE = "--compile-bytecode"  # or others' odd literals warn in tests, as errors


@nox.session(venv_backend="none")
def check(session: nox.Session) -> None:
    """All that continuous integration checks, with the versions of the lock file."""
    session.run("make", "check", external=True)


@nox.session(default=False, venv_params=["--seed"], python=["3.11", "3.12", "3.13", "3.14"])
def newest(session: nox.Session) -> None:
    """Tests with the newest versions."""
    session.install(".[all]", "--group", "test", COMPILE)
    session.run("pytest", *session.posargs)


@nox.session(default=False, venv_params=["--seed"], python="3.11")
def lowest(session: nox.Session) -> None:
    """Tests with the lowest versions that pyproject.toml allows."""
    session.install(".[all]", "--group", "test", "--resolution", "lowest-direct", COMPILE)
    session.run("pytest", *session.posargs)


@nox.session(default=False, venv_params=["--seed"])
def sdist(session: nox.Session) -> None:
    """Tests from the unpacked source distribution."""
    session.install("build")
    folder = session.create_tmp()
    session.run("python", "-m", "build", "--outdir", folder)
    session.install(".[all]", "--group", "test", COMPILE)
    session.chdir(folder)
    session.run("bash", "-c", "tar xzf lightflyer-*.tar.gz", external=True)
    session.run("bash", "-c", "cd lightflyer-*/ && pytest", external=True)


if __name__ == "__main__":
    nox.main()
