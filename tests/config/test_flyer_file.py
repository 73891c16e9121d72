import operator
import string
from typing import ClassVar, Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import lightflyer as lf
from lightflyer.config.designs import as_design
from lightflyer.config.flyer_file import section_at
from lightflyer.core.quantity import Length


def test_a_file_becomes_the_objects_it_describes(flyer_file):
    setup = lf.read_flyer_file(flyer_file()).build()
    assert setup.flyer.radius == 0.01
    assert setup.flyer.film.areal_density == pytest.approx(1e-3)
    assert isinstance(setup.environment.atmosphere, lf.environment.Lu2023Atmosphere)
    assert setup.environment.radiation.irradiance == 1360.0
    assert setup.model.reading == lf.force.REPORTED


def test_the_same_in_python_and_the_defaults(film_section):
    setup = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film_section).build()
    assert isinstance(setup.environment, lf.Earth)
    assert isinstance(setup.environment.atmosphere, lf.environment.US1976)
    assert setup.environment.radiation.zenith_angle == 0.0
    assert isinstance(setup.model, lf.Kinetic)
    assert setup.search_range == (None, None)


LIGHT, EARTH = 'incidence = "0 deg"', 'kind = "earth"\natmosphere = "lu2023"'
MODEL = '"lu2023"\nreading = "reported"\nc_fm = 0.4\nc_cont = 3.0'
NRLMSIS = (
    'kind = "earth"\natmosphere = "nrlmsis"\ndate = 2024-06-21T12:00:00Z\nlatitude = "40 deg"\n'
    'longitude = "-75 deg"\nf107 = 150\nap = 4'
)
CHAMBER = (
    'kind = "chamber"\ntemperature = "22 degC"\npressure_min = "1 mTorr"\npressure_max = "1 Torr"'
)


@pytest.mark.parametrize(
    ("old", "new", "names", "values"),
    [
        # the paper's atmosphere implies gas, gravity and rounding unless they are given
        ("", "", "environment.gas", lf.gas.LU2023_AIR),
        ("", "", "environment.gravity", 9.8),
        ("", "", "environment.radiation.stefan_boltzmann", 5.67e-8),
        (LIGHT, f'{LIGHT}\ngas = "air"', "environment.gas", lf.gas.AIR),
        (LIGHT, f'{LIGHT}\ngravity = "9.7 m/s^2"', "environment.gravity", pytest.approx(9.7)),
        ("tac_bottom = 0.9", 'tac_bottom = "0.90 ± 0.03"', "flyer.film.tac_bottom", 0.9),
        (
            "emittance = 0.08", "emittance_top = 0.05\nemittance_bottom = 0.4",
            "flyer.film.emittance_top flyer.film.emittance_bottom", (0.05, 0.4),
        ),
        (EARTH, CHAMBER, "environment.temperature", pytest.approx(295.15)),
        (
            EARTH, CHAMBER,
            "environment.pressure_range", pytest.approx((0.133322, 133.322), rel=1e-5),
        ),
        (
            EARTH, NRLMSIS,
            "environment.atmosphere.indices.f107 environment.atmosphere.place.latitude",
            (150.0, pytest.approx(np.radians(40.0))),
        ),
        (
            LIGHT, f'{LIGHT}\naltitude_min = "60 km"\naltitude_max = "80 km"',
            "search_range", (60e3, 80e3),
        ),
        (MODEL, '"free-molecular"', "model.__class__", lf.FreeMolecular),
        (MODEL, '"free-molecular-linear"', "model.__class__", lf.force.LinearFreeMolecular),
        ("[flyer]", "\ufeff[flyer]", "flyer.radius", 0.01),  # a byte order mark does no harm
    ],
)  # fmt: skip
def test_keys_of_a_file(flyer_file, old, new, names, values):
    found = operator.attrgetter(*names.split())(lf.read_flyer_file(flyer_file(old, new)).build())
    assert found is values or found == values


def test_uncertainties_are_kept(flyer_file):
    file = lf.read_flyer_file(flyer_file("tac_bottom = 0.9", 'tac_bottom = "0.90 ± 0.03"'))
    assert file.uncertainties() == {"film.tac_bottom": pytest.approx(0.03)}


