from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import least_squares

import lightflyer as lf
from lightflyer.files.table import Table
from lightflyer.gas import AIR
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.tac import intervals, preparation
from lightflyer.lab.tac.data import EXACT, TacAccuracy, TacRun
from lightflyer.lab.tac.difference import _means, fit_tac_difference
from lightflyer.lab.tac.fit import fit_tac
from lightflyer.lab.tac.problem import KINETIC_LAW

DIAMETER = 24e-3
TOP, BOTTOM = (0.75, 1.22, 4.09), (0.90, 1.15, 4.60)
USUAL = TacAccuracy()


@pytest.fixture(autouse=True)
def one_law(monkeypatch):
    """Coefficients by other laws are not asked for, and take longest."""
    monkeypatch.setattr(preparation, "HEAT_LAWS", {})


def run_of(face, rng, noise=0.005, off=(0.0,) * 6, count=40):
    """A run whose instruments and plateau are off by standard errors, in the order above."""
    gauge, zero, power, temperature, diameter, plateau = off
    wide = DIAMETER + USUAL.diameter * diameter
    pressure = np.geomspace(1e-2, 200.0, count) * np.exp(0.03 * rng.normal(size=count))
    heater, ambient = np.full(count, 323.0), np.full(count, 295.0)
    limits = KINETIC_LAW.limits(pressure, ambient, heater, wide, AIR)
    alpha, ratio, offset = face
    thin = alpha * limits.free_molecular
    dense = limits.continuum(alpha) * np.exp(USUAL.plateau * plateau)
    watts = ratio * (thin * dense / (thin + dense) + offset) * 0.25 * np.pi * wide**2 * 28.0
    watts = watts * np.exp(USUAL.power * power) * (1.0 + noise * rng.normal(size=count))
    read = pressure * np.exp(USUAL.gauge * gauge) + USUAL.gauge_zero * zero
    table = Table(f"tac {alpha:g}", np.arange(count) + 2, {})
    read_heater = heater + USUAL.temperature * temperature
    return TacRun(table, np.maximum(read, 1e-4), watts, read_heater, ambient)


def width(one):
    return one.interval[1] - one.interval[0]


def covers(one, truth):
    return one.interval[0] <= truth <= one.interval[1]


@pytest.mark.parametrize("drift", [0.0, 0.05])
def test_equals_scipy_with_both_faces_and_the_instruments_written_out(rng, monkeypatch, drift):
    monkeypatch.setattr(intervals, "LAW_ERROR", 0.0)
    accuracy = replace(USUAL, plateau_drift=drift)
    found = fit_tac_difference(run_of(TOP, rng), run_of(BOTTOM, rng), accuracy=accuracy)
    fits = found.fits
    late = drift * np.linspace(-0.5, 0.5, 40)

    def residuals(unknowns):
        gauge, zero, power, temperature, diameter, plateau, *drifts = unknowns[6:]
        wider = USUAL.diameter / DIAMETER * diameter
        rows = []
        faces = unknowns[:3], unknowns[3:6]
        for fit, (alpha, ratio, offset), drifts_by in zip(fits, faces, drifts, strict=True):
            read = np.exp(USUAL.gauge * gauge) + USUAL.gauge_zero * zero / fit.pressure
            thin = alpha * fit.limits.free_molecular * read
            dense = fit.limits.continuum(alpha) * np.exp(
                fit.limits.slope * USUAL.gauge * gauge + USUAL.plateau * plateau - wider
                + drifts_by * late
            )  # fmt: skip
            amplitude = np.exp(
                USUAL.power * power + USUAL.temperature / 28.0 * temperature + 2.0 * wider
            )
            model = ratio * amplitude * (thin * dense / (thin + dense) + offset)
            rows.append((model - fit.conductance) * fit.weight / fit.scatter)
        return np.concatenate([*rows, unknowns[6:]])

    start = np.array([*TOP, *BOTTOM, *np.zeros(8)])
    strictly = {"xtol": 1e-14, "ftol": 1e-14, "gtol": 1e-14}
    best = least_squares(residuals, start, **strictly)
    covariance = np.linalg.inv(best.jac.T @ best.jac)
    np.testing.assert_allclose([fit.tac.value for fit in fits], best.x[[0, 3]], rtol=2e-4)
    apart = np.eye(14)[0] - np.eye(14)[3]
    assert found.difference.value == pytest.approx(apart @ best.x, abs=2e-4)
    # that of the package carries Student's factor of the rows' scatter on
    spread = float(np.sqrt(apart @ covariance @ apart))
    assert found.difference.uncertainty == pytest.approx(spread, rel=0.03)
    related = covariance[0, 3] / np.sqrt(covariance[0, 0] * covariance[3, 3])
    assert found.tac_correlation == pytest.approx(related, rel=0.01)

    def rise(difference):
        def held(others):
            return residuals(np.array([others[2] + difference, *others]))

        return 2.0 * (least_squares(held, best.x[1:], **strictly).cost - best.cost)

    # a profile is as wide, but reaches further where the faces differ more
    ends = np.sqrt([rise(end) for end in found.difference.interval])
    np.testing.assert_allclose(ends, stats.norm.ppf(0.975), rtol=0.12)
    assert ends.mean() == pytest.approx(stats.norm.ppf(0.975), rel=0.04)


