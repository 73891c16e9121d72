from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy import stats
from skmisc.loess import loess

import lightflyer as lf
from lightflyer.core.errors import Doubt
from lightflyer.design.setup import Setup
from lightflyer.environment import Chamber
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer import Disk
from lightflyer.force import Lu2023
from lightflyer.lab.levitation.curve import (
    LEAST_POINTS,
    calibrate_curves,
    compare,
    levitation_curve,
    model_curve,
    summary,
)
from lightflyer.lab.levitation.data import LiftOffs, minimum, read_lift_offs, smoother
from lightflyer.lab.levitation.figures import residuals
from lightflyer.statics.levitation import levitate

RANGE = (1.5, 40.0)


@pytest.fixture(scope="module")
def truth():
    """Log-pressure and log-irradiance of the model's curve."""
    pressure = np.geomspace(*RANGE, 4000)
    film = FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    light = levitate(Disk(film, radius=0.01), Chamber().state(pressure), Lu2023()).irradiance
    return np.log(pressure), np.log(light)


def draw(truth, rng, count=24, noise=0.05, name="a", factor=1.0):
    log_pressure, log_light = truth
    x = rng.uniform(log_pressure[0], log_pressure[-1], count)
    y = np.interp(x, log_pressure, log_light) + noise * rng.normal(size=count)
    return LiftOffs(name, np.exp(x), factor * np.exp(y), "points.csv:2")


def test_a_parabola_is_found_exactly():
    x = np.linspace(-1.0, 2.0, 15)
    points = LiftOffs("a", np.exp(x), np.exp(0.8 * (x - 0.4) ** 2 + 7.0))
    curve = levitation_curve(points, draws=100)
    assert curve.optimal_pressure.value == pytest.approx(np.exp(0.4), rel=1e-6)
    assert curve.minimum_irradiance.value == pytest.approx(np.exp(7.0), rel=1e-9)


def test_intervals_of_few_points_are_exact_where_the_curve_follows_them(rng):
    """Few residuals tell little of the scatter, and err together with the curve."""
    x, inside, count = np.linspace(-1.0, 2.0, LEAST_POINTS), 0, 200
    for seed in range(count):
        light = np.exp(0.8 * (x - 0.4) ** 2 + 7.0 + 0.02 * rng.normal(size=x.size))
        found = minimum(x, light, span=0.75, draws=400, seed=seed)
        low, high = np.quantile(found.values, [0.025, 0.975])
        inside += low < 7.0 < high
    low, high = stats.binom.ppf([1e-3, 0.999], count, 0.95)
    assert low <= inside <= high


def test_seeds_repeat_and_units_scale(truth, rng):
    points = draw(truth, rng)
    one, two = levitation_curve(points, draws=100), levitation_curve(points, draws=100)
    assert one.optimal_pressure == two.optimal_pressure
    scaled = LiftOffs("b", 7.0 * points.pressure, 3.0 * points.irradiance)
    three = levitation_curve(scaled, draws=100)
    assert three.optimal_pressure.value == pytest.approx(7.0 * one.optimal_pressure.value)
    np.testing.assert_allclose(
        three.minimum_irradiance.interval, 3.0 * np.array(one.minimum_irradiance.interval)
    )


def test_reduction_between_two_samples(truth, rng):
    curves = [
        levitation_curve(draw(truth, rng, 30, 0.03, name, factor), draws=300, seed=seed)
        for seed, (name, factor) in enumerate([("more", 2.0), ("less", 1.0)])
    ]
    (found,) = compare(curves)
    assert (found.first, found.second) == ("less", "more")
    low, high = found.reduction.interval
    assert low < 0.5 < high
    assert high - low < 0.08
    document = summary(curves)
    assert document["comparisons"][0]["a"] == "less"
    assert document["samples"]["more"]["points"] == 30


def test_an_optimum_at_the_end_is_said():
    x = np.linspace(0.0, 2.0, 12)
    curve = levitation_curve(LiftOffs("a", np.exp(x), np.exp(7.0 + x)), draws=100)
    assert curve.at_edge
    assert "minimum at the end of its pressures" in curve.warnings[0]
    assert curve.optimal_pressure.interval[0] == 0.0
    assert curve.minimum_irradiance.interval[0] == 0.0
    assert summary([curve])["warnings"] == list(curve.warnings)


