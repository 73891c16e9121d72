"""Every key of every section changes a result, is refused, or is said to have no effect."""

import tomllib
from typing import Literal, get_args, get_origin

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.design.diagnostics import diagnose_at
from lightflyer.design.tables import predicted_names, table_of
from lightflyer.files.section import Section

KINDS = ("earth", "chamber", "mars", "sandwich", "plate", "balloon", "hollow", "particle")
BY_UNIT = {
    "m": "3 mm", "K": "350 K", "Pa": "50 Pa", "W/m^2": "70 W/m^2", "deg": "20 deg", "kg": "3 kg",
    "": 0.04, "kg/m^2": "2 g/m^2", "kg/m^3": "2 g/cm^3", "N/m": "100 N/m", "hour": "14 h",
    "m/s^2": "9 m/s^2", "W/(m*K)": "2 W/(m*K)",
}  # fmt: skip
BY_KEY = {
    "altitude_min": "66 km", "altitude_max": "90 km", "floor": "20 m", "lid": "20 cm",
    "radius": "20 cm", "limb_height": "15 km", "wall_error": -1.0, "channel_aspect": 20.0,
    "gas_mass": "10 kg", "temperature_offset": "5 K", "tac_correlation": 0.5,
}  # fmt: skip


FACTS = {"absorptance_bottom", "transmittance_bottom", "emittance_bottom"}
"""Of a film in whatever light; nothing comes from below in a chamber, or from within a balloon."""

SAID = {"radius": "the walls around the flyer"}
"""What a sentence calls a key."""


def other_values(section, key):
    """Values of a key that a file may have in place of its own."""
    field, quantity = section.model_fields[key], section.quantity(key)
    if quantity is not None:
        return [BY_KEY.get(key, BY_UNIT[quantity.unit])]
    kinds = (field.annotation, *get_args(field.annotation))
    choices = {choice for kind in kinds if get_origin(kind) is Literal for choice in get_args(kind)}
    return sorted(choices - {field.default}) + [not field.default] * (bool in kinds)


def places_of(setup):
    """Two places at which the flyer of a template is looked at."""
    places = {"pressure": [1.0, 30.0]}.get(setup.environment.coordinate.name, [70e3, 80e3])
    return np.array([10e3, 18e3] if type(setup.flyer) is lf.Balloon else places)


def temperatures(file):
    """Temperatures of all nodes, of which most keys change some: much quicker than all results."""
    setup = file.design().setup
    state = setup.environment.state(places_of(setup))
    found = lf.equilibrium(setup.flyer, state, setup.model, throw=False)
    return dict(enumerate(found.temperatures))


def results(file):
    """Everything that a prediction tabulates, and what it says."""
    design = file.design()
    setup = design.setup
    places = places_of(setup)
    light = setup.environment.state(places).radiation.irradiance
    irradiance = np.broadcast_to(light, places.shape)
    names = [name for name in predicted_names(setup) if not name.startswith("levitation_")]
    table = table_of(setup, places, irradiance, names)
    said = diagnose_at(setup, places, table["temperature"])
    return table | {"range": np.array(setup.search_range, float)}, (*design.warnings, *said)


def parts_of(file, content):
    """Sections, and what the file has there; of an environment or film that repeats only one."""
    for part, section in file.parts().items():
        if part == "environment" and not file.flyer.needs_film:
            continue
        yield section, content[part]
        for key in type(section).model_fields:
            if isinstance(inner := getattr(section, key), Section) and key == "top":
                yield inner, content[part][key]


def differ(found, expected):
    return found.keys() != expected.keys() or not all(
        np.allclose(found[name], column, rtol=1e-12, atol=0.0, equal_nan=True)
        for name, column in expected.items()
    )


def is_silent(file, entries, key, values, before):
    """Whether no value of a key changes a result, is refused, or is said to have no effect."""
    own, (hot, expected) = dict(entries), before
    for value in values:
        entries[key] = value
        try:
            read = file()
        except ValueError:
            return False  # in words that other tests read
        finally:
            entries.clear()
            entries.update(own)
        if differ(temperatures(read), hot):
            return False
        found, said = results(read)  # what is read is computed
        told = any("no effect" in text and SAID.get(key, key) in text for text in said)
        if told or differ(found, expected):
            return False
    return bool(values)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_key_has_an_effect_or_is_said_to_have_none(kind):
    content = tomllib.loads(templates()[kind].read())
    file = lf.FlyerFile(**content)
    before = temperatures(file), results(file)[0]
    silent = []
    for section, entries in parts_of(file, content):
        for key, field in type(section).model_fields.items():
            limit = "is a limit" in (section.reason_not_varied(key) or "")
            if field.is_required() or limit or key in FACTS:
                continue
            values = other_values(type(section), key)
            if is_silent(lambda: lf.FlyerFile(**content), entries, key, values, before):
                silent.append(f"{type(section).__name__}.{key} = {values}")
    assert not silent


@pytest.mark.parametrize(
    ("kind", "part", "key", "value", "why"),
    [
        ("earth", "flyer", "azimuth", "20 deg", "without tilt"),
        ("balloon", "flyer", "tilt", "20 deg", "without opening_diameter"),
        ("earth", "film", "tac_correlation", 0.5, "without a ± of tac_top and tac_bottom"),
        ("mars", "environment", "surroundings", "gas", "beside infrared_top and infrared_bottom"),
        ("earth", "environment", "ground", "knocke1988", "without sun"),
    ],
)
def test_what_another_key_leaves_without_effect_is_refused(kind, part, key, value, why):
    content = tomllib.loads(templates()[kind].read())
    content[part][key] = value
    with pytest.raises(ValueError, match=f"{key} has no effect {why}"):
        lf.FlyerFile(**content)


def test_what_flyer_or_gas_leaves_without_effect_is_said():
    content = tomllib.loads(templates()["earth"].read())
    content["film"]["transmittance"] = 0.1
    content["force"]["polyatomic"] = "scaled"
    _, said = results(lf.FlyerFile(**content))
    assert "transmittance has no effect: nothing lies behind the film" in said
    assert "polyatomic = scaled has no effect: the gas is not polyatomic" in said


def test_a_mission_has_one_place_and_date(write):
    text = templates()["mission"].read()
    path = write(
        text.replace("[environment]", '[environment]\nlatitude = "-80 deg"'), "mission.toml"
    )
    with pytest.raises(lf.ConfigurationError, match=r"toml:\d+: latitude is not that of .mission."):
        lf.mission.read_mission_file(path)