def test_errors_that_differ_between_the_faces_are_not_covered(rng):
    """A gauge that drifts by 8 % from one face to the other moves the difference."""
    drifted = run_of(BOTTOM, rng, noise=0.002, off=(1.6, 0, 0, 0, 0, 0))
    found = fit_tac_difference(run_of(TOP, rng, noise=0.002), drifted, accuracy=USUAL)
    assert not covers(found.difference, TOP[0] - BOTTOM[0])


def test_shape_of_the_law_is_shared(rng, monkeypatch):
    runs = run_of(TOP, rng, noise=0.001), run_of(BOTTOM, rng, noise=0.001)
    found = fit_tac_difference(*runs, accuracy=USUAL)
    alone = [fit_tac(run, accuracy=USUAL) for run in runs]
    for one, other in zip(found.fits, alone, strict=True):
        assert one.tac.uncertainty == pytest.approx(other.tac.uncertainty, rel=0.07)
        assert one.tac.value == pytest.approx(other.tac.value, abs=0.3 * other.tac.uncertainty)
    monkeypatch.setattr(intervals, "LAW_OWN", 1.0)
    apart = fit_tac_difference(*runs, accuracy=USUAL)
    assert found.difference.uncertainty < 0.8 * apart.difference.uncertainty
    monkeypatch.undo()
    # where the law's error changes with the coefficient, nothing of it is shared
    monkeypatch.setattr(preparation, "HEAT_LAWS", {})
    low = run_of((0.4, 1.22, 4.09), rng, noise=0.001), runs[1]
    ours = fit_tac_difference(*low, accuracy=USUAL).difference.uncertainty
    monkeypatch.setattr(intervals, "LAW_OWN", 1.0)
    assert fit_tac_difference(*low, accuracy=USUAL).difference.uncertainty == pytest.approx(ours)


def test_without_common_errors_nothing_is_shared(rng):
    runs = run_of(TOP, rng), run_of(BOTTOM, rng)
    found = fit_tac_difference(*runs, accuracy=EXACT)
    alone = [fit_tac(run, accuracy=EXACT).tac for run in runs]
    assert found.tac_correlation == pytest.approx(0.0, abs=1e-9)
    assert found.difference.value == pytest.approx(alone[0].value - alone[1].value, rel=1e-9)
    both = np.hypot(alone[0].uncertainty, alone[1].uncertainty)
    assert found.difference.uncertainty == pytest.approx(both, rel=0.05)


class _Fit:
    """A fit with a coefficient and its uncertainty by the scatter of rows."""

    def __init__(self, value, spread):
        self.tac = Estimate.normal(value, spread)
        self.statistical = {"tac": Estimate.normal(value, spread)}


def test_mountings_that_differ_widen_the_difference():
    top = [_Fit(value, 0.01) for value in (0.70, 0.76, 0.79)]
    bottom = [_Fit(value, 0.01) for value in (0.88, 0.94, 0.91)]
    shared = 0.05**2 * np.ones((6, 6))
    means, joint = _means(top, bottom, shared + 0.01**2 * np.eye(6))
    np.testing.assert_allclose(means, [0.75, 0.91])
    # pooled variance of both faces, by Student for four degrees of freedom
    residuals = np.array([-0.05, 0.01, 0.04, -0.03, 0.03, 0.0])
    pooled = np.sqrt(residuals @ residuals / 4.0 / 3.0)
    own = stats.t.ppf(0.975, 4) / stats.norm.ppf(0.975) * pooled
    np.testing.assert_allclose(joint, 0.05**2 + own**2 * np.eye(2), rtol=1e-6)
    alike = [_Fit(0.75, 0.01) for _ in range(3)], [_Fit(0.9, 0.01) for _ in range(3)]
    _, joint = _means(*alike, shared + 0.01**2 * np.eye(6))
    np.testing.assert_allclose(joint, 0.05**2 + 0.01**2 / 3.0 * np.eye(2), rtol=1e-6)


