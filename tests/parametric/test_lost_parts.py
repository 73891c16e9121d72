"""A sweep that lost a part is refused in a line by whatever reads it; the same sweep mends it."""

import json
import pickle
import shutil

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.compute import store
from lightflyer.parametric import explore
from lightflyer.parametric.run import sweep_into
from lightflyer.study.sections import SamplingSection
from lightflyer.study.study import make_study

VARIABLES = ["temperature", "lift", "relative_payload", "levitation_irradiance"]
ENTRIES = {
    "flyer.diameter": np.geomspace(0.005, 0.05, 40),
    "altitude": np.linspace(60e3, 90e3, 25),
}
CHUNK, STUDY = "relative_payload/c/3/0", ".lightflyer/study.json"
JOURNAL, COORDINATE = ".lightflyer/journal", "flyer.diameter/c/0"


def outputs(start, stop):
    """In place of the model: numbers that depend on the design only."""
    designs = np.arange(start, stop)
    return {name: np.sin(designs + n) for n, name in enumerate(VARIABLES)}, 0


def flip(path, at=0.4):
    content = bytearray(path.read_bytes())
    content[int(at * len(content))] ^= 4
    path.write_bytes(content)


def cut(path, by=9):
    path.write_bytes(path.read_bytes()[:-by])


def change(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def drop_line(path):
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:-1]))


LOSSES = {
    # what is done to a sweep beside another one, and what the line names
    "a chunk missing": (lambda d, _: (d / CHUNK).unlink(), CHUNK),
    "all chunks of an output missing": (lambda d, _: shutil.rmtree(d / "lift/c"), "lift/c/0/0"),
    "a chunk cut": (lambda d, _: cut(d / CHUNK), CHUNK),
    "a chunk empty": (lambda d, _: (d / CHUNK).write_bytes(b""), CHUNK),
    "a chunk longer": (lambda d, _: (d / CHUNK).write_bytes(bytes(8) + (d / CHUNK).read_bytes()),
                       CHUNK),
    "a bit of a chunk flipped": (lambda d, _: flip(d / CHUNK), CHUNK),
    "a bit of its checksum flipped": (lambda d, _: flip(d / CHUNK, 0.999), CHUNK),
    "a chunk of zeros": (lambda d, _: (d / CHUNK).write_bytes(bytes(804)), CHUNK),
    "a chunk of another sweep": (lambda d, o: shutil.copy(o / CHUNK, d / CHUNK), CHUNK),
    "a chunk of another place": (
        lambda d, _: shutil.copy(d / "relative_payload/c/2/0", d / CHUNK), CHUNK),
    "a chunk of another output": (lambda d, _: shutil.copy(d / "lift/c/3/0", d / CHUNK), CHUNK),
    "the journal missing": (lambda d, _: (d / JOURNAL).unlink(), "journal has 0 of 10 chunks"),
    "the journal older": (lambda d, _: drop_line(d / JOURNAL), "journal has 9 of 10 chunks"),
    "a bit of the journal flipped": (lambda d, _: flip(d / JOURNAL), "journal has 9 of 10 chunks"),
    "the journal of another sweep": (lambda d, o: shutil.copy(o / JOURNAL, d / JOURNAL), "/c/"),
    "all records of another sweep": (
        lambda d, o: shutil.copytree(o / ".lightflyer", d / ".lightflyer", dirs_exist_ok=True),
        "flyer.diameter"),
    "hidden files not copied": (lambda d, _: shutil.rmtree(d / ".lightflyer"), ".lightflyer"),
    "the study missing": (lambda d, _: (d / STUDY).unlink(), STUDY),
    "the study torn": (lambda d, _: (d / STUDY).write_text("{"), STUDY),
    "the study empty": (lambda d, _: (d / STUDY).write_text("{}"), STUDY),
    "the study a list": (lambda d, _: (d / STUDY).write_text("[]"), STUDY),
    "a bit of the study flipped": (lambda d, _: flip(d / STUDY, 0.1), STUDY),
    "a coordinate missing": (lambda d, _: shutil.rmtree(d / "flyer.diameter/c"), "flyer.diameter"),
    "a coordinate of another sweep": (
        lambda d, o: shutil.copy(o / COORDINATE, d / COORDINATE), "flyer.diameter"),
    "a bit of a coordinate flipped": (lambda d, _: flip(d / COORDINATE), "flyer.diameter"),
    "a unit altered": (
        lambda d, _: change(d / "zarr.json", '"units": "N"', '"units": "M"'), "two descriptions"),
    "an attribute altered": (lambda d, _: change(d / "zarr.json", "sweep", "swelp"), "zarr.json"),
    "the description of an output missing": (
        lambda d, _: (d / "lift/zarr.json").unlink(), "lift/zarr.json"),
    "the description of the group cut": (lambda d, _: cut(d / "zarr.json", 400), "Zarr group"),
}  # fmt: skip


