"""The outputs of sweeps beside what the package computes for one design at a time."""

import itertools
import pickle

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.compute.evaluation import FEW, FEW_OVER_BAND, Chunks, Evaluator
from lightflyer.config.designs import as_design
from lightflyer.parametric import run
from lightflyer.parametric.run import open_sweep
from lightflyer.study.study import make_study

POINT_OUTPUTS = [
    "pressure",
    "gas_temperature",
    "temperature",
    "lift",
    "lift_over_weight",
    "payload",
    "relative_payload",
    "payload_per_area",
    "usable",
    "covered",
    "levitation_irradiance",
    "levitation_temperature",
    "own_mass",
    "areal_density",
    "absorptance",
]


@pytest.fixture(scope="module")
def over():
    return {
        "flyer.diameter": np.geomspace(0.005, 0.05, 5),
        "film.emittance": [0.06, 0.12],
        "environment.incidence": ["0 deg", "45 deg"],
        "altitude": {"from": "62 km", "to": "88 km", "points": 7},
    }


@pytest.fixture(scope="module")
def table(flyer, over):
    return lf.sweep(flyer, over=over, outputs=POINT_OUTPUTS)


def test_numpy_gives_what_a_compiled_sweep_gives(flyer, over, table, monkeypatch):
    monkeypatch.setattr("lightflyer.compute.evaluation.FEW", 0)
    compiled = lf.sweep(flyer, over=over, outputs=POINT_OUTPUTS)
    for name in POINT_OUTPUTS:
        size = float(np.abs(compiled[name]).max())  # a payload may be nearly none
        np.testing.assert_allclose(
            table[name], compiled[name], rtol=1e-9, atol=1e-9 * size, err_msg=name
        )


def test_a_number_that_the_file_does_not_state_is_varied(flyer):
    gravity = np.array([9.0, 10.0])
    over = {"environment.gravity": [f"{value} m/s^2" for value in gravity], "altitude": ["70 km"]}
    swept = lf.sweep(flyer, over=over, outputs=["lift", "lift_over_weight"])
    weight = (swept.lift / swept.lift_over_weight).values[:, 0]
    mass = float(flyer.design().setup.flyer.mass)
    assert weight == pytest.approx(mass * gravity, rel=1e-12)


@pytest.mark.parametrize(("outputs", "few"), [("lift", FEW), ("lowest_altitude", FEW_OVER_BAND)])
def test_few_designs_are_not_compiled_and_all_of_a_study_run_one_way(
    flyer, outputs, few, monkeypatch
):
    place = {"altitude": ["70 km"]} if outputs == "lift" else {}

    def way(count, device=None):
        over = {"flyer.diameter": np.linspace(0.005, 0.05, count), **place}
        return Evaluator(make_study(flyer.design(), over, (outputs,)), device).by_jax

    assert [way(few), way(few + 1), way(few, "cpu")] == [False, True, True]
    monkeypatch.setattr("lightflyer.compute.evaluation.has_jax", lambda: False)
    assert not way(few + 1)


def test_each_design_is_what_its_flyer_file_predicts(film_section, table):
    """Against predict, from a flyer file with the design's numbers written into it."""
    for diameter, emittance, incidence in itertools.product([0, 3], [0, 1], [0, 1]):
        part = table.isel(
            {"flyer.diameter": diameter, "film.emittance": emittance,
             "environment.incidence": incidence}
        )  # fmt: skip
        written = lf.FlyerFile(
            flyer={"diameter": f"{float(part['flyer.diameter']):.17g} m"},
            film=film_section | {"emittance": float(part["film.emittance"])},
            environment={
                "atmosphere": "lu2023",
                "incidence": f"{float(part['environment.incidence']):.17g} deg",
            },
            force={"model": "lu2023"},
        )
        found = lf.predict(written, at=part.altitude.values).at
        # differences of nearly equal numbers are as exact as these
        larger = {
            "payload": part.own_mass.values.max(),
            "relative_payload": 1.0,
            "payload_per_area": part.own_mass.values.max() / 1e-4,
        }
        for name, values in found.items():
            expected = np.where(np.isfinite(values), values, np.nan)
            smallest = 1e-9 * larger.get(name, 1e-11)
            np.testing.assert_allclose(part[name], expected, rtol=1e-9, atol=smallest, err_msg=name)