@pytest.mark.parametrize("count", range(LEAST_POINTS, 13))
def test_the_promised_number_of_points_is_enough(truth, count):
    log_pressure, _ = truth
    for seed in range(10):
        generator = np.random.default_rng(seed)
        x = np.linspace(log_pressure[0], log_pressure[-1], count)
        y = np.interp(x, *truth) + 0.05 * generator.normal(size=count)
        curve = levitation_curve(LiftOffs("a", np.exp(x), np.exp(y)), draws=100)
        low, high = curve.minimum_irradiance.interval
        assert 0.0 < low < curve.minimum_irradiance.value < high < np.inf


def test_steps_of_the_light_neither_shift_the_minimum_nor_spoil_its_interval(truth, rng):
    """The points are made at thresholds and noted at the first step above each."""
    step = 200.0
    least = np.exp(truth[1].min())
    biases, uncorrected, inside = [], [], []
    for seed in range(30):
        threshold = draw(truth, rng, 24)
        light = step * np.ceil(threshold.irradiance / step)
        points = LiftOffs("a", threshold.pressure, light)
        plain = levitation_curve(points, draws=100, seed=seed)
        assert f"lie on steps of {step:g} W/m^2" in " ".join(plain.warnings)
        curve = levitation_curve(points, draws=100, seed=seed, step=step, irradiance_accuracy=0.01)
        assert not any("lie on steps" in text for text in curve.warnings)
        low, high = curve.minimum_irradiance.interval
        inside.append(low <= least <= high)
        biases.append(curve.minimum_irradiance.value / least - 1.0)
        uncorrected.append(plain.minimum_irradiance.value / least - 1.0)
    assert np.mean(uncorrected) > 0.3 * step / least
    assert abs(np.mean(biases)) < 0.02
    assert np.mean(inside) > 0.83


def test_instruments_widen_each_interval_but_not_that_of_the_reduction(truth, rng):
    lots = [draw(truth, rng, 24, 0.02, name, factor) for name, factor in (("a", 1.0), ("b", 2.0))]
    found = {}
    for accuracy in (0.0, 0.1):
        curves = [
            levitation_curve(one, pressure_accuracy=accuracy, irradiance_accuracy=accuracy)
            for one in lots
        ]
        found[accuracy] = curves[0], compare(curves)[0].reduction.interval
    assert found[0.0][1] == found[0.1][1]
    for name in ("optimal_pressure", "minimum_irradiance"):
        exact, rough = (getattr(found[accuracy][0], name) for accuracy in (0.0, 0.1))
        own = np.log(exact.interval[1] / exact.interval[0])
        whole = np.log(rough.interval[1] / rough.interval[0])
        # two independent parts, the second 1.96 * 0.1 on either side
        assert whole == pytest.approx(np.hypot(own, 2 * 1.96 * 0.1), rel=0.1)


def test_the_smoother_is_loess_computed_directly():
    x, at = np.sort(np.random.default_rng(3).uniform(0.0, 3.0, 20)), np.linspace(0.2, 2.5, 7)
    y, weight = np.sin(x), np.linspace(0.2, 1.0, 20)
    direct = loess(x, y, span=0.75, degree=2, surface="direct")
    direct.fit()
    expected = direct.predict(at).values
    np.testing.assert_allclose(smoother(x, at, 0.75) @ y, expected, atol=1e-10)
    weighted = loess(x, y, weights=weight, span=0.75, degree=2, surface="direct")
    weighted.fit()
    expected = weighted.outputs.fitted_values
    np.testing.assert_allclose(smoother(x, x, 0.75, weight) @ y, expected, atol=1e-10)


def stated(points, relative):
    uncertainty = relative * points.irradiance
    return replace(points, uncertainties={"irradiance_uncertainty": uncertainty})


def test_stated_uncertainties_weigh(truth, rng):
    """Every other point is ten times worse; without its ± it spoils the minimum."""
    least, errors = np.exp(truth[1].min()), {True: [], False: []}
    inside = []
    for seed in range(30):
        points, relative = draw(truth, rng, 28, noise=0.0), np.tile([0.02, 0.2], 14)
        light = points.irradiance * np.exp(relative * rng.normal(size=28))
        points = replace(points, irradiance=light)
        for weighs in (True, False):
            one = stated(points, relative) if weighs else points
            found = levitation_curve(one, draws=300, seed=seed, irradiance_accuracy=0.0)
            errors[weighs].append(np.log(found.minimum_irradiance.value / least))
            if weighs:
                low, high = found.minimum_irradiance.interval
                inside.append(low < least < high)
    assert np.std(errors[True]) < 0.5 * np.std(errors[False])
    assert np.sum(inside) >= stats.binom.ppf(1e-3, 30, 0.95)


