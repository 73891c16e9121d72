"""Figures: what is drawn is all there, legible and told apart, whatever it looks like."""

import importlib
import inspect
import pickle
import re
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import lightflyer as lf
from lightflyer.calibration import Points
from lightflyer.calibration.bayes import Posterior
from lightflyer.calibration.figures import fitted_curve
from lightflyer.files import drawing, palette
from lightflyer.lab.readers.height_map import HeightMap
from lightflyer.lab.thermography.data import parse_band
from lightflyer.parametric.figures import pareto_figure

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
SETUP = lf.Setup(lf.Disk(FILM, 0.01), lf.Chamber(), lf.Lu2023())
STYLES = (None, "column")
# single numbers, what was given, and a part of another result
NOT_DRAWN = {
    *("Drift", "Estimate", "Hanging", "Readings", "Swarm", "TacAccuracy", "Compared"),
    *("AsMade", "RankedStack", "Ranking"),  # parts of an Optimum
}


def exported():
    """Classes that the rooms export, by the names in their stubs."""
    root = Path(lf.__file__).parent
    for stub in sorted(root.glob("*/__init__.pyi")):
        room = importlib.import_module(f"lightflyer.{stub.parent.name}")
        for name in re.findall(r"import (\w+) as", stub.read_text(encoding="utf-8")):
            found = getattr(room, name)
            if inspect.isclass(found) and found.__module__.startswith("lightflyer."):
                yield found


RESULTS = {
    one.__name__: one
    for one in exported()
    if "warnings" in getattr(one, "__dataclass_fields__", {})
    or hasattr(one, "summary")
    or hasattr(one, "to_json")
}


def texts(ax):
    legend = ax.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def labels_in_view(axis):
    low, high = sorted(axis.get_view_interval())
    which = 0 if axis.axis_name == "x" else 1
    for label in [*axis.get_ticklabels(), *axis.get_ticklabels(minor=True)]:
        place = label.get_position()[which]
        if label.get_text() and low <= place <= high:
            yield label


def require_legible(figure):
    """No label overlaps another, no legend an axes, and all of it is within the figure."""
    figure.draw_without_rendering()
    renderer = FigureCanvasAgg(figure).get_renderer()
    frames = [ax.get_window_extent(renderer) for ax in figure.axes]
    legends = [ax.get_legend() for ax in figure.axes] + list(figure.legends)
    boxes = [one.get_window_extent(renderer) for one in legends if one is not None]
    for box in boxes:
        assert not any(box.overlaps(frame) for frame in frames)
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            ticks = [label.get_window_extent(renderer) for label in labels_in_view(axis)]
            assert not any(one.overlaps(other) for one, other in combinations(ticks, 2))


@pytest.fixture(scope="module")
def prediction():
    return lf.predict(SETUP)


@pytest.fixture(scope="module")
def uncertain(prediction):
    design = lf.design.ObjectDesign(SETUP, {"flyer.film.absorptance": 0.03})
    return lf.propagate(design, prediction=prediction, samples=0)


@pytest.mark.parametrize("name", sorted(RESULTS))
def test_every_result_draws_itself(name):
    assert (name in NOT_DRAWN) != hasattr(RESULTS[name], "plot")


@pytest.mark.parametrize("style", STYLES)
def test_prediction(uncertain, style):
    with drawing.use_style(style):
        figure = uncertain.plot()
    irradiance, temperature, payload, chart, bar = figure.axes
    require_legible(figure)
    for ax in (irradiance, temperature, payload):
        assert "95 % band" in texts(ax)
        assert len(set(texts(ax))) == len(texts(ax))
    assert "available light" in texts(chart)
    assert bar.get_ylabel() == "flyer temperature [K]"
    low, high = irradiance.get_ylim()
    assert low < uncertain.prediction.easiest.values["levitation_irradiance"] < high
    assert len(list(labels_in_view(irradiance.yaxis))) > 3
    assert len(list(labels_in_view(irradiance.xaxis))) > 3


def test_curves_have_many_points_of_the_model(prediction):
    ax = prediction.plot("irradiance").axes[0]
    (line,) = (one for one in ax.get_lines() if one.get_label() == "needed to levitate")
    pressure, light = line.get_data()
    low, high = ax.get_xlim()
    shown = (pressure >= low) & (pressure <= high) & np.isfinite(light)
    assert shown.sum() > 300
    some = np.flatnonzero(shown)[::40]
    state = SETUP.environment.state(pressure[some])
    expected = lf.levitate(SETUP.flyer, state, SETUP.model).irradiance
    np.testing.assert_allclose(light[some], expected, rtol=1e-9)