def test_bits_do_not_depend_on_how_designs_are_divided(flyer, over):
    """An odd number at once leaves a rest for the processor's scalar instructions."""
    evaluate = Evaluator(make_study(flyer.design(), over, POINT_OUTPUTS))
    whole, _ = evaluate(0, evaluate.study.size)
    evaluate.batch = 61
    parts = [evaluate(start, min(start + 100, evaluate.study.size))[0] for start in (0, 100)]
    for name, values in whole.items():
        np.testing.assert_array_equal(np.concatenate([part[name] for part in parts]), values)


def test_a_dataset_has_its_fields_units_and_versions(table):
    assert list(table.dims) == [
        "flyer.diameter",
        "film.emittance",
        "environment.incidence",
        "altitude",
    ]
    for name in (*table.coords, *table.data_vars):
        assert table[name].attrs["units"], name
        assert table[name].attrs["long_name"], name
    assert table["flyer.diameter"].attrs["units"] == "m"
    assert table["environment.incidence"].attrs["units"] == "degree"
    assert np.isnan(table.levitation_irradiance).any()  # where no irradiance levitates it
    assert table.attrs["not_converged"] == 0
    assert table.attrs["lightflyer_version"] == lf.__version__
    assert "jaxlib" in table.attrs["versions"]


def test_memory_is_asked_for_before_it_is_taken(flyer, monkeypatch):
    many = {
        "flyer.diameter": {"from": "1 cm", "to": "2 cm", "points": 10_000},
        "film.absorptance": {"from": 0.5, "to": 0.7, "points": 10_000},
        "altitude": {"from": "60 km", "to": "70 km", "points": 100},
    }
    with pytest.raises(
        lf.ConfigurationError, match=r"1e\+10 designs need about 480 GB .*a folder takes them"
    ):
        lf.sweep(flyer, over=many, outputs="lift")
    monkeypatch.setattr(run, "_GIGABYTE", 100.0)
    few = many | {"film.absorptance": 0.5, "flyer.diameter": "1 cm"}
    with pytest.warns(lf.ParameterWarning, match="100 designs need about"):
        lf.sweep(flyer, over=few, outputs="lift")


def test_in_a_folder_it_is_the_same(flyer, over, table, tmp_path):
    stored = lf.sweep(flyer, over=over, outputs=POINT_OUTPUTS, out=tmp_path / "results.zarr")
    xr.testing.assert_identical(stored.drop_attrs(deep=False), table.drop_attrs(deep=False))
    assert stored.attrs["complete"]
    assert stored.attrs["not_converged"] == 0
    again = xr.open_zarr(tmp_path / "results.zarr")  # as anybody would, and by way of Dask
    xr.testing.assert_identical(again.load(), stored.load())


def test_samples_share_a_dimension_and_one_value_is_none(flyer):
    found = lf.sweep(
        flyer,
        over={
            "film.tac_top": "0.80 ± 0.01",
            "film.tac_bottom": {"distribution": "uniform", "from": 0.88, "to": 0.92},
            "flyer.diameter": "2 cm",
            "altitude": ["70 km", "72 km"],
        },
        outputs="lift",
        points=8,
    )
    assert found.lift.dims == ("altitude", "sample")
    assert found["film.tac_top"].dims == ("sample",)
    assert found["flyer.diameter"].dims == ()
    design = found.isel(altitude=1, sample=3)
    film = lf.FilmProperties(
        1e-3, 0.75, 0.08, 0.08, float(design["film.tac_top"]), float(design["film.tac_bottom"])
    )
    expected = lf.lift(lf.Disk(film, 0.01), lf.lu2023_earth().state(72e3), lf.Lu2023())
    assert float(design.lift) == pytest.approx(float(expected), rel=1e-9)


@pytest.mark.parametrize("few", [9, 0])
def test_designs_whose_numbers_contradict_each_other_have_no_value(flyer, few, monkeypatch):
    monkeypatch.setattr("lightflyer.compute.evaluation.FEW", few)
    size = np.array([0.01, 0.02, 0.03])
    over = {"flyer.diameter": size, "flyer.hanging_radius": 0.4 * size, "altitude": ["70 km"]}
    lift = lf.sweep(flyer, over=over, outputs=["lift"]).lift.squeeze()
    within = np.greater.outer(0.5 * size, 0.4 * size)  # the circle from which a payload hangs
    np.testing.assert_array_equal(np.isfinite(lift), within)
    shares = [0.2, 0.5, 0.7]  # of a film: what it absorbs and what passes
    over = {"film.absorptance": shares, "film.transmittance": shares, "altitude": ["70 km"]}
    of_object = {f"flyer.{name}" if "film" in name else name: axis for name, axis in over.items()}
    for what, axes in ((flyer, over), (flyer.build(), of_object)):
        lift = lf.sweep(what, over=axes, outputs=["lift"]).lift.squeeze()
        np.testing.assert_array_equal(np.isfinite(lift), np.add.outer(shares, shares) <= 1.0)


