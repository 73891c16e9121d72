"""Runs a command of the lab bench on damaged files, and says what is wrong with its answer."""

import contextlib
import io
import json
import math
import os
import shlex
import tempfile
import traceback
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from damage import damaged

from lightflyer import cli
from lightflyer.lab.synthetic import example_files

SHARES = ("emissivity", "emittance", "absorptivity", "absorptance", "transmittance", "reflectance",
          "masked_fraction", "r", "t")  # fmt: skip
"""Numbers that lie between 0 and 1."""

LARGEST_TAC = 2.0
POSITIVE = ("minimum_irradiance", "pressure_at_minimum", "irradiance", "pressure", "rms_height",
            "mean_absolute_height", "area_ratio", "c_fm", "c_cont")  # fmt: skip

_SMALL_MAP = 64  # pixels along a side: a map is reduced in a tenth of a second


class Case(NamedTuple):
    """A command and the files it takes."""

    name: str
    arguments: list[str]
    files: dict[str, bytes]


def cases() -> list[Case]:
    """Every command of the lab bench, and calibration, on its synthetic files."""
    found = []
    for name in ("thermography", "ftir", "tac", "levitation"):
        example = example_files(name)
        files = {key: _bytes(value) for key, value in example.files.items()}
        for command in example.commands:
            words = shlex.split(command.split(" --out")[0])
            used = {key: value for key, value in files.items() if key in words}
            found.append(Case(" ".join([name, *used]), ["lab", *words, "--json"], used))
    for key, value in example_files("roughness").files.items():
        small = _small(value)
        found.append(Case(f"roughness {key}", ["lab", "roughness", key, "--json"], {key: small}))
    points = _bytes(example_files("levitation").files["launchpads.csv"])
    found.append(Case("calibrate points", ["calibrate", "points.csv", "--json"],
                      {"points.csv": points}))  # fmt: skip
    return found


def findings(case: Case, seed: int) -> tuple[list[str], str, int]:
    """Faults of a command's answer to damaged files, the damages, and the exit code.

    Parameters
    ----------
    case : Case
    seed : int

    Returns
    -------
    faults : list of str
        Empty where the answer is a possible result or one clear line.
    damages : str
    code : int
    """
    rng = np.random.default_rng([seed, 2000])
    files = dict(case.files)
    victim = sorted(files)[int(rng.integers(len(files)))]
    files[victim], kinds = damaged(files[victim], rng)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, content in files.items():
            Path(name).write_bytes(content)
        code, out, err = run(case.arguments)
    return list(faults(code, out, err)), f"{victim}: {', '.join(kinds)}", code


def run(arguments: list[str]) -> tuple[int, str, str]:
    """Exit code, output and errors of the command line in this process."""
    out, err = io.StringIO(), io.StringIO()
    code: Any = 0
    os.environ["COLUMNS"] = "200"
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main(arguments)
        except SystemExit as stopped:
            code = stopped.code or 0
        except BaseException as error:  # a traceback is what is looked for
            code = 1
            last = traceback.extract_tb(error.__traceback__)[-1]
            err.write(f"Traceback: {error!r} in {Path(last.filename).name}:{last.lineno}")
    return int(code), out.getvalue(), err.getvalue()


def faults(code: int, out: str, err: str) -> Iterator[str]:
    """What is wrong with an answer.

    Parameters
    ----------
    code : int
    out, err : str
        Output and errors.

    Yields
    ------
    str
    """
    lines = [line for line in err.splitlines() if line.strip()]
    if code == 0:
        try:
            document = json.loads(out, parse_constant=lambda text: float(text))
        except ValueError:
            yield f"no JSON: {out[:60]!r}"
            return
        if "warnings" not in document:
            yield "no list of warnings"
        yield from impossible(document)
    elif code != 2 or "Traceback" in err:
        yield f"exit code {code}: {lines[-1] if lines else ''}"
    elif sum("error:" in line for line in lines) != 1:
        yield f"{len(lines)} lines of error: {err[:120]!r}"


def impossible(document: Any, place: str = "", name: str = "") -> Iterator[str]:
    """Impossible numbers of a JSON document.

    Parameters
    ----------
    document : object
    place : str
        Keys that lead to it.
    name : str
        Last key that names a number.

    Yields
    ------
    str
    """
    if isinstance(document, Mapping):
        if "value" in document and "interval_95" in document:
            yield from _outside(document, place, name)
        for key, value in document.items():
            if key not in ("value", "interval_95", "rejected"):
                yield from impossible(value, f"{place}.{key}", key)
    elif isinstance(document, list):
        for number, value in enumerate(document):
            yield from impossible(value, f"{place}[{number}]", name)
    elif isinstance(document, float) and not math.isfinite(document):
        yield f"{place} is {document}"


def _outside(estimate: Mapping[str, Any], place: str, name: str) -> Iterator[str]:
    value, (low, high) = estimate["value"], estimate["interval_95"]
    if value is None:
        return
    if not math.isfinite(value):
        yield f"{place} is {value}"
        return
    said = f"{place} = {value:.4g} ({low} to {high}) {estimate.get('unit', '')}"
    slack = 1e-9 * max(abs(value), 1e-30)
    if (low is not None and low > value + slack) or (high is not None and high < value - slack):
        yield f"{said}: the interval leaves the value out"
    short = name.removesuffix("_all")
    if short in SHARES and not 0.0 <= value <= 1.0:
        yield f"{said}: not between 0 and 1"
    if short in SHARES and any(end is not None and not 0.0 <= end <= 1.0 for end in (low, high)):
        yield f"{said}: the interval leaves 0 to 1"
    if (short == "tac" or short.startswith("tac_")) and not 0.0 < value <= LARGEST_TAC:
        yield f"{said}: no accommodation coefficient"
    if short in POSITIVE and value < 0.0:
        yield f"{said}: negative"


def _bytes(content: str | bytes) -> bytes:
    return content if isinstance(content, bytes) else content.encode()


def _small(content: str | bytes) -> bytes:
    """A corner of a text map; binary maps as they are."""
    if not isinstance(content, str):
        return content
    head = [line for line in content.splitlines() if line.startswith("#")]
    rows = [line for line in content.splitlines() if not line.startswith("#")][:_SMALL_MAP]
    return "\n".join([*head, *("\t".join(row.split()[:_SMALL_MAP]) for row in rows), ""]).encode()