# designs that need not be computed anew; none where a description or a coordinate is lost
FOUND = {CHUNK: 900, "journal has 9 of 10 chunks": 900, "journal has 0 of 10 chunks": 0,
         "lift/c/0/0": 0, "/c/": 0}  # fmt: skip


def by_map(folder, run):
    over = ("--x", "diameter", "--y", "altitude", "--value", "relative_payload")
    code, text, errors = run("map", folder, *over, "--out", folder.parent / "map")
    assert (code, text) == (2, ""), text
    return errors


def by_open(read):
    def reader(folder, run):
        with pytest.raises(lf.ConfigurationError) as error:
            read(folder)
        return str(error.value)

    return reader


READERS = {
    "map": by_map,
    "open_sweep": by_open(lambda folder: lf.parametric.open_sweep(folder).load()),
    "best_designs": by_open(lambda folder: lf.parametric.best_designs(folder, "relative_payload")),
    "pareto_front": by_open(
        lambda folder: lf.parametric.pareto_front(folder, "relative_payload", "altitude")
    ),
    "quantiles": by_open(lambda folder: lf.parametric.quantiles(folder, "relative_payload")),
    "plot_sweep": by_open(
        lambda folder: lf.parametric.plot_sweep(
            lf.parametric.open_sweep(folder), "relative_payload", "diameter", "altitude"
        )
    ),
}


@pytest.fixture(scope="module")
def sweeps(design, tmp_path_factory):
    """A finished sweep, and another of the same shape."""
    folder = tmp_path_factory.mktemp("sweeps")
    sweep_into(make_study(design, ENTRIES, VARIABLES), folder / "one", chunk=100, evaluator=outputs)
    other = {**ENTRIES, "flyer.diameter": np.geomspace(0.006, 0.05, 40)}

    def more(start, stop):
        return {name: np.cos(np.arange(start, stop) + n) for n, name in enumerate(VARIABLES)}, 0

    sweep_into(make_study(design, other, VARIABLES), folder / "other", chunk=100, evaluator=more)
    return folder


@pytest.mark.parametrize("loss", LOSSES)
def test_a_lost_part_is_a_line_for_all_who_read_and_mended(sweeps, design, tmp_path, run, loss):
    folder = tmp_path / "v.zarr"
    shutil.copytree(sweeps / "one", folder)
    (lose, named) = LOSSES[loss]
    lose(folder, sweeps / "other")
    for name, read in READERS.items():
        line = read(folder, run)
        assert named in line, name
        assert len(line.strip().splitlines()) == 1, name
    study = make_study(design, ENTRIES, VARIABLES)
    if "mends it" in line and "all records" not in loss:
        report = sweep_into(study, folder, chunk=100, evaluator=outputs)
        found = FOUND.get(named, 1000)
        assert (report.found, report.computed) == (found, 1000 - found)
        for path in (sweeps / "one").rglob("[!j]*"):  # lines of the journal may change places
            if path.is_file():
                assert (folder / path.relative_to(sweeps / "one")).read_bytes() == path.read_bytes()
    else:
        before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        with pytest.raises(lf.OutputError):
            sweep_into(study, folder, chunk=100, evaluator=outputs)
        assert before == {path: path.read_bytes() for path in before}


def test_a_bit_that_flips_once_a_sweep_is_open_is_found_too(sweeps, tmp_path):
    folder = tmp_path / "v.zarr"
    shutil.copytree(sweeps / "one", folder)
    dataset = pickle.loads(pickle.dumps(lf.parametric.open_sweep(folder)))
    flip(folder / CHUNK)
    with pytest.raises(lf.ConfigurationError, match=f"{CHUNK} is not as it was written"):
        dataset.relative_payload.load()
    with pytest.raises(lf.ConfigurationError, match=f"{CHUNK} is not as it was written"):
        lf.parametric.open_sweep(folder).relative_payload.chunk().max().compute()
    (folder / CHUNK).unlink()
    with pytest.raises(lf.ConfigurationError, match=f"{CHUNK} is missing"):
        dataset.relative_payload.load()


def test_what_is_not_done_is_blank_and_said(sweeps, design, tmp_path, run):
    """Of a sweep that goes on in another process, files that do not count yet are not read."""
    folder = tmp_path / "v.zarr"
    shutil.copytree(sweeps / "one", folder)
    drop_line(folder / JOURNAL)
    content = json.loads((folder / "zarr.json").read_text(encoding="utf-8"))
    content["attributes"]["complete"] = False
    (folder / "zarr.json").write_text(json.dumps(content), encoding="utf-8")
    dataset = lf.parametric.open_sweep(folder)
    assert not dataset.attrs["complete"]
    assert int(dataset.relative_payload.isnull().sum()) == 100
    over = ("--x", "altitude", "--value", "lift")
    code, text, errors = run("map", folder, *over, "--out", tmp_path / "map")
    assert code == 0, errors
    assert "the sweep is not finished" in text


