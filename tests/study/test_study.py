"""What a study file says, and the errors about it."""

import re

import jax
import numpy as np
import pytest
from scipy import stats

import lightflyer as lf
from lightflyer.study.axes import LogUniform, Normal, StudyAxis, Uniform, draw_samples, read_entry
from lightflyer.study.study import make_study, read_study

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
def study_file(flyer_file, write):
    """Write a study file with one text replaced by another, beside a flyer file."""
    flyer_file()
    return lambda old="", new="", text=STUDY: write(text, "study.toml", (old, new))


def test_the_example_is_read(study_file):
    study = read_study(study_file())
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
    assert study.design.text.startswith("[flyer]")


MISTAKES = [
    ('"film.emittance"', '"film.emitance"', 5, 'did you mean "film.emittance"?'),
    ('"film.emittance"', '"emittance"', 5, 'did you mean "film.emittance"?'),
    ("altitude =", "pressure =", 6, "pressure is not a number of the design"),
    ('"60 km"', '"60 kg"', 6, 'unit "kg" is of the wrong kind; give one that converts to m'),
    ('"60 km"', "60", 6, '60 has no unit; write "60 km"'),
    ('"60 km"', '"90 km"', 6, "is an empty range: from and to are both 90 km"),
    ('"60 km"', '"95 km"', 6, "is an empty range: 95 km is above 90 km"),
    ("points = 61", "points = 1", 6, "points = 1 must be a whole number of at least 2"),
    ("points = 61", "points = 6.5", 6, "points = 6.5 must be a whole number"),
    ("points = 61", "pints = 61", 6, "pints is not part of a range"),
    (', points = 61 }', " }", 6, "needs points"),
    ("points = 100,", "points = 100000000,", 4, "must be at most 10000000"),
    ('scale = "log"', 'scale = "lag"', 4, 'scale = "lag" is unknown; choose from linear, log'),
    ('"90 km"', '"130 km"', 6, "must be between 0 and 120000"),
    ("0.12]", "1.2]", 5, "must be between 0 (excluded) and 1"),
    ("[0.06, 0.08, 0.12]", "[]", 5, "is an empty list"),
    ("[0.06, 0.08, 0.12]", "[0.06, 0.06]", 5, "has a repeated value"),
    ("[0.06, 0.08, 0.12]", '{ distribution = "gamma" }', 5, 'distribution = "gamma" is unknown'),
    ("[0.06, 0.08, 0.12]", '{ distribution = "normal", mean = 0.1 }', 5, "standard_deviation"),
    ("[0.06, 0.08, 0.12]", "true", 5, "is not a number"),
    ('"temperature"', '"temperatur"', 9, 'did you mean "temperature"?'),
    ('"lift"', '"band_width"', 9, "is searched over all altitudes"),
    ("altitude = {", '"force.c_fm" = 0.4 #', 9, '"temperature" needs altitude'),
    ("[outputs]", "[output]", 8, "output is not a key of a study file"),
    ("variables", "variable", 9, 'did you mean "variables"?'),
    ('flyer = "flyer.toml" ', 'flyer = "fly.toml" ', 1, 'flyer = "fly.toml" does not exist'),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "line", "message"), MISTAKES)
def test_a_mistake_is_one_line_with_its_place(study_file, old, new, line, message):
    path = study_file(old, new)
    with pytest.raises(lf.ConfigurationError, match=re.escape(message)) as caught:
        read_study(path)
    assert str(caught.value).startswith(f"{path}:{line}:"), caught.value


@pytest.mark.parametrize(
    ("field_name", "why"),
    [
        ("environment.altitude_min", "where bands are searched"),
        ("film.tac_correlation", "about uncertainties"),
    ],
)
def test_what_cannot_be_varied_is_said(design, field_name, why):
    with pytest.raises(lf.ConfigurationError, match=why):
        design.field(field_name)


def test_one_emittance_for_both_faces_or_two(design):
    entries = {"film.emittance": [0.1], "film.emittance_top": [0.2], "altitude": "70 km"}
    with pytest.raises(lf.ConfigurationError, match="cannot vary together"):
        make_study(design, entries, ["lift"])