def test_one_panel_goes_on_given_axes(prediction):
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert prediction.plot("payload", ax=left) is figure
    assert not right.lines
    with pytest.raises(lf.ParameterError, match="choose from irradiance, temperature"):
        prediction.plot("mass")
    with pytest.raises(lf.ParameterError, match="say what"):
        prediction.plot(ax=left)


def test_where_nothing_flies_the_light_and_the_best_are_in_view():
    heavy = lf.Disk(lf.FilmProperties(3e-3, 0.75, 0.3, 0.3, 0.8, 0.85), 0.01)
    found = lf.predict(heavy, SETUP.environment, SETUP.model)
    assert not found.bands
    irradiance = found.plot("irradiance").axes[0]
    low, high = irradiance.get_ylim()
    assert low < found.available < high
    best = replace(found.best, coordinate=1e3)
    payload = replace(found, best=best, propagate=None).plot("payload").axes[0]
    assert payload.get_xlim()[0] < payload.get_xlim()[1] == pytest.approx(1e3)


def test_comparison(prediction):
    found = lf.compare([SETUP, lf.Setup(lf.Disk(FILM, 0.02), SETUP.environment, SETUP.model)])
    figure = found.plot("payload")
    require_legible(figure)
    labels = ["disk of 2 cm, Lu2023", "disk of 4 cm, Lu2023"]
    assert texts(figure.axes[0]) == [
        *labels,
        "outside the range of force model or gas",
        "95 % band",
    ]
    with pytest.raises(lf.ParameterError, match="payload_per_area"):
        found.plot("lift")


@pytest.fixture(scope="module")
def fit():
    """Nine synthetic samples of the model itself, scattered by 3 %."""
    diameter, pressure = np.repeat(0.02 + 0.002 * np.arange(9), 6), np.geomspace(1.5, 25.0, 6)
    pressure = np.tile(pressure, 9)
    disks = lf.Disk(FILM, 0.5 * diameter)
    light = lf.levitate(disks, SETUP.environment.state(pressure), lf.Lu2023(0.4, 3.0)).irradiance
    light = light * np.exp(0.03 * np.random.default_rng(3).standard_normal(54))
    samples = [f"synthetic no. {number // 6 + 1}" for number in range(54)]
    numbers = {"pressure": pressure, "irradiance": light, "diameter": diameter}
    return lf.calibrate(SETUP, points=Points("synthetic.csv", samples, numbers))


@pytest.mark.parametrize("style", STYLES)
def test_nine_samples_are_told_apart(fit, style):
    with drawing.use_style(style):
        figure = fit.plot()
    require_legible(figure)
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 9
    looks = {(line.get_color(), line.get_marker()) for line in legend.get_lines()}
    assert len(looks) == 9
    assert len({color for color, _ in looks}) == 9
    assert len({line.get_linestyle() for line in legend.get_lines()} - {"None"}) > 3
    assert legend.get_title().get_text() == "points: measured; lines: fit"


def test_fitted_curve_is_the_model_with_the_fit(fit):
    pressure, light = fitted_curve(fit, "synthetic no. 4")
    assert pressure.size >= 80
    disk = lf.Disk(FILM, 0.013)
    model = lf.Lu2023(*fit.values)
    expected = lf.levitate(disk, SETUP.environment.state(pressure), model).irradiance
    np.testing.assert_allclose(light, expected, rtol=1e-8)


def test_a_sample_whose_points_differ_is_drawn_at_them(fit):
    model = fit.problem.model
    stated = model.stated.copy()
    stated[:, 0] *= 1.1  # another diameter at one of the points
    problem = replace(fit.problem, model=replace(model, stated=stated))
    mixed = replace(fit, problem=problem)
    pressure, light = fitted_curve(mixed, "synthetic no. 1")
    np.testing.assert_array_equal(pressure, fit.points.pressure[:6])
    np.testing.assert_array_equal(light, fit.fitted[:6])


def test_posterior():
    draws = np.random.default_rng(0).normal(size=(4, 200, 2))
    drawn = Posterior(["c_fm", "scatter"], draws, np.ones(2), np.ones(2), 0)
    figure = drawn.plot()
    require_legible(figure)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()][-2:] == ["chain 4", "95 % interval"]
    (band,) = (one for one in figure.axes[0].patches if one.get_label() == "95 % interval")
    assert band.get_x() == pytest.approx(drawn.intervals[0, 0])