def test_workers_that_died_leave_nothing_in_a_finished_sweep(design, tmp_path):
    folder = tmp_path / "v.zarr"

    def dying(start, stop):
        (folder / "lift" / "0.abc.partial").write_bytes(b"0")
        (folder / ".lightflyer" / "repair-abc" / "lift").mkdir(parents=True, exist_ok=True)
        return outputs(start, stop)

    sweep_into(make_study(design, ENTRIES, VARIABLES), folder, chunk=100, evaluator=dying)
    assert not [*folder.rglob("*.partial"), *folder.rglob("repair-*")]


def test_parts_of_a_sweep_are_no_folders_for_others(sweeps, design, tmp_path, run):
    folder = tmp_path / "v.zarr"
    shutil.copytree(sweeps / "one", folder)
    with pytest.raises(lf.OutputError, match="is within the sweep"):
        sweep_into(make_study(design, ENTRIES, VARIABLES), folder / "more", evaluator=outputs)
    with pytest.raises(lf.ConfigurationError, match="is a part of a sweep; name its folder"):
        lf.parametric.open_sweep(folder / "lift")
    twice = "altitude = 70 km, altitude = 80 km"
    over = ("--x", "diameter", "--value", "lift", "--out", tmp_path / "m")
    code, _, errors = run("map", folder, *over, "--at", twice)
    assert (code, errors) == (2, 'lightflyer: error: --at "altitude" is given twice\n')


def test_impossible_shares_of_distributions_are_told(design):
    entries = {"film.emittance": "0.08 ± 0.2"}
    with pytest.warns(lf.ParameterWarning, match="film.emittance: 34 % of the distribution is"):
        make_study(design, entries, ["own_mass"])


@pytest.mark.parametrize(("names", "entry"), [
    (["usable", "relative_payload"], [0.06, 0.08]), (["relative_payload", "lift"], "0.08 ± 0.01"),
    (["levitation_irradiance", "lift"], [0.06, 0.08]),
])  # fmt: skip
def test_maps_of_unfinished_sweeps_are_drawn(design, tmp_path, run, names, entry):
    folder, drawn = tmp_path / "v.zarr", isinstance(entry, str)
    entries = {**ENTRIES, "film.emittance": entry}
    study = make_study(design, entries, names, SamplingSection(points=8))

    def some(start, stop):
        if start >= 2 * study.size // 5:
            raise KeyboardInterrupt
        found = {name: 1.0 + np.sin(np.arange(start, stop)) for name in names}
        found |= {"usable": 1.0 * (found[names[-1]] > 1.0)} if "usable" in names else {}
        return found, 0

    with pytest.raises(KeyboardInterrupt):
        sweep_into(study, folder, chunk=study.size // 10, evaluator=some, workers=1)
    for over in (("--x", "diameter"), ("--x", "diameter", "--y", "altitude")):
        at = () if drawn else ("--at", "emittance = 0.06")
        shown = ("--value", names[-1], "--out", tmp_path / "m", "--format", "svg")
        code, text, errors = run("map", folder, *over, *at, *shown)
        assert code == 0, errors
        assert "the sweep is not finished; missing designs are left blank" in text
    able = explore.margin(lf.parametric.open_sweep(folder))
    assert bool(able.isel({"flyer.diameter": -1}).isnull().all())  # neither flies nor does not
    assert bool(able.isel({"flyer.diameter": 0}).notnull().all())


def test_stores_of_the_last_version_are_read_and_their_chunks_compared(sweeps, tmp_path):
    """Which recorded no checksums of coordinates and descriptions."""
    folder = tmp_path / "v.zarr"
    shutil.copytree(sweeps / "one", folder)
    record = json.loads((folder / STUDY).read_text(encoding="utf-8"))
    kept = {name: record[name] for name in ("token", "block", "description")}
    (folder / STUDY).write_text(json.dumps(kept), encoding="utf-8")
    whole = lf.parametric.open_sweep(sweeps / "one").load()
    xr.testing.assert_identical(lf.parametric.open_sweep(folder).load(), whole)
    for block in ([25], [0, 25], ["4", 25], [4, 25, 1]):
        (folder / STUDY).write_text(json.dumps(kept | {"block": block}), encoding="utf-8")
        with pytest.raises(lf.ConfigurationError, match=r"study\.json is "):
            lf.parametric.open_sweep(folder)
    (folder / STUDY).write_text(json.dumps(kept), encoding="utf-8")
    with (folder / JOURNAL).open("ab") as journal:
        journal.write(store._journal_line({"chunk": "0"}))  # nothing that was ever written
    (folder / CHUNK).unlink()
    with pytest.raises(lf.ConfigurationError, match=f"{CHUNK} is missing"):
        lf.parametric.open_sweep(folder)