def test_bands_over_diameter(flyer):
    found = lf.sweep(
        flyer,
        over={"flyer.diameter": ["2 cm", "8 cm"]},
        outputs=["lowest_altitude", "highest_altitude", "band_width", "own_mass"],
    )
    first, second = found.isel({"flyer.diameter": 0}), found.isel({"flyer.diameter": 1})
    assert float(first.lowest_altitude) == pytest.approx(68.022e3, abs=1.0)  # as `predict` finds
    assert float(first.highest_altitude) == pytest.approx(78.047e3, abs=1.0)
    assert float(first.band_width) == pytest.approx(10.025e3, abs=2.0)
    assert np.isnan(second.lowest_altitude)
    assert float(second.band_width) == 0.0


def test_a_chamber_goes_by_pressure(film_section, film):
    flyer = lf.FlyerFile(
        flyer={"diameter": "2 cm"},
        film=film_section,
        environment={"kind": "chamber", "temperature": "293 K"},
        force={"model": "lu2023"},
    )
    found = lf.sweep(flyer, over={"pressure": ["3 Pa", "10 Pa"]}, outputs="levitation_irradiance")
    state = lf.Chamber().state(np.array([3.0, 10.0]))
    expected = lf.levitate(lf.Disk(film, 0.01), state, lf.Lu2023()).irradiance
    np.testing.assert_allclose(found.levitation_irradiance, expected, rtol=1e-9)
    with pytest.raises(lf.ConfigurationError, match="is not a number of the design"):
        lf.sweep(flyer, over={"altitude": ["70 km"]}, outputs=["lift"])
    with pytest.raises(lf.ConfigurationError, match="needs an atmosphere"):
        lf.sweep(flyer, over={"flyer.diameter": ["2 cm"]}, outputs=["band_width"])


def test_layers_are_computed_for_each_thickness():
    layers = [
        {"material": "Al2O3", "thickness": "10 nm"},
        {"material": "Ge", "thickness": "20 nm"},
        {"material": "PET", "thickness": "500 nm"},
        {"material": "Ge", "thickness": "20 nm"},
    ]
    film = {"layers": layers, "emittance": 0.08, "tac_top": 0.8, "tac_bottom": 0.9}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    names = ["film.layers.3.thickness", "film.tac_top", "altitude"]
    over = dict(zip(names, (["10 nm", "30 nm"], [0.7, 0.8], ["70 km"]), strict=True))
    found = lf.sweep(flyer, over=over, outputs=["payload", "absorptance", "areal_density"])
    layers[3] = {"material": "Ge", "thickness": "30 nm"}
    written = lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film=film | {"layers": layers}, force={"model": "lu2023"}
    )
    setup = written.build()
    disk = setup.flyer
    part = found.isel({names[0]: 1, names[1]: 1, names[2]: 0})
    assert float(part.absorptance) == pytest.approx(float(disk.film.absorptance), rel=1e-12)
    assert float(part.areal_density) == pytest.approx(float(disk.film.areal_density), rel=1e-12)
    expected = lf.payload(disk, setup.environment.state(70e3), setup.model)
    assert float(part.payload) == pytest.approx(float(expected), rel=1e-9)
    thinner = found.isel({names[0]: 0, names[1]: 1, names[2]: 0})
    assert float(thinner.areal_density) < float(part.areal_density)
    assert not np.isclose(float(found.payload[1, 0, 0]), float(found.payload[1, 1, 0]))
    # a measured number varies over layers that stay as they are
    varied = lf.sweep(written, over={"film.tac_top": [0.7, 0.8]}, outputs=["absorptance"])
    np.testing.assert_allclose(varied.absorptance, float(disk.film.absorptance), rtol=1e-12)


