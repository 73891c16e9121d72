"""Reading the results of a sweep."""

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.parametric import explore


@pytest.fixture
def dataset(rng):
    payload = rng.normal(size=(7, 5, 6))
    payload[2, 3, 4] = np.nan
    return xr.Dataset(
        {
            "payload": (("flyer.diameter", "film.emittance", "altitude"), payload, {"units": "kg"}),
            "temperature": (
                ("flyer.diameter", "film.emittance", "altitude"),
                rng.uniform(300.0, 400.0, payload.shape),
                {"units": "K"},
            ),
        },
        coords={
            "flyer.diameter": ("flyer.diameter", np.linspace(0.01, 0.04, 7), {"units": "m"}),
            "film.emittance": ("film.emittance", np.linspace(0.1, 0.5, 5), {"units": "1"}),
            "altitude": ("altitude", np.linspace(60e3, 85e3, 6), {"units": "m"}),
            "environment.incidence": ((), 30.0, {"units": "degree"}),
        },
    )


@pytest.fixture(params=[2**22, 20, "dask"])
def parts(request, monkeypatch):
    """Read the results all at once, in many parts, and in Dask's blocks."""
    if request.param != "dask":
        monkeypatch.setattr(explore, "_AT_ONCE", request.param)
        return
    whole = explore._Results.__init__

    def in_blocks(self, dataset, output):
        whole(self, dataset.chunk({"flyer.diameter": 3, "altitude": 4}), output)

    monkeypatch.setattr(explore._Results, "__init__", in_blocks)


@pytest.mark.usefixtures("parts")
def test_the_best_design_is_numpys(dataset):
    values = dataset.payload.values
    place = np.unravel_index(np.nanargmax(values), values.shape)
    best = explore.best_design(dataset, "payload")
    assert best.value == values[place]
    assert tuple(best.index.values()) == place
    assert best.where["altitude"] == (float(dataset.altitude[place[2]]), "m")
    assert best.where["environment.incidence"] == (30.0, "degree")
    assert explore.best_design(dataset, "temperature").value == dataset.temperature.min()
    assert explore.best_design(dataset * np.nan, "payload") is None


@pytest.mark.usefixtures("parts")
@pytest.mark.parametrize("name", ["payload", "temperature"])
def test_the_best_designs_are_those_of_a_sorted_list(dataset, name):
    best = explore.best_designs(dataset, name, 7)
    rows = dataset.to_dataframe().sort_values(name, ascending=name == "temperature", kind="stable")
    np.testing.assert_array_equal(best[name], rows[name][:7])
    for field in ("flyer.diameter", "film.emittance", "altitude"):
        np.testing.assert_array_equal(best[field], rows.index.get_level_values(field)[:7])
    assert best.altitude.dims == ("rank",)
    assert explore.best_designs(dataset, name, 10**6).sizes["rank"] == rows[name].count()
    equal = dataset.assign(payload=0.0 * dataset.payload)
    first = explore.best_designs(equal, "payload", 2)
    np.testing.assert_array_equal(first.altitude, dataset.altitude[:2])


@pytest.mark.usefixtures("parts")
def test_quantiles_are_numpys(dataset, rng):
    shares = [0.0, 0.001, 0.05, 1 / 3, 0.5, 0.95, 1.0]
    numbers = rng.normal(size=dataset.payload.shape) * 10.0 ** rng.integers(-300, 300, (7, 5, 6))
    numbers[0, 0, :4] = 0.0, -0.0, np.inf, -np.inf
    for values in (dataset.payload, dataset.payload * 0.0, dataset.payload.copy(data=numbers)):
        found = explore.quantiles(dataset.assign(payload=values), "payload", shares)
        known = values.values[~np.isnan(values.values)]
        expected = np.quantile(known, shares, method="inverted_cdf")
        np.testing.assert_array_equal(found, expected)
        without = values.size - known.size
        assert (found.attrs["designs"], found.attrs["designs without a value"]) == (
            known.size,
            without,
        )
    assert explore.quantiles(dataset * np.nan, "payload").isnull().all()
    with pytest.raises(lf.ConfigurationError, match="from 0 to 1"):
        explore.quantiles(dataset, "payload", [50.0])