def test_equal_uncertainties_change_nothing_but_the_scatter(truth, rng):
    points = draw(truth, rng, noise=0.05)
    plain, wide = levitation_curve(points), levitation_curve(stated(points, 0.5))
    np.testing.assert_allclose(wide.irradiance, plain.irradiance, rtol=1e-12)
    ratio = [np.log(np.divide(*one.minimum_irradiance.interval)) for one in (wide, plain)]
    assert ratio[0] / ratio[1] > 3.0
    said = "times as much as their stated uncertainties say: intervals are"
    assert f"{said} too wide" in " ".join(wide.warnings)
    small = levitation_curve(stated(points, 0.001))
    assert f"{said} those of the scatter" in " ".join(small.warnings)
    np.testing.assert_allclose(
        small.minimum_irradiance.interval, plain.minimum_irradiance.interval, rtol=1e-9
    )


def test_an_uncertainty_of_zero_is_refused(truth, rng):
    with pytest.raises(lf.ParameterError, match="point 1 has no uncertainty"):
        levitation_curve(stated(draw(truth, rng), np.r_[0.0, np.full(23, 0.05)]))


def test_the_minimum_lies_on_the_curve_within_its_band(truth, rng):
    curve = levitation_curve(draw(truth, rng))
    at, light = curve.optimal_pressure.value, curve.minimum_irradiance
    for name, expected in (("irradiance", light.value), ("lower", light.interval[0]),
                           ("upper", light.interval[1])):  # fmt: skip
        assert np.interp(at, curve.pressure, getattr(curve, name)) == pytest.approx(
            expected, rel=1e-4 if name == "irradiance" else 0.05
        )


def parabola():
    x = np.linspace(-1.0, 2.0, 15)
    return x, LiftOffs("a", np.exp(x), np.exp(0.8 * (x - 0.4) ** 2 + 7.0), "a.csv:2")


@pytest.mark.parametrize("meter", [True, False])
def test_the_band_has_the_instruments_errors(meter):
    """A wrong light meter moves the curve up, a wrong gauge along: up by the slope."""
    accuracies = {"irradiance_accuracy": 0.1 * meter, "pressure_accuracy": 0.1 * (not meter)}
    curve = levitation_curve(parabola()[1], **accuracies)
    slope = 1.6 * (np.log(curve.pressure) - 0.4)
    expected = np.full(slope.size, 0.1) if meter else 0.1 * np.abs(slope)
    half = 0.5 * np.log(curve.upper / curve.lower)
    np.testing.assert_allclose(half, 1.96 * expected, rtol=0.06, atol=0.01)


def test_errors_of_pressure_weigh_by_the_slope_of_the_curve(rng):
    x, exact = parabola()
    read = np.exp(x + 0.05 * rng.normal(size=x.size))
    light = {"irradiance_uncertainty": 0.005 * exact.irradiance}
    both = light | {"pressure_uncertainty": 0.05 * read}
    for known, scatters in ((light, True), (both, False)):
        points = replace(exact, pressure=read, uncertainties=known)
        said = " ".join(levitation_curve(points).warnings)
        assert ("times as much" in said) is scatters


def test_stated_errors_are_drawn_as_intervals_of_95_percent():
    points = stated(parabola()[1], 0.05)
    bars, *_ = levitation_curve(points).plot().axes[0].containers
    (vertical,) = (one for one in bars.lines[2] if np.ptp(one.get_segments()[0][:, 1]) > 0.0)
    half = [0.5 * np.ptp(segment[:, 1]) for segment in vertical.get_segments()]
    np.testing.assert_allclose(half, 1.96 * 0.05e-3 * points.irradiance, rtol=1e-3)
    (bars,) = residuals([levitation_curve(points)], Figure().add_subplot(), "Pa").containers
    half = [0.5 * np.ptp(segment[:, 1]) for segment in bars.lines[2][0].get_segments()]
    np.testing.assert_allclose(half, 1.96 * 5.0, rtol=1e-3)


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_points_without_a_minimum_are_said(rng, noise):
    pressure = np.geomspace(1.0, 30.0, 14)
    points = LiftOffs("flat", pressure, 900.0 * np.exp(noise * rng.normal(size=14)), "a.csv:2")
    assert "a.csv:2: the points of flat show no minimum" in levitation_curve(points).warnings


def test_a_span_that_cannot_follow_the_points_is_said():
    x = np.linspace(0.0, 3.0, 60)
    points = LiftOffs("wavy", np.exp(x), 900.0 * np.exp(0.3 * np.cos(6.0 * x)))
    curve = levitation_curve(points)
    assert any("narrower --span" in text for text in curve.warnings)
    # as many points again tell no more of a curve that does not follow them
    twice = LiftOffs("twice", np.repeat(points.pressure, 2), np.repeat(points.irradiance, 2))
    widths = [np.median(np.log(one.upper / one.lower)) for one in (curve, levitation_curve(twice))]
    assert widths[1] > 0.9 * widths[0]