def swept(sampled=False):
    """A sweep's results, of a formula: the best altitude rises with the logarithm of the radius."""
    radius, altitude = np.geomspace(2e-3, 2e-2, 9), np.linspace(60e3, 85e3, 11)
    shape = ("flyer.radius", "flyer.film.tac_top", "altitude")
    best = 70e3 + 2e3 * np.log(radius / 2e-3)
    values = 1e-7 - 2e-15 * (altitude - best[:, None, None]) ** 2
    values = np.repeat(values, 2, axis=1) - 1e-8 * np.arange(2)[:, None]
    if sampled:
        shape = (*shape, "sample")
        values = values[..., None] + 4e-8 * np.random.default_rng(1).standard_normal(40)
    coordinates = {
        "flyer.radius": ("flyer.radius", radius, {"units": "m", "long_name": "flyer radius"}),
        "flyer.film.tac_top": ("flyer.film.tac_top", [0.7, 0.8], {"units": "1"}),
        "altitude": ("altitude", altitude, {"units": "m", "long_name": "altitude"}),
    }
    about = {"units": "kg", "long_name": "largest payload in the available light"}
    return xr.Dataset({"payload": (shape, values, about)}, coordinates)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("sampled", [False, True])
def test_map_of_a_sweep(sampled, style):
    with drawing.use_style(style):
        figure = lf.parametric.plot_sweep(swept(sampled), "payload", "radius", "altitude")
    require_legible(figure)
    ax, bar = figure.axes
    assert ax.get_title() == "at film TAC, top = 0.7"
    assert "largest payload in the" in bar.get_ylabel()
    labels = texts(ax)
    assert labels[0] == "most at each flyer radius"
    if sampled:
        assert labels[-3:] == [f"{share} % of the samples fly" for share in (10, 50, 90)]
    else:  # the top of a parabola lies between designs
        radius, best = ax.get_lines()[0].get_data()
        np.testing.assert_allclose(best, 70.0 + 2.0 * np.log(radius / 0.2), rtol=1e-9)


@pytest.mark.parametrize("sampled", [False, True])
def test_line_of_a_sweep(sampled):
    dataset = swept(sampled)
    figure = lf.parametric.plot_sweep(dataset, "payload", "altitude", at={"radius": "2 mm"})
    require_legible(figure)
    (ax,) = figure.axes
    assert ax.get_title() == "at flyer radius = 0.2 cm; film TAC, top = 0.7"
    assert ax.get_lines()[0].get_marker() == "o"
    assert ("95 % band" in texts(ax)) == sampled
    if not sampled:  # the border is where the payload vanishes, between two designs
        (hatched,) = (one for one in ax.collections if one.get_label() == "cannot fly")
        ends = [path.get_extents().intervalx for path in hatched.get_paths()]
        altitude, payload = dataset.altitude.values / 1e3, dataset.payload[0, 0].values
        rising, falling = np.flatnonzero(np.diff(np.sign(payload)))
        for at, found in ((rising, ends[0][1]), (falling, ends[-1][0])):
            share = payload[at] / (payload[at] - payload[at + 1])
            expected = altitude[at] + share * (altitude[at + 1] - altitude[at])
            assert found == pytest.approx(expected, abs=0.03)


def test_wrong_names_of_a_sweep():
    with pytest.raises(lf.ConfigurationError, match=r"flyer\.radius"):
        lf.parametric.plot_sweep(swept(), "payload", "radios")
    with pytest.raises(lf.ConfigurationError, match="both altitude"):
        lf.parametric.plot_sweep(swept(), "payload", "altitude", "altitude")


def test_pareto_points_are_not_joined():
    figure = pareto_figure(swept(), "payload")
    (line,) = figure.axes[0].get_lines()
    assert line.get_linestyle() == "None"
    require_legible(figure)


def test_roughness_maps_share_one_scale(rng):
    noise = 1e-9 * rng.standard_normal((64, 64))
    maps = (HeightMap(f"{scale:g} nm", scale * noise, 1e-6, 1e-6) for scale in (1.0, 5.0))
    low, high = map(lf.lab.roughness, maps)
    (figure,) = lf.lab.roughness_figures([low, high]).values()
    figure.draw_without_rendering()
    above, below = figure.axes[:2], figure.axes[2:4]
    for row in (above, below):
        first, second = (ax.images[0].get_clim() for ax in row)
        assert first == second
    assert above[0].images[0].get_clim()[1] >= 5.0
    assert all(len(set(to_rgb(image))) == 1 for image in above[0].images[0].cmap([0.2, 0.8]))
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {"particles", "holes"}
    assert low.plot().axes[0].images


@pytest.fixture(scope="module")
def examples(tmp_path_factory):
    folder = tmp_path_factory.mktemp("examples")
    for name in ("tac", "thermography", "ftir"):
        for file, content in lf.lab.example_files(name, 0).files.items():
            data = content if isinstance(content, bytes) else content.encode()
            (folder / file).write_bytes(data)
    return folder


