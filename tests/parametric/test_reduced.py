"""What a reduced sweep keeps, beside all designs at once, however it was interrupted."""

import itertools
import logging
import shutil
import threading

import distributed
import jax
import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.parametric.reduced import Blocks, open_reduced, reduce_into
from lightflyer.parametric.reductions import RESOLUTION
from lightflyer.study.distributions import SAMPLE
from lightflyer.study.sections import ReduceSection
from lightflyer.study.study import Dimension, Study, make_study

VARIABLES = ["payload", "temperature", "levitation_irradiance"]
DIAMETERS, ALTITUDES = np.geomspace(0.005, 0.05, 40), np.linspace(60e3, 90e3, 25)
ENTRIES = {"flyer.diameter": DIAMETERS, "altitude": ALTITUDES}
ASKED = ReduceSection(best=("payload", "levitation_irradiance"), designs=7)


@pytest.fixture(scope="module")
def study(flyer):
    return make_study(flyer.design(), ENTRIES, VARIABLES, reduce=ASKED)


def outputs_of(designs):
    """In place of the model: numbers that depend on the design only, with gaps."""
    designs = np.asarray(designs, float)
    payload = 1e-6 * np.sin(designs)
    irradiance = 1000.0 + 500.0 * np.cos(0.7 * designs)
    return {
        "payload": payload,
        "temperature": 300.0 + 50.0 * np.sin(0.3 * designs),
        "levitation_irradiance": np.where(payload > -5e-7, irradiance, np.nan),
    }


class StandIn:
    def __init__(self, after=None, then=None):
        self.asked, self.after, self.then = 0, after, then

    def __call__(self, start, stop):
        self.asked += 1
        if self.asked == self.after:
            self.then()
        return self.at(np.arange(start, stop))

    def at(self, designs):
        return outputs_of(designs), int(np.count_nonzero(np.asarray(designs) % 100 == 0))


@pytest.fixture(scope="module")
def undisturbed(study, tmp_path_factory):
    path = tmp_path_factory.mktemp("reduced") / "whole.nc"
    report = reduce_into(study, path, chunk=100, evaluator=StandIn())
    assert (report.computed, report.found, report.not_converged) == (1000, 0, 10)
    assert [entry.name for entry in path.parent.iterdir()] == ["whole.nc"]
    return open_reduced(path)