@pytest.mark.usefixtures("parts")
@pytest.mark.parametrize(("cost", "sign"), [("temperature", 1.0), ("altitude", -1.0)])
def test_a_front_is_what_comparing_all_with_all_leaves(dataset, cost, sign):
    designs, gains, costs = explore.front(dataset, "payload", cost)
    against = sign * dataset[cost].broadcast_like(dataset.payload).transpose(*dataset.payload.dims)
    able = (dataset.payload.values >= 0.0).ravel()  # what does not fly is on no front
    p, c = dataset.payload.values.ravel()[able], against.values.ravel()[able]
    beaten = [
        np.any((p >= here) & (c <= there) & ((p > here) | (c < there)))
        for here, there in zip(p, c, strict=True)
    ]
    expected = sorted(zip(sign * c[~np.array(beaten)], p[~np.array(beaten)], strict=True))
    assert sorted(zip(costs, gains, strict=True)) == expected
    np.testing.assert_array_equal(dataset.payload.values.ravel()[designs], gains)
    front = explore.pareto_front(dataset, "payload", cost)
    np.testing.assert_array_equal(front.payload, gains)
    np.testing.assert_array_equal(front[cost], costs)
    assert front[cost].attrs["units"]


def test_a_front_of_what_should_be_little(dataset):
    _, little, costs = explore.front(dataset, "temperature", "altitude")
    able = dataset.temperature.where(dataset.payload >= 0.0)
    least = able.min(["flyer.diameter", "film.emittance"]).sortby("altitude", ascending=False)
    front = np.minimum.accumulate(least.values)
    kept = np.concatenate([[True], front[1:] < front[:-1]])
    np.testing.assert_array_equal(little, front[kept])
    np.testing.assert_array_equal(costs, least.altitude.values[kept])


def test_a_slice_is_where_it_is_asked_for_or_at_the_best(dataset):
    sliced, chosen = explore.choose_slice(dataset, "payload", ["altitude"], {"diameter": "2.1 cm"})
    assert chosen["flyer.diameter"] == (pytest.approx(0.02), "m")
    at_diameter = dataset.isel({"flyer.diameter": 2}).payload
    place = np.unravel_index(np.nanargmax(at_diameter.values), at_diameter.shape)
    assert chosen["film.emittance"][0] == float(dataset["film.emittance"][place[0]])
    assert sliced.payload.dims == ("altitude",)
    with pytest.raises(lf.ConfigurationError, match="is an axis of the map"):
        explore.choose_slice(dataset, "payload", ["altitude"], {"altitude": "70 km"})
    with pytest.raises(lf.ConfigurationError, match="6 cm is outside the sweep"):
        explore.choose_slice(dataset, "payload", ["altitude"], {"diameter": "6 cm"})
    with pytest.raises(lf.ConfigurationError, match="of the wrong kind"):
        explore.choose_slice(dataset, "payload", ["altitude"], {"diameter": "2 kg"})


def test_names_may_be_short_where_they_are_plain(dataset):
    assert explore.find_name(dataset, "diameter", among="fields") == "flyer.diameter"
    with pytest.raises(lf.ConfigurationError, match='did you mean "payload"'):
        explore.find_name(dataset, "paylod", among="outputs")
    double = dataset.rename({"film.emittance": "film.diameter"})
    with pytest.raises(lf.ConfigurationError, match="is ambiguous"):
        explore.find_name(double, "diameter", among="fields")


def test_bands_over_samples_are_numpys_quantiles(dataset):
    samples = dataset.payload.fillna(0.0).rename({"altitude": "sample"})
    band = explore.over_samples(samples)
    for name, level in (("low", 0.025), ("median", 0.5), ("high", 0.975)):
        expected = np.quantile(samples, level, axis=2, method="nearest")
        np.testing.assert_allclose(band[name], expected)