def test_a_section_defined_after_files_were_read(flyer_file):
    """Defined again, it replaces the first."""
    shape = 'shape = "disk"\ndiameter = "2 cm"'
    lf.read_flyer_file(flyer_file())
    path = flyer_file(shape, 'shape = "square"\nside = "2 cm"')
    try:
        for share in (0.5, np.pi**-0.5):

            class SquareSection(lf.flyer.FlyerSection):
                flyer_type: ClassVar[type] = lf.Disk
                factor: ClassVar[float] = share
                shape: Literal["square"]
                side: Length

                def build(self, film, incidence):
                    return lf.Disk(film, self.factor * self.side.value)

            file = lf.read_flyer_file(path)
            assert isinstance(file, lf.FlyerFile)
            assert file.build().flyer.radius == pytest.approx(share * 0.02)
        assert as_design(path).build({"flyer.side": 0.04}).flyer.area == pytest.approx(16e-4)
        with pytest.raises(
            lf.ConfigurationError, match=r"choose from (?=.*disk)(?=.*sandwich).*square"
        ):
            lf.read_flyer_file(flyer_file(shape, 'shape = "round"'))
    finally:
        del lf.flyer.FlyerSection.alternatives["square"]  # no part of the package
    with pytest.raises(lf.ConfigurationError, match="is unknown") as caught:
        lf.read_flyer_file(flyer_file(shape, 'shape = "square"'))
    assert not str(caught.value).endswith("square")


def test_one_face_varies_where_the_file_gives_both_at_once(flyer_file):
    design = as_design(flyer_file())
    film = design.build({"film.emittance_top": 0.3}).flyer.film
    assert (film.emittance_top, film.emittance_bottom) == (0.3, 0.08)
    film = design.build({"film.emittance": 0.2}).flyer.film
    assert (film.emittance_top, film.emittance_bottom) == (0.2, 0.2)


# what is replaced, by what, the line that must be named, and a part of the message
MISTAKES = [
    ("emittance = 0.08", "emitance = 0.08", 9, 'did you mean "emittance"?'),
    (
        '"lu2023"\nirradiance',
        '"lu2024"\nirradiance',
        15,
        'atmosphere = "lu2024" is unknown; choose from us1976, lu2023, nrlmsis-global, nrlmsis; '
        'did you mean "lu2023"?',
    ),
    ('"reported"', '"printd"', 21, 'force.reading = "printd" is unknown; did you mean "printed"?'),
    ("[film]", "[flim]", 6, 'did you mean "film"?'),
    ("emittance = 0.08", "emittance = 0.08\ntransmittance = 0.3", 6, "transmittance = 0.3 and abs"),
    ('kind = "earth"', 'kind = "chamber"', 13, "[environment] needs temperature"),
    ("[flyer]\n", "colour = 3\n[flyer]\n", 1, "colour is not a key of a flyer file"),
    ("[film]\n", "film.payload = 3\n[film2]\n", None, ""),
    (
        '"0 deg"',
        '"0 deg"\naltitude_min = "9 km"\naltitude_max = "8 km"',
        13,
        "altitude_min must be below altitude_max",
    ),
]


@pytest.mark.parametrize(("old", "new", "line", "message"), MISTAKES)
def test_every_mistake_names_its_line_and_what_is_allowed(flyer_file, old, new, line, message):
    path = flyer_file(old, new)
    with pytest.raises(lf.ConfigurationError) as error:
        lf.read_flyer_file(path)
    lines = str(error.value).splitlines()
    assert any(message in text for text in lines)
    if line is not None:
        assert any(text.startswith(f"{path}:{line}: ") and message in text for text in lines)


def test_every_alternative_lists_its_keys():
    assert "earth us1976" in lf.environment.EnvironmentSection.alternatives
    nrlmsis = {"environment": {"kind": "earth", "atmosphere": "nrlmsis"}}
    assert "f107" in section_at("environment", nrlmsis).model_fields
    assert "wall" in section_at("force", {}).model_fields
    assert "thickness" in section_at("film.layers.0", {"film": {"layers": []}}).model_fields
    assert section_at("weather", {}) is None


_VALUES = st.one_of(
    st.integers(),
    st.floats(),
    st.booleans(),
    st.text(string.printable, max_size=12),
    st.lists(st.integers(), max_size=2),
    st.dictionaries(st.sampled_from(["kind", "value"]), st.integers(), max_size=2),
)


@given(
    section=st.sampled_from(["flyer", "film", "environment", "force"]),
    key=st.sampled_from(["diameter", "emittance", "kind", "atmosphere", "model", "gas", "x"]),
    value=_VALUES,
)
@settings(max_examples=200, suppress_health_check=[HealthCheck.too_slow], deadline=None)
def test_any_value_anywhere_is_accepted_or_refused_as_invalid(film_section, section, key, value):
    content = {"flyer": {"diameter": "2 cm"}, "film": dict(film_section)}
    content.setdefault(section, {})[key] = value
    try:
        lf.FlyerFile.model_validate(content)
    except ValueError:  # Pydantic's ValidationError is one
        return