@pytest.mark.parametrize("properties", [{"diameter": 0.02}, {}])
def test_kilowatts_and_millitorr_taken_for_others_are_said(truth, rng, properties):
    points = draw(truth, rng)
    points.properties.update(properties)
    assert not any("unlikely" in text for text in levitation_curve(points).warnings)
    for wrong in (replace(points, irradiance=1e-3 * points.irradiance),
                  replace(points, pressure=7.5 * points.pressure)):  # fmt: skip
        assert any("check the units" in text for text in levitation_curve(wrong).warnings)


def test_points_in_ground_effect_are_left_out_of_the_fit(truth, rng):
    film = FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    setup = Setup(Disk(film, radius=0.01), Chamber(), Lu2023(0.5, 2.0))
    far = draw(truth, rng, 16, 0.01, "far")
    near = draw(truth, rng, 16, 0.01, "near", factor=0.7)
    for one, gap in ((far, 0.06), (near, 0.005)):
        one.properties.update(diameter=0.02)
        object.__setattr__(one, "floor_gap", gap)
    curves = [levitation_curve(one, draws=100) for one in (far, near)]
    fit = calibrate_curves(curves, setup)
    np.testing.assert_allclose(fit.values, [0.4, 3.0], rtol=0.1)
    assert "near: 16 points in ground effect are left out" in " ".join(fit.warnings)
    assert len(fit.points) == 16
    kept = calibrate_curves(curves, setup, keep_ground_effect=True)
    assert len(kept.points) == 32
    assert not any("ground effect" in text for text in kept.warnings)
    with pytest.raises(lf.ParameterError, match="all points are in ground effect"):
        calibrate_curves(curves[1:], setup)


@pytest.mark.parametrize(
    ("count", "says"), [(1, "has 1 point;"), (7, "has 7 points;"), (0, "1 pressure;")]
)
def test_too_few_points(count, says):
    pressure = np.full(12, 3.0) if count == 0 else np.geomspace(1.0, 9.0, count)
    points = LiftOffs("a", pressure, np.full(len(pressure), 900.0), "points.csv:2")
    with pytest.raises(lf.ConfigurationError, match=f"points.csv:2: a .*{says}"):
        levitation_curve(points)


def test_files_and_ground_effect(write):
    path = write(
        "Sample;Launchpad;Diameter (mm);Floor gap (mm);p / mTorr;I / kW/m2\n"
        "Ge;plate;20;5;30;1,5\nGe;mesh;20;60;30;1,6\nGe;mesh;20;60;31;1,6\n",
        "points.csv",
    )
    samples, table = read_lift_offs(path)
    assert [one.name for one in samples] == ["Ge on plate", "Ge on mesh"]
    assert [one.in_ground_effect for one in samples] == [True, False]
    assert samples[1].irradiance.tolist() == [1600.0, 1600.0]
    assert len(table) == 3
    path.write_text("sample,pressure [Pa],irradiance [W/m^2],diameter [cm]\na,1,2,2\na,2,3,4\n",
                    encoding="utf-8")  # fmt: skip
    with pytest.raises(lf.ConfigurationError, match=r"points\.csv:2: a has more than one diam"):
        read_lift_offs(path)


def test_repeated_lines_of_a_log_with_times_are_rejected(tmp_path):
    path = tmp_path / "points.csv"
    rows = "0,1,20\n1,2,30\n1,2,30\n2,2,30\n"
    for time, kept in (("time [s]", 3), ("remark", 4)):
        path.write_text(f"{time},pressure [Pa],irradiance [W/m^2]\n{rows}", encoding="utf-8")
        assert len(read_lift_offs(path)[1]) == kept


def test_model_and_calibration(truth, rng):
    film = FilmProperties(1e-3, 0.75, 0.48, 0.48, tac_top=0.8, tac_bottom=0.9)
    setup = Setup(Disk(film, radius=0.02), Chamber(), Lu2023(0.5, 2.0))
    points = draw(truth, rng, 16, 0.01)
    points.properties.update(emittance=0.08, diameter=0.02)
    fit = calibrate_curves([levitation_curve(points, draws=100)], setup)
    np.testing.assert_allclose(fit.values, [0.4, 3.0], rtol=0.1)
    pressure, light = model_curve(points, fit.setup)
    inside = (pressure > RANGE[0]) & (pressure < RANGE[1])
    np.testing.assert_allclose(
        np.log(light[inside]), np.interp(np.log(pressure[inside]), *truth), atol=0.05
    )


