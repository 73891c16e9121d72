"""What a study file says, and how it is told that it is wrong."""

import re

import numpy as np
import pytest
from scipy import stats

import lightflyer as lf
from lightflyer.flight.fields import build, field, fields
from lightflyer.sweeps.axes import Axis, Distribution, draw, read_entry
from lightflyer.sweeps.study import make_study, sweep_study

STUDY = """\
flyer = "flyer.toml"                  # relative to this file

[sweep]
"flyer.diameter" = { from = "0.5 cm", to = "5 cm", points = 100, scale = "log" }
"film.emittance" = [0.06, 0.08, 0.12]
altitude = { from = "60 km", to = "90 km", points = 61 }

[outputs]
variables = ["temperature", "lift", "relative_payload", "levitation_irradiance"]
"""


@pytest.fixture
def study_file(flyer_file, tmp_path):
    """Write a study file with one text replaced by another, beside a flyer file."""

    def write(old="", new="", text=STUDY):
        flyer_file()
        assert old in text
        path = tmp_path / "study.toml"
        path.write_text(text.replace(old, new, 1) if old else text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def configuration(flyer_file):
    return lf.read_flyer_file(flyer_file())


def test_the_example_is_read(study_file):
    study = sweep_study(study_file())
    assert [dimension.name for dimension in study.dimensions] == [
        "flyer.diameter",
        "film.emittance",
        "altitude",
    ]
    assert study.shape == (100, 3, 61)
    diameter = study.dimensions[0].values["flyer.diameter"]
    np.testing.assert_allclose(diameter[[0, -1]], [0.005, 0.05])
    np.testing.assert_allclose(np.diff(np.log(diameter)), np.log(10.0) / 99)
    np.testing.assert_allclose(np.diff(study.dimensions[2].values["altitude"]), 500.0)
    assert study.flyer_text.startswith("[flyer]")


MISTAKES = [
    ('"film.emittance"', '"film.emitance"', 5, 'did you mean "film.emittance"?'),
    ('"film.emittance"', '"emittance"', 5, 'did you mean "film.emittance"?'),
    ("altitude =", "pressure =", 6, "pressure is not a number of the flyer file"),
    ('"60 km"', '"60 kg"', 6, 'unit "kg" is of the wrong kind; give one that converts to m'),
    ('"60 km"', "60", 6, '60 has no unit; write "60 m"'),
    ('"60 km"', '"90 km"', 6, "is an empty range: from and to are both 90 km"),
    ('"60 km"', '"95 km"', 6, "is an empty range: 95 km is above 90 km"),
    ("points = 61", "points = 1", 6, "points = 1 must be a whole number of at least 2"),
    ("points = 61", "points = 6.5", 6, "points = 6.5 must be a whole number"),
    ("points = 61", "pints = 61", 6, "pints is not part of a range"),
    (', points = 61 }', " }", 6, "needs points"),
    ("points = 100,", "points = 100000000,", 4, "must be at most 10000000"),
    ('scale = "log"', 'scale = "lag"', 4, 'scale = "lag" is unknown; there are: linear, log'),
    ('"90 km"', '"130 km"', 6, "must be between 0 and 120000"),
    ("0.12]", "1.2]", 5, "must be between 0 (excluded) and 1"),
    ("[0.06, 0.08, 0.12]", "[]", 5, "is an empty list"),
    ("[0.06, 0.08, 0.12]", "[0.06, 0.06]", 5, "holds a value twice"),
    ("[0.06, 0.08, 0.12]", '{ distribution = "gamma" }', 5, 'distribution = "gamma" is unknown'),
    ("[0.06, 0.08, 0.12]", '{ distribution = "normal", mean = 0.1 }', 5, "standard_deviation"),
    ("[0.06, 0.08, 0.12]", "true", 5, "is not a number"),
    ('"temperature"', '"temperatur"', 9, 'did you mean "temperature"?'),
    ('"lift"', '"band_width"', 9, "is searched over all altitudes"),
    ("altitude = {", '"force.c_fm" = 0.4 #', 9, '"temperature" needs altitude'),
    ("[outputs]", "[output]", 8, "output is not a key of a study file"),
    ("variables", "variable", 8, 'did you mean "variables"?'),
    ('flyer = "flyer.toml" ', 'flyer = "fly.toml" ', 1, 'flyer = "fly.toml" is no file'),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "line", "message"), MISTAKES)
def test_a_mistake_is_one_line_with_its_place(study_file, old, new, line, message):
    path = study_file(old, new)
    with pytest.raises(lf.ConfigurationError, match=re.escape(message)) as caught:
        sweep_study(path)
    assert str(caught.value).startswith(f"{path}:{line}:"), caught.value


@pytest.mark.parametrize(
    ("field_name", "why"),
    [
        ("environment.altitude_min", "where bands are searched"),
        ("film.tac_correlation", "about uncertainties"),
    ],
)
def test_what_cannot_be_varied_is_said(configuration, field_name, why):
    with pytest.raises(lf.ConfigurationError, match=why):
        field(configuration, field_name)