def test_residuals_of_a_heater_are_in_a_panel_of_their_own(examples):
    fit = lf.lab.fit_tac(lf.lab.read_tac(examples / "tac-reduced.txt"))
    figure = fit.plot()
    require_legible(figure)
    _, right = figure.axes
    points = next(one for one in right.get_lines() if one.get_marker() not in ("", "None"))
    expected = 100.0 * (fit.conductance / fit.fitted - 1.0)[fit.order]
    np.testing.assert_allclose(points.get_ydata(), expected)
    assert 0.85 < np.mean(np.abs(expected) < 196.0 * fit.scatter) <= 1.0


@pytest.mark.parametrize("style", STYLES)
def test_intervals_of_thermography_are_tall(examples, style):
    scene = lf.lab.Scene(camera=parse_band("7.5-14 um"))
    method = lf.lab.THERMAL
    readings, _ = lf.lab.read_readings(examples / "thermal.csv", method, accuracy=0.5, scene=scene)
    found = lf.lab.reduce_readings(readings, draws=2000)
    with drawing.use_style(style):
        figure = found.plot()
    require_legible(figure)
    for ax, name in zip(figure.axes, found.first_order, strict=True):
        low, high = found.first_order[name].interval
        bottom, top = ax.get_ylim()
        assert high - low > 0.4 * (top - bottom)
        assert bottom < low < high < top


def test_a_result_from_another_process_says_the_same(examples):
    readings, _ = lf.lab.read_readings(examples / "light-meter.csv", lf.lab.LIGHT)
    found = lf.lab.reduce_readings(readings, draws=1000)
    figure = pickle.loads(pickle.dumps(found)).plot()
    assert figure.get_suptitle() == "for the light of the source"
    assert figure.axes[2].get_xlabel() == "absorptivity"


def test_spectra_of_two_kinds_differ_in_colour(examples):
    one = lf.lab.read_spectrum(examples / "film.csv")
    other = lf.lab.read_spectrum(examples / "film-reflectance.csv")
    figure = lf.lab.reduce_ftir([one], [other]).plot()
    require_legible(figure)
    first, second = figure.axes[0].get_lines()[:2]
    assert first.get_color() != second.get_color()
    assert first.get_linestyle() != second.get_linestyle()
    (emitted,) = (line for line in figure.axes[0].get_lines() if line.get_label() == "emissivity")
    at = emitted.get_xdata() * 100.0  # 1/cm to 1/m
    kept = [np.interp(at, spectrum.wavenumber, spectrum.value) for spectrum in (one, other)]
    np.testing.assert_allclose(emitted.get_ydata(), 1.0 - kept[0] - kept[1], atol=1e-12)


@pytest.mark.parametrize(
    ("low", "high", "least", "shown"),
    [
        (1.2, 1.9, 3, {}),
        (1.1, 8.0, 3, {"2", "3", "5"}),
        (0.8, 60.0, 5, {"1", "2", "5", "10"}),
        (1.0, 300.0, 7, {"100", "200"}),
        (1e-4, 1e3, 7, {"0.01", "1000"}),
        (1e4, 1e7, 3, {"10000", "10⁶"}),
    ],
)
def test_logarithmic_axes_have_enough_numbers(low, high, least, shown):
    figure = drawing.new_figure()
    (ax,) = figure.axes
    ax.set_xscale("log")
    drawing.plain_decades(ax.xaxis)
    ax.set_xlim(low, high)
    require_legible(figure)
    found = [label.get_text() for label in labels_in_view(ax.xaxis)]
    assert least <= len(found) <= 16
    assert set(shown) <= set(found)


def test_colours_markers_and_lines_of_nine_differ():
    assert len(set(palette.PALETTE)) == len(set(drawing.MARKERS)) == 9
    colours = np.array([to_rgb(colour) for colour in palette.PALETTE])
    # none is so light that a line of it cannot be seen on white (relative luminance of sRGB)
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    contrast = 1.05 / (linear @ [0.2126, 0.7152, 0.0722] + 0.05)
    assert contrast.min() > 2.0
    distances = [np.linalg.norm(one - other) for one, other in combinations(colours, 2)]
    assert min(distances) > 0.2


def test_a_column_is_as_wide_as_a_column():
    with drawing.use_style("column"):
        one, two = drawing.new_figure(), drawing.new_figure(columns=2)
    assert one.get_figwidth() * 2.54 == pytest.approx(8.6, rel=1e-3)
    assert two.get_figwidth() == 2 * one.get_figwidth()
    assert drawing.new_figure().get_figwidth() == 6.0


def test_a_notebook_shows_a_figure_by_itself():
    assert drawing.new_figure()._repr_png_().startswith(b"\x89PNG")