def test_the_best_designs_are_those_of_all(undisturbed):
    every = outputs_of(np.arange(1000))
    for name, order in (
        ("payload", np.argsort(-every["payload"])),
        ("levitation_irradiance", np.argsort(every["levitation_irradiance"])),  # NaN comes last
    ):
        best = undisturbed[f"best/{name}"]
        np.testing.assert_array_equal(best.design, order[:7])
        for output, values in every.items():
            np.testing.assert_array_equal(best[output], values[order[:7]])
        np.testing.assert_array_equal(best["flyer.diameter"], DIAMETERS[order[:7] // 25])
        np.testing.assert_array_equal(best.altitude, ALTITUDES[order[:7] % 25])
        assert best[name].attrs["units"]
        assert best.altitude.attrs["units"] == "m"


def test_no_design_that_flies_beats_one_of_a_front(undisturbed):
    every = outputs_of(np.arange(1000))
    altitude = ALTITUDES[np.arange(1000) % 25]
    gain, flies = every["payload"], every["payload"] >= 0.0
    for cost, worth in (("altitude", altitude), ("temperature", -every["temperature"])):
        front = undisturbed[f"fronts/payload_against_{cost}"]
        beaten = [
            np.any(flies & (gain >= gain[n]) & (worth >= worth[n])
                   & ((gain > gain[n]) | (worth > worth[n])))
            for n in range(1000)
        ]  # fmt: skip
        expected = np.flatnonzero(flies & ~np.array(beaten))
        assert sorted(front.design.values) == list(expected)


def test_quantiles_and_histograms_are_those_of_all_designs(undisturbed):
    for name, values in outputs_of(np.arange(1000)).items():
        found = undisturbed[f"distributions/{name}"]
        known = values[np.isfinite(values)]
        assert found.attrs["designs"] == known.size == int(found["count"].sum())
        assert found.attrs["designs without a value"] == 1000 - known.size
        expected = np.quantile(known, found.share, method="inverted_cdf")
        np.testing.assert_allclose(found["quantile"], expected, rtol=RESOLUTION)
        np.testing.assert_array_equal(found["quantile"][[0, -1]], [known.min(), known.max()])
        edges = np.append(found.lower, found.upper[-1])
        exact, _ = np.histogram(known, edges)
        # a cell that an edge divides is counted on one side of it
        assert np.abs(np.cumsum(exact - found["count"].values)).max() < 40
        assert len(exact) > 10


def test_a_killed_sweep_continues_to_the_same_bits(study, undisturbed, tmp_path):
    """What a kill leaves is what lies on the disk then: it is copied while the sweep goes on."""
    path, killed = tmp_path / "r.nc", tmp_path / "k" / "r.nc"

    def copy():
        shutil.copytree(tmp_path / "r.nc.unfinished", killed.parent / "r.nc.unfinished")

    reduce_into(study, path, chunk=100, evaluator=StandIn(6, copy), workers=1, save_every=0.0)
    again = StandIn()
    report = reduce_into(study, killed, chunk=100, evaluator=again)
    assert (report.found, report.computed, again.asked) == (500, 500, 5)
    xr.testing.assert_identical(open_reduced(killed), undisturbed)
    xr.testing.assert_identical(open_reduced(path), undisturbed)
    finished = reduce_into(study, killed, chunk=100, evaluator=StandIn())
    assert (finished.found, finished.computed, finished.not_converged) == (1000, 0, 10)


def test_an_error_keeps_what_was_computed(study, undisturbed, tmp_path):
    def fail():
        raise lf.ConvergenceError("not converged")

    path = tmp_path / "r.nc"
    with pytest.raises(lf.ConvergenceError):
        reduce_into(study, path, chunk=100, evaluator=StandIn(8, fail), workers=1)
    assert not path.exists()
    report = reduce_into(study, path, chunk=100, evaluator=StandIn())
    assert report.found >= 600
    xr.testing.assert_identical(open_reduced(path), undisturbed)


def test_a_cluster_keeps_the_same_bits(study, undisturbed, tmp_path):
    jax.devices()  # started on all processors before workers in this process ask for one
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp",
        dashboard_address=":0", local_directory=tmp_path, silence_logs=logging.CRITICAL,
    ) as cluster:  # fmt: skip
        path, address = tmp_path / "r.nc", cluster.scheduler_address
        reduce_into(study, path, chunk=100, evaluator=StandIn(), scheduler=address)
    xr.testing.assert_identical(open_reduced(path), undisturbed)


def test_what_cannot_be_continued_is_refused(study, tmp_path):
    path, inside, go_on = tmp_path / "r.nc", threading.Event(), threading.Event()

    def wait():
        inside.set()
        assert go_on.wait(20)

    options = {"chunk": 100, "evaluator": StandIn(3, wait), "workers": 1, "save_every": 0.0}
    first = threading.Thread(target=reduce_into, args=(study, path), kwargs=options)
    first.start()
    assert inside.wait(20)
    with pytest.raises(lf.OutputError, match="another process is writing"):
        reduce_into(study, path, evaluator=StandIn())
    copy = tmp_path / "copy.nc.unfinished"
    shutil.copytree(tmp_path / "r.nc.unfinished", copy)
    go_on.set()
    first.join(20)
    other = make_study(study.design, ENTRIES, VARIABLES, reduce=ReduceSection(designs=3))
    with pytest.raises(lf.OutputError, match=r"another study[^$]*best/payload: Best.*count=7"):
        reduce_into(other, path, chunk=100, evaluator=StandIn())
    with pytest.raises(lf.OutputError, match=r"another study"):
        reduce_into(other, tmp_path / "copy.nc", chunk=100, evaluator=StandIn())
    content = (copy / "state.npz").read_bytes()
    middle = len(content) // 2
    flipped = bytes([content[middle] ^ 1])
    for damaged in (content[:-30], b"", content[:middle] + flipped + content[middle + 1 :]):
        (copy / "state.npz").write_bytes(damaged)
        with pytest.raises(lf.OutputError, match=r"is damaged; remove .*copy.nc.unfinished"):
            reduce_into(study, tmp_path / "copy.nc", chunk=100, evaluator=StandIn())
    with pytest.raises(lf.OutputError, match=r"let its name end with .nc"):
        reduce_into(study, tmp_path / "r.zarr", evaluator=StandIn())
    with pytest.raises(lf.ConfigurationError, match="cannot be read as NetCDF"):
        open_reduced(copy / "state.npz")


def test_of_uncertain_designs_the_median_counts(study, tmp_path):
    drawn = {"film.tac_top": np.linspace(0.7, 0.9, 20)}
    dimensions = (Dimension("altitude", {"altitude": np.linspace(60e3, 90e3, 30)}),
                  Dimension(SAMPLE, drawn))  # fmt: skip
    uncertain = Study(study.design, dimensions, {}, tuple(VARIABLES), reduce=ASKED)
    path = tmp_path / "r.nc"
    reduce_into(uncertain, path, chunk=70, evaluator=StandIn())  # three designs of 20 samples
    tree, every = open_reduced(path), outputs_of(np.arange(600))
    medians = np.sort(every["payload"].reshape(30, 20), axis=1)[:, 9]
    best = tree["best/payload"]
    np.testing.assert_array_equal(best.design, np.argsort(-medians)[:7])
    np.testing.assert_array_equal(best.payload, np.sort(medians)[::-1][:7])
    # a sample that no light levitates is the worst
    irradiance = np.nan_to_num(every["levitation_irradiance"].reshape(30, 20), nan=np.inf)
    middle = -np.sort(-irradiance, axis=1)[:, 9]
    np.testing.assert_array_equal(best.levitation_irradiance, middle[best.design])
    assert "film.tac_top" not in best.coords
    assert tree["distributions/payload"].attrs["designs"] == 600


def test_blocks_cover_every_design_once_and_are_never_too_many(study):
    class Huge:
        size = 10**12 + 7
        dimensions = ()

    for asked in (Blocks.of(study, 64), Blocks(1001, 20, 60)):
        spans = [span for block in range(len(asked)) for span in asked.chunks(block)]
        assert spans[0][0] == 0
        assert spans[-1][1] == asked.size == sum(asked.count(n) for n in range(len(asked)))
        assert all(before[1] == after[0] for before, after in itertools.pairwise(spans))
    assert len(Blocks.of(Huge())) <= 10_000


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"best": "lift"}, r'best: "lift" is not in the study; choose from payload'),
        ({"fronts": [("payload", "film.tac")]}, r'fronts: "film.tac" is not in the study'),
        ({"fronts": [("altitude", "payload")]}, r'fronts: "altitude" is not an output'),
        ({"fronts": ["payload"]}, "fronts"),
        ({"designs": 0}, "designs"),
        ({"distributions": ["lift"]}, r'distributions: "lift" is not in the study'),
    ],
)  # fmt: skip
def test_what_the_study_does_not_have_is_refused(flyer, tmp_path, asked, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        lf.parametric.sweep_reduced(
            flyer, over=ENTRIES, outputs=VARIABLES, out=tmp_path / "r.nc", **asked
        )