def test_one_emittance_for_both_faces_or_two(configuration):
    entries = {"film.emittance": [0.1], "film.emittance_top": [0.2], "altitude": "70 km"}
    with pytest.raises(lf.ConfigurationError, match="that of both faces"):
        make_study(configuration, entries, ["lift"])


def test_every_number_of_the_file_reaches_the_setup(configuration):
    """Each field, varied, changes the setup as the same number written in the file does."""
    changed = {
        "flyer.diameter": 0.03,
        "flyer.payload": 1e-7,
        "film.areal_density": 2e-3,
        "film.absorptance": 0.6,
        "film.absorptance_bottom": 0.5,
        "film.emittance": 0.2,
        "film.emittance_top": 0.2,
        "film.emittance_bottom": 0.3,
        "film.tac_top": 0.7,
        "film.tac_bottom": 0.95,
        "environment.irradiance": 1000.0,
        "environment.incidence": 30.0,
        "environment.gravity": 9.5,
        "environment.infrared_top": 10.0,
        "environment.infrared_bottom": 200.0,
        "environment.albedo": 0.3,
        "force.c_fm": 0.5,
        "force.c_cont": 2.0,
    }
    assert set(fields(configuration)) - {"altitude"} == set(changed)
    unchanged = [float(leaf) for leaf in _leaves(build(configuration, {}))]
    for name, value in changed.items():
        found = _leaves(build(configuration, {name: np.array([value, value])}))
        assert any(np.ndim(leaf) for leaf in found), name
        flat = [float(np.ravel(leaf)[0]) for leaf in found]
        assert flat != unchanged, name
        if name.startswith("film.emittance"):
            continue  # below
        written = _written(configuration, name, value)
        assert flat == [float(leaf) for leaf in _leaves(build(written, {}))], name
    film = build(configuration, {"film.emittance": 0.2})[0].film
    assert (film.emittance_top, film.emittance_bottom) == (0.2, 0.2)
    film = build(configuration, {"film.emittance_top": 0.2})[0].film
    assert (film.emittance_top, film.emittance_bottom) == (0.2, 0.08)


def _written(configuration, changed, value):
    """The flyer file with one number written into it."""
    sections = configuration.model_dump(exclude_none=True)
    section, _, key = changed.partition(".")
    sections[section][key] = lf.Measured(value)
    known = fields(configuration)
    for section, content in sections.items():
        for key, entry in content.items():
            if isinstance(entry, tuple):
                unit = known[f"{section}.{key}"].quantity.unit if key != "tac_correlation" else ""
                content[key] = f"{entry[0]:.17g} {unit}".rstrip()
    return lf.FlyerFile(**sections)


def _leaves(setup):
    flyer, environment, model = setup
    film, light = flyer.film, environment.radiation
    optional = (light.infrared_top, light.infrared_bottom)
    return [
        *(flyer.radius, flyer.payload, environment.gravity, model.c_fm, model.c_cont),
        *(film.areal_density, film.absorptance, film.absorptance_below),
        *(film.emittance_top, film.emittance_bottom, film.tac_top, film.tac_bottom),
        *(light.irradiance, light.incidence, light.albedo),
        *(-1.0 if value is None else value for value in optional),
    ]


def test_a_text_with_an_uncertainty_is_a_normal_distribution(configuration):
    found = read_entry("0.80 ± 0.05", field(configuration, "film.tac_top"))
    assert isinstance(found, Distribution)
    assert (found.first, found.second) == (0.8, 0.05)
    assert isinstance(read_entry(0.8, field(configuration, "film.tac_top")), Axis)


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
def test_samples_follow_their_distributions(configuration, method):
    known = field(configuration, "film.absorptance")
    parts = [
        Distribution(known, "normal", 0.95, 0.1),
        Distribution(field(configuration, "film.tac_top"), "uniform", 0.5, 1.0),
        Distribution(field(configuration, "flyer.diameter"), "log-uniform", 0.01, 0.1),
    ]
    drawn = draw(parts, 4096, method, seed=5)
    # scipy.stats' own distributions, and what is impossible cut off
    expected = [
        stats.truncnorm(-9.5, 0.5, loc=0.95, scale=0.1),
        stats.uniform(0.5, 0.5),
        stats.loguniform(0.01, 0.1),
    ]
    for values, law in zip(drawn.values(), expected, strict=True):
        assert stats.kstest(values, law.cdf).pvalue > 1e-3
    assert drawn["film.absorptance"].max() <= 1.0
    again = draw(parts, 4096, method, seed=5)
    other = draw(parts, 4096, method, seed=6)
    for name, values in drawn.items():
        np.testing.assert_array_equal(values, again[name])
        assert not np.array_equal(values, other[name])


def test_too_many_samples_are_refused(configuration):
    part = Distribution(field(configuration, "film.tac_top"), "uniform", 0.5, 1.0)
    with pytest.raises(lf.ConfigurationError, match="too many to be held"):
        draw([part, part], 6_000_000, "sobol", 0)