def test_a_band_counts_samples_without_a_value_as_the_worst():
    """Of 100 samples 10 need more light than there is: the band has no upper end."""
    values = np.append(np.arange(90.0), np.full(10, np.nan))
    light = xr.DataArray(values, dims="sample", name="levitation_irradiance")
    band = {name: float(end) for name, end in explore.over_samples(light).items()}
    assert band == {"low": 2.0, "median": 50.0, "high": np.inf}
    carried = explore.over_samples(light.rename("payload"))
    assert float(carried["low"]) == -np.inf
    assert float(carried["median"]) == 40.0


def test_the_best_usable_design_is_the_best(dataset):
    payload = dataset.payload
    usable = xr.zeros_like(payload) + (payload < payload.quantile(0.5, skipna=True).item())
    judged = dataset.assign(usable=usable)
    best = explore.best_design(judged, "payload")
    assert best.value == float(payload.where(usable > 0.0).max())
    assert best.value < explore.best_design(dataset, "payload").value
    np.testing.assert_array_equal(explore.margin(judged) > 0.0, usable > 0.0)
    none = dataset.assign(usable=xr.zeros_like(payload))
    assert explore.best_design(none, "payload").value == float(payload.max())


def test_a_lucky_draw_is_no_best_design(dataset):
    """One sample of a poor design is better than all of a good one's."""
    payload = np.repeat(dataset.payload.isel(altitude=0).values[..., None], 9, axis=2)
    rng = np.random.default_rng(1)
    payload = payload + 0.1 * rng.normal(size=payload.shape)
    payload[0, 0, 4] = 100.0
    drawn = xr.Dataset(
        {"payload": (("flyer.diameter", "film.emittance", "sample"), payload, {"units": "kg"})},
        coords={"film.tac_top": ("sample", rng.normal(size=9), {"units": "1"})},
    )
    medians = np.median(payload, axis=2)
    best = explore.best_design(drawn, "payload")
    assert best.value == medians.max()
    assert tuple(best.index.values()) == np.unravel_index(medians.argmax(), (7, 5))
    assert best.band[0] < best.value < best.band[1] < 100.0
    assert "median; 95 % of the samples" in str(best)
    cost = drawn.payload.median("sample") * 0.0
    _, gains, _ = explore.front(drawn.assign(cost=cost), "payload", "cost")
    assert gains.tolist() == [medians.max()]


def test_a_map_of_a_list_in_any_order_rises(dataset):
    """Contours over values that go up and down are of no design."""
    shuffled = dataset.isel({"film.emittance": [3, 0, 4, 1, 2]})
    kept = ["film.emittance", "altitude"]
    sliced, _ = explore.choose_slice(shuffled, "payload", kept, {})
    expected, _ = explore.choose_slice(dataset, "payload", kept, {})
    xr.testing.assert_identical(sliced, expected)


def test_one_design_is_its_own_best_and_front(dataset):
    one = dataset.isel({"flyer.diameter": 1, "film.emittance": 0, "altitude": 2})
    one["payload"] = abs(one.payload)
    assert explore.best_design(one, "payload").value == float(one.payload)
    assert explore.best_designs(one, "payload").payload.values.tolist() == [float(one.payload)]
    assert explore.pareto_front(one, "payload", "temperature").sizes == {"point": 1}
    assert explore.best_designs(one * np.nan, "payload").sizes == {"rank": 0}
    assert float(explore.quantiles(one, "payload", 0.5)[0]) == float(one.payload)


def test_slips_in_what_is_read_from_a_sweep_are_named(dataset):
    for count in (0, -3, 2.5, True):
        with pytest.raises(lf.ParameterError, match="a whole number of at least 1"):
            explore.best_designs(dataset, "payload", count)
    with pytest.raises(lf.ParameterError, match="not against itself"):
        explore.pareto_front(dataset, "payload", "payload")
    with pytest.raises(lf.ParameterError, match="not a DataArray"):
        explore.quantiles(dataset.payload, "payload")