def two_powers(rng):
    """Logarithms of pressures and of two powers of them and a constant."""
    fine = np.linspace(np.log(1.2), np.log(40.0), 4000)
    rise, fall, flat = rng.uniform(0.8, 1.3), rng.uniform(0.8, 1.2), rng.uniform(0.0, 0.8)
    away = fine - np.log(rng.uniform(3.4, 5.5))
    return fine, np.log(700.0 * (np.exp(-fall * away) + np.exp(rise * away) + flat))


def across_a_gap(rng, gap, count=28, curve=None):
    """Points of a curve, none within the gap."""
    fine, light = curve or two_powers(rng)
    x = rng.uniform(fine[0], fine[-1], count)
    x = np.sort(x[(x < np.log(gap[0])) | (x > np.log(gap[1]))])
    y = np.interp(x, fine, light) + 0.05 * rng.normal(size=x.size)
    return LiftOffs("a", np.exp(x), np.exp(y), "a.csv:2")


def test_intervals_across_a_gap_hold_the_truth(truth):
    """A model's curve is steeper on one side; a polynomial of degree 4 held 66 % of the optima."""
    rng, hits, trials = np.random.default_rng(11), np.zeros(2), 30
    best = truth[1].argmin()
    for seed in range(trials):
        gap = rng.uniform(1.8, 2.8), rng.uniform(7.0, 10.0)
        points = across_a_gap(rng, gap, 60, truth)
        fit = levitation_curve(
            points, draws=200, seed=seed, pressure_accuracy=0.0, irradiance_accuracy=0.0
        )
        found = fit.optimal_pressure, fit.minimum_irradiance
        hits += [one.interval[0] <= np.exp(axis[best]) <= one.interval[1]
                 for one, axis in zip(found, truth, strict=True)]  # fmt: skip
    assert np.all(hits >= stats.binom.ppf(1e-3, trials, 0.95))


def test_a_minimum_in_a_gap_is_in_doubt(rng):
    points = across_a_gap(rng, (2.0, 9.3))
    below = points.pressure[points.pressure < 2.0].max()
    above = points.pressure[points.pressure > 9.3].min()
    curve = levitation_curve(points, pressure_accuracy=0.0, irradiance_accuracy=0.0)
    (doubt,) = (one for one in curve.warnings if isinstance(one, Doubt))
    assert f"no point between {below:.3g} and {above:.3g} Pa, where its minimum lies" in doubt
    whole = across_a_gap(rng, (2.0, 2.0))
    curve = levitation_curve(whole, pressure_accuracy=0.0, irradiance_accuracy=0.0)
    assert not [one for one in curve.warnings if isinstance(one, Doubt)]


@pytest.mark.parametrize("other", ["GE 2 cm", "Ge\u00a02 cm", "Ge  2 cm", "ge 2\u202fcm"])
def test_names_that_differ_in_case_or_blanks_are_one_sample(write, other):
    rows = [f"{'Ge 2 cm' if i % 2 else other},{1.5 * 1.3**i:.4f},{900 + i}" for i in range(12)]
    path = write("\n".join(["sample,pressure [Pa],irradiance [W/m^2]", *rows]), "points.csv")
    (one,), table = read_lift_offs(path)
    assert len(one.pressure) == 12
    if " ".join(other.split()) != "Ge 2 cm":
        assert any("is taken for" in note for note in table.notes)


def test_points_that_stand_in_the_file_twice(rng):
    points = across_a_gap(rng, (2.0, 2.0))
    twice = replace(
        points, pressure=np.tile(points.pressure, 2), irradiance=np.tile(points.irradiance, 2)
    )
    said = [one for one in levitation_curve(twice, draws=100).warnings if "copies" in one]
    assert said == [
        "a: 28 of 56 rows are copies of others, to all digits: the intervals count them as "
        "measured again"
    ]
    assert isinstance(said[0], Doubt)


def test_points_at_the_gauges_end_are_left_out(rng, write):
    """A gauge that shows no more than 20 Pa, while the sample needs more and more light."""
    points = across_a_gap(rng, (2.0, 2.0), count=40)
    shown = np.minimum(points.pressure, 20.0)
    assert np.sum(shown == 20.0) >= 3
    rows = "".join(f"{p:.6g},{i:.6g}\n" for p, i in zip(shown, points.irradiance, strict=True))
    file = write("pressure [Pa],irradiance [W/m^2]\n" + rows, "points.csv")
    (one,), _ = read_lift_offs(file)
    assert one.pressure.max() < 20.0
    assert "the gauge is at the end of its range, 20 Pa" in one.notes[0]