def test_several_mountings_of_each_face(rng):
    off = rng.normal(size=6)
    top, bottom = ([run_of(face, rng, off=off) for _ in range(2)] for face in (TOP, BOTTOM))
    found = fit_tac_difference(top, bottom, accuracy=USUAL)
    assert [len(found.top), len(found.bottom)] == [2, 2]
    assert not any("mounted anew" in text for text in found.warnings)
    single = fit_tac_difference(top[0], bottom[0], accuracy=USUAL)
    assert any("mounted anew" in text for text in single.warnings)
    assert covers(found.difference, TOP[0] - BOTTOM[0])
    with pytest.raises(lf.ParameterError, match="bottom has no run; give one or more of each"):
        fit_tac_difference(top, [])


def test_sample_on_one_face_of_the_heater(rng):
    """Both runs see the mean of the sample's face and the heater's other one."""
    faces = [((alpha + 0.7) / 2.0, ratio, offset) for alpha, ratio, offset in (TOP, BOTTOM)]
    runs = [run_of(face, rng, noise=1e-3) for face in faces]
    plain = fit_tac_difference(*runs, accuracy=EXACT)
    found = fit_tac_difference(*runs, accuracy=EXACT, other_face=lf.Measured(0.7, 0.1))
    assert found.difference.value == pytest.approx(2.0 * plain.difference.value)
    assert found.difference.uncertainty == pytest.approx(2.0 * plain.difference.uncertainty)
    assert found.difference.value == pytest.approx(TOP[0] - BOTTOM[0], abs=0.02)
    assert found.tac_top.value == pytest.approx(TOP[0], abs=0.02)
    assert "is the mean of that of the sample and that of the heater's other face, 0.7" in str(
        found
    )
    # the other face's error is that of both, and of no difference
    assert found.tac_top.uncertainty == pytest.approx(0.1, rel=0.02)
    assert found.tac_correlation > 0.99
    rough = [run_of((0.3, 1.2, 4.0), rng, noise=1e-3) for _ in range(2)]
    with pytest.raises(lf.ConfigurationError, match=r"top face would have a coefficient of -0\.3"):
        fit_tac_difference(*rough, accuracy=EXACT, other_face=lf.Measured(0.9))
    with pytest.raises(lf.ParameterError, match=r"other_face = 1\.5 is not between 0 and 1"):
        fit_tac_difference(*runs, accuracy=EXACT, other_face=lf.Measured(1.5))


def test_film_values_give_the_uncertainty_of_the_difference(rng):
    """As a flyer file has them, the correlation rounded."""
    found = fit_tac_difference(run_of(TOP, rng), run_of(BOTTOM, rng), accuracy=USUAL)
    values = found.film_values()
    top, bottom, related = (
        values["film", key] for key in ("tac_top", "tac_bottom", "tac_correlation")
    )
    one, other = top.uncertainty, bottom.uncertainty
    spread = np.sqrt(one**2 + other**2 - 2.0 * related.value * one * other)
    assert spread == pytest.approx(found.difference.uncertainty, rel=5e-3)
    assert len(f"{related.value:.10g}") <= 6


def test_result_in_words_table_and_figure(rng):
    found = fit_tac_difference(run_of(TOP, rng), run_of(BOTTOM, rng), accuracy=USUAL)
    assert "TAC α, top less bottom" in str(found)
    written = found.tables()["tac-difference.csv"].splitlines()
    cells = written[-1].split(",")
    assert cells[0] == "difference"
    assert float(cells[1]) == pytest.approx(found.difference.value)
    (ax,) = found.plot().axes
    outline = ax.lines[0].get_xydata()
    for column, one in ((0, found.tac_bottom), (1, found.tac_top)):
        assert np.ptp(outline[:, column]) == pytest.approx(2.0 * 1.96 * one.uncertainty, rel=1e-3)
    apart = np.ptp(outline[:, 1] - outline[:, 0])
    assert apart == pytest.approx(width(found.difference), rel=1e-3)