CHANGED = {
    "flyer.hanging_radius": 0.002,
    "flyer.diameter": 0.03,
    "flyer.payload": 1e-7,
    "flyer.tilt": 20.0,
    "flyer.azimuth": 30.0,
    "film.areal_density": 2e-3,
    "film.absorptance": 0.6,
    "film.absorptance_bottom": 0.5,
    "film.emittance_top": 0.2,
    "film.emittance_bottom": 0.3,
    "film.tac_top": 0.7,
    "film.tac_bottom": 0.95,
    "film.transmittance": 0.1,
    "film.transmittance_bottom": 0.15,
    "film.infrared_transmittance": 0.2,
    "environment.irradiance": 1000.0,
    "environment.incidence": 30.0,
    "environment.gravity": 9.5,
    "environment.infrared_top": 10.0,
    "environment.infrared_bottom": 200.0,
    "environment.albedo": 0.3,
    "environment.floor": 0.05,
    "force.c_fm": 0.5,
    "force.c_cont": 2.0,
}


def test_every_number_of_the_file_reaches_the_setup(film_section):
    """Each field, varied, changes the setup as the same number written in the file does."""
    film = {key: value for key, value in film_section.items() if key != "emittance"}
    film |= {"emittance_top": 0.08, "emittance_bottom": 0.08}
    sections = {
        "flyer": {"diameter": "2 cm", "tilt": "10 deg"},
        "film": film,
        "environment": {"atmosphere": "lu2023"},
        "force": {"model": "lu2023"},
    }
    design = lf.FlyerFile(**sections).design()
    assert set(design.fields) == {*CHANGED, "film.emittance", "force.force_error", "altitude"}
    base = jax.tree.leaves(design.setup)
    for name, value in CHANGED.items():
        section, _, key = name.partition(".")
        text = f"{value:.17g} {design.field(name).quantity.unit}".rstrip()
        written = lf.FlyerFile(**sections | {section: sections[section] | {key: text}})
        expected = jax.tree.leaves(written.build())
        found = jax.tree.leaves(design.build({name: np.array([value, value])}))
        np.testing.assert_array_equal([np.ravel(leaf)[0] for leaf in found], expected, name)
        assert any(np.ndim(leaf) for leaf in found), name
        assert len(expected) != len(base) or expected != base, name
    both = design.build({"film.emittance": 0.2}).flyer.film
    assert (both.emittance_top, both.emittance_bottom) == (0.2, 0.2)


def test_a_text_with_an_uncertainty_is_a_normal_distribution(design):
    found = read_entry("0.80 ± 0.05", design.field("film.tac_top"))
    assert found == Normal(design.field("film.tac_top"), 0.8, 0.05)
    assert isinstance(read_entry(0.8, design.field("film.tac_top")), StudyAxis)


@pytest.mark.filterwarnings("ignore:film.absorptance. 31 %")
@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
def test_samples_follow_their_distributions(design, method):
    parts = [
        Normal(design.field("film.absorptance"), 0.95, 0.1),
        Uniform(design.field("film.tac_top"), 0.5, 1.0),
        LogUniform(design.field("flyer.diameter"), 0.01, 0.1),
    ]
    drawn = draw_samples(parts, 4096, method, seed=5)
    # scipy.stats' own distributions, and what is impossible cut off
    expected = [
        stats.truncnorm(-9.5, 0.5, loc=0.95, scale=0.1),
        stats.uniform(0.5, 0.5),
        stats.loguniform(0.01, 0.1),
    ]
    for values, law in zip(drawn.values(), expected, strict=True):
        assert stats.kstest(values, law.cdf).pvalue > 1e-3
    assert drawn["film.absorptance"].max() <= 1.0
    again = draw_samples(parts, 4096, method, seed=5)
    other = draw_samples(parts, 4096, method, seed=6)
    for name, values in drawn.items():
        np.testing.assert_array_equal(values, again[name])
        assert not np.array_equal(values, other[name])


def test_too_many_samples_are_refused(design):
    part = Uniform(design.field("film.tac_top"), 0.5, 1.0)
    with pytest.raises(lf.ConfigurationError, match="do not fit into memory"):
        draw_samples([part, part], 6_000_000, "sobol", 0)


def test_bare_numbers_that_mean_something_else_are_told(design):
    with pytest.warns(lf.ParameterWarning, match="kilomet|m is meant|metres"):
        read_entry(np.array([70.0, 72.0]), design.field("altitude"))
    with pytest.raises(lf.ConfigurationError, match=r'write "72000\.0 m"'):
        read_entry(["70 km", 72e3], design.field("altitude"))
    with pytest.raises(lf.ConfigurationError, match='write "72 km"'):
        read_entry(["70 km", "72"], design.field("altitude"))
    with pytest.raises(lf.ConfigurationError, match="real numbers, not of complex128"):
        read_entry(np.array([7e4 + 0j]), design.field("altitude"))