def test_labelled_arrays_keep_their_dimensions_and_stay_with_dask(flyer, film):
    diameter = xr.DataArray(np.linspace(0.01, 0.03, 6), dims="design")
    irradiance = xr.DataArray(np.linspace(800.0, 1360.0, 6), dims="design")
    over = {
        "flyer.diameter": diameter,
        "environment.irradiance": irradiance,
        "altitude": ["70 km", "74 km"],
    }
    plain = lf.sweep(flyer, over=over, outputs=["lift", "temperature"])
    assert plain.lift.dims == ("design", "altitude")
    lazy = lf.sweep(
        flyer,
        over=over | {"flyer.diameter": diameter.chunk(design=4)},
        outputs=["lift", "temperature"],
    )
    assert lazy.lift.chunks == ((4, 2), (2,))
    np.testing.assert_array_equal(lazy.lift.compute(), plain.lift)
    state = lf.lu2023_earth(irradiance=irradiance.values).state(74e3)
    expected = lf.lift(lf.Disk(film, 0.5 * diameter.values), state, lf.Lu2023())
    np.testing.assert_allclose(plain.lift.isel(altitude=1), expected, rtol=1e-9)
    assert plain["flyer.diameter"].attrs["units"] == "m"
    with pytest.raises(lf.ConfigurationError, match=r"flyer.diameter = -1 is not positive"):
        lf.sweep(flyer, over=over | {"flyer.diameter": 0.0 * diameter - 1.0}, outputs="lift")


def test_objects_give_what_their_flyer_file_gives(table):
    film = lf.FilmProperties(1e-3, 0.75, 0.12, 0.12, tac_top=0.8, tac_bottom=0.9)
    found = lf.sweep(
        lf.Disk(film, radius=0.01),
        lf.lu2023_earth(),
        lf.Lu2023(),
        over={
            "flyer.radius": 0.5 * table["flyer.diameter"].values,
            "environment.radiation.zenith_angle": ["0 deg", "45 deg"],
            "altitude": {"from": "62 km", "to": "88 km", "points": 7},
        },
        outputs=POINT_OUTPUTS,
    )
    assert found["flyer.radius"].attrs == {"units": "m", "long_name": "flyer radius"}
    for name in POINT_OUTPUTS:
        expected = table[name].sel({"film.emittance": 0.12})
        assert found[name].attrs == expected.attrs
        np.testing.assert_allclose(found[name], expected, rtol=1e-12, atol=1e-18, err_msg=name)


def test_designs_of_equal_objects_are_equal(film):
    setup = lf.Setup(lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023())
    same = lf.Setup(lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023())
    other = lf.Setup(lf.Disk(film, radius=0.02), lf.lu2023_earth(), lf.Lu2023())
    assert as_design(setup) == as_design(same)  # so that it is compiled once
    assert hash(as_design(setup)) == hash(as_design(same))
    assert as_design(setup) != as_design(other)
    assert pickle.loads(pickle.dumps(as_design(setup))) == as_design(setup)


def test_arguments_that_cannot_be_used(flyer):
    for arguments, message in (
        ({"over": {}}, "over names no number"),
        ({"over": {"altitude": 70e3}}, r"altitude: 70000.0 has no unit"),
        ({"over": {"altitude": ["70 km"]}, "points": 0}, r"points = 0: must be at least 1"),
        (
            {"over": {"altitude": ["70 km"]}, "method": "sobl"},
            'method = "sobl" is unknown; did you mean "sobol"?',
        ),
        ({"over": {"altitude": ["70 km"]}, "scheduler": "tcp://x"}, "give out as well"),
        ({"over": {"altitude": ["70 km"]}, "outputs": "paylod"}, 'did you mean "payload"'),
    ):
        with pytest.raises(lf.ConfigurationError, match=message):
            lf.sweep(flyer, **arguments)
    with pytest.raises(lf.ParameterError, match="needs an environment and a force model"):
        lf.sweep(flyer.build().flyer, over={"altitude": ["70 km"]})


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(lf.ConfigurationError, match="is not a sweep"):
        open_sweep(tmp_path)


@pytest.mark.parametrize("shape", [(), (1,), (7,), (20, 3, 61), (4, 1000), (5, 2, 3, 2), (2, 1500)])
@pytest.mark.parametrize("most", [1, 7, 64, 1200])
def test_chunks_are_consecutive_and_cover_the_grid_once(shape, most):
    chunks, end = Chunks.of(shape, most), 0
    numbers = np.arange(np.prod(shape, dtype=int)).reshape(shape)
    for chunk in range(len(chunks)):
        start, stop = chunks.span(chunk)
        assert start == end
        assert 0 < stop - start <= most
        end = stop
        corner = [n * b for n, b in zip(chunks.place(chunk), chunks.block, strict=True)]
        part = numbers[
            tuple(slice(c, c + e) for c, e in zip(corner, chunks.extent(chunk), strict=True))
        ]
        np.testing.assert_array_equal(np.ravel(part), np.arange(start, stop))
    assert end == numbers.size
