"""Flyer files of every kind: what they become, and their mistakes."""

import operator
import re

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates


def of_template(kind, **values):
    """What a template says of a flyer, without air and force; some keys have other values."""
    text = templates()[kind].read().partition("[environment]")[0]
    for key, value in values.items():
        text, changed = re.subn(rf"^(# )?{key} = .*", f"{key} = {value}", text, count=1, flags=re.M)
        assert changed
    return text


FILES = {
    "balloon": of_template(
        "balloon", opening_diameter='"0.6 m"', gas='"helium"', payload='"1.0 ± 0.1 kg"'
    ),
    "hollow": of_template("hollow", form='"cone"', outlet_diameter='"4 cm"'),
    "plate": of_template("plate"),
    "sandwich": of_template("sandwich"),
    "sphere": """\
[flyer]
shape = "sphere"
diameter = "1.0 ± 0.1 um"
density = "1.8 g/cm^3"
absorption_efficiency = 1.1
emittance = 0.2
conductivity = "0.3 W/(m*K)"
tac_top = 0.9
upright = "gravity"
mass_offset = "50 nm"
""",
}
one, two, three = re.split(
    r"emittance_top = 0.1 .*\nemittance_bottom = 0.1 .*\n", FILES["sandwich"]
)
of_top = 'emittance_top = 0.1\nemittance_bottom = "0.15 ± 0.02"\n'
FILES["sandwich"] = f"{one}{of_top}{two}emittance = 0.1\n{three}"
FILES["carbon"] = FILES["sphere"].replace(
    "absorption_efficiency = 1.1\nemittance = 0.2\n", 'material = "a-C"\nextrapolation = "hold"\n'
)


@pytest.fixture
def read(flyer_file):
    """Read the file of a kind, with one text replaced by another, and more at its end."""

    def reading(kind, old="", new="", more=""):
        return lf.read_flyer_file(flyer_file(old, new, FILES[kind] + more))

    return reading


OWN = {  # numbers of the flyer and the uncertainties of its file, the model's own among them
    "balloon": (
        lf.BalloonConvection,
        {"radius": 2.9, "opening_radius": 0.3, "molar_mass": 4.0026e-3, "payload": 1.0},
        {"flyer.payload": 0.1, "force.convection_error": 1.0},
    ),
    "hollow": (
        lf.HollowPump,
        {"size": 0.1, "outlet_radius": 0.02, "channel_width": 8e-4, "channel_aspect": 10.0,
         "sheet_density": 3e3},
        {f"force.{name}_error": 1.0 for name in ("wall", "outlet", "force", "heat")},
    ),
    "plate": (
        lf.ChannelPump,
        {"radius": 4e-3, "height": 5e-5},
        {"force.force_error": 1.0, "force.heat_error": 1.0},
    ),
    "sandwich": (
        lf.Schafer2025,
        {"radius": 0.01, "gap": 125e-6, "hole_radius": 70e-6, "support_density": 3e3,
         "top.emittance_bottom": 0.15, "bottom.emittance_bottom": 0.1, "top.transmittance": 0.9},
        {"flyer.top.emittance_bottom": 0.02, "force.force_error": 1.0},
    ),
    "sphere": (
        lf.KineticSphere,
        {"radius": 5e-7, "mass_offset": 5e-8},
        {"flyer.diameter": 1e-7, "force.force_error": 1.0},
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", OWN)
def test_file_becomes_a_flyer_with_its_model(read, kind):
    model, numbers, uncertain = OWN[kind]
    file = read(kind)
    setup = file.build()
    assert type(setup.model) is model
    assert isinstance(setup.flyer, model.flyers)
    found = {name: operator.attrgetter(name)(setup.flyer) for name in numbers}
    assert found == pytest.approx(numbers, rel=1e-6, abs=0.0)
    assert file.uncertainties() == pytest.approx(uncertain)


@pytest.mark.parametrize(
    ("kind", "numbers", "moved"),
    [
        ("balloon", {"flyer.opening_diameter": 0.8}, {"opening_radius": 0.4}),
        ("hollow", {"flyer.outlet_diameter": 0.05, "flyer.inner.emittance_bottom": 0.3},
         {"outlet_radius": 0.025, "inner.emittance_bottom": 0.3}),
        ("plate", {"flyer.spacing": 1e-4, "flyer.top.tac_top": 0.5},
         {"spacing": 1e-4, "top.tac_top": 0.5}),
        ("sandwich", {"flyer.bottom.emittance": 0.3, "flyer.top.tac_bottom": 0.5},
         {"bottom.emittance_top": 0.3, "bottom.emittance_bottom": 0.3, "top.tac_bottom": 0.5}),
        ("sphere", {"flyer.absorption_efficiency": 0.9, "flyer.mass_offset": 1e-8},
         {"absorption_efficiency": 0.9, "mass_offset": 1e-8}),
    ],
)  # fmt: skip
def test_numbers_of_a_file_have_names_that_a_study_moves(read, kind, numbers, moved):
    design = read(kind).design()
    assert set(numbers) <= set(design.quantities)
    assert not any("correlation" in name for name in design.quantities)
    flyer = design.build(numbers).flyer
    assert {name: operator.attrgetter(name)(flyer) for name in moved} == moved


@pytest.mark.parametrize(
    ("model", "kind"),
    [('"hollow-pump"\nviscous_outlet = false', lf.HollowPump), ('"celenza2023"', lf.Celenza2023)],
)
def test_force_section(read, model, kind):
    built = read("hollow", more=f"\n[force]\nmodel = {model}\n").build().model
    assert isinstance(built, kind)
    if kind is lf.HollowPump:
        off = [name for name, on in built.corrections._asdict().items() if not on]
        assert off == ["viscous_outlet"]


def test_a_beam_from_below_is_for_spheres(read, film_section):
    chamber = '[environment]\nkind = "chamber"\ntemperature = "22 °C"\nincidence = "180 deg"\n'
    setup = read("sphere", more=chamber).build()
    assert setup.environment.state(100.0).radiation.zenith_angle == pytest.approx(np.pi)
    from_below = {"kind": "chamber", "temperature": "22 °C", "incidence": "180 deg"}
    with pytest.raises(ValueError, match="incidence above 90 deg is light from below"):
        lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film_section, environment=from_below)


def test_a_material_of_a_file(read):
    """Exactly for its size, within 0.2 % for any other that a study asks for."""
    file = read("carbon")
    design, carbon = file.design(), lf.film.material("a-C", extrapolation="hold")
    found = lf.film.sphere_absorption(carbon, 5e-7)
    flyer = design.setup.flyer
    assert flyer.absorption_efficiency == found.absorption_efficiency
    assert flyer.asymmetry == found.asymmetry
    assert flyer.emittance(300.0) == found.emittance(300.0)
    assert any("a-C" in text for text in design.warnings)
    sizes = np.array([0.31, 0.57, 0.93, 1.7, 2.9])  # diameters [µm]
    with lf.float64():
        many = design.build({"flyer.diameter": 1e-6 * sizes}).flyer
    exact = lf.film.sphere_absorption(carbon, 0.5e-6 * sizes)
    for name in ("absorption_efficiency", "asymmetry"):
        np.testing.assert_allclose(
            getattr(many, name), getattr(exact, name), rtol=2e-3, atol=2e-4, err_msg=name
        )
    np.testing.assert_allclose(many.emittance(300.0), exact.emittance(300.0), rtol=2e-3)
    given = read("carbon", more="emittance = 0.5\n")
    assert given.build().flyer.emittance == 0.5


def test_derivatives_over_the_size_of_a_sphere_of_a_material(read):
    design = read("carbon").design()

    @lf.entry_point
    def efficiency(diameter):
        return design.build({"flyer.diameter": diameter}).flyer.absorption_efficiency

    with lf.float64():
        slope = jax.grad(efficiency)(1e-6)
        change = (efficiency(1.01e-6) - efficiency(0.99e-6)) / 0.02e-6
        assert float(jax.jit(efficiency)(1e-6)) == pytest.approx(
            efficiency(1e-6), rel=2e-3, abs=0.0
        )
        assert np.isnan(jax.jit(efficiency)(20e-6))  # beyond the table
    assert slope == pytest.approx(change, rel=0.02, abs=0.0)


MISTAKES = [
    ("balloon", 'gas = "helium"', 'gas = "neon"', "flyer.gas"),
    ("balloon", 'gas = "helium"', 'film_strength = "3 kg"',
     'flyer.film_strength: "3 kg": unit'),
    ("balloon", 'diameter = "5.8 m"', "", "[flyer] needs diameter"),
    ("hollow", 'outlet_diameter = "4 cm"', 'outlet_diameter = "10 cm"',
     "[flyer]: the outlet must be smaller than the cone"),
    ("hollow", 'form = "cone"', 'form = "cube"', 'flyer.form = "cube"'),
    ("hollow", FILES["hollow"][FILES["hollow"].index("[flyer.inner]"):], "",
     "[flyer] needs inner"),
    ("hollow", "transmittance = 0.95", "transmittance = 0.99",
     "[flyer.outer]: transmittance = 0.99"),
    ("plate", 'spacing = "50 um"', 'spacing = "0 um"',
     'flyer.spacing = "0 um": must be positive'),
    ("plate", 'height = "50 um"', 'hight = "50 um"',
     'flyer.hight is not a key of [flyer]; did you mean "height"?'),
    ("plate", 'channel_length = "500 um"', 'channel_length = "9 mm"',
     "[flyer]: channel_length and spacing together must not exceed"),
    ("sandwich", "transmittance = 0.9", "transmitance = 0.9",
     'flyer.top.transmitance is not a key of [flyer.top]; did you mean "transmittance"?'),
    ("sandwich", "emittance = 0.1", "", "[flyer.bottom]: give emittance, or both"),
    ("sandwich", "tac_top = 0.8", 'tac_top = "0.8 m"', 'flyer.top.tac_top: "0.8 m": unit'),
    ("sandwich", "absorptance = 0.6", "absorptance = 1.6",
     "flyer.bottom.absorptance = 1.6: must be between 0 and 1"),
    ("sandwich", "open_fraction = 0.5", "open_fraction = 1.0",
     "flyer.open_fraction = 1.0: must be between 0 and 0.999"),
    ("sphere", "density", "mass", 'flyer.mass: "1.8 g/cm^3": unit'),
    ("sphere", "absorption_efficiency = 1.1", "absorption_efficiency = 110",
     "flyer.absorption_efficiency = 110: must be between 0 and 10"),
    ("sphere", "tac_top = 0.9", "tac = 0.9", "flyer.tac is not a key of [flyer]"),
    ("sphere", '"gravity"', '"nothing"', "[flyer]: mass_offset, by which gravity turns"),
    ("sphere", '"50 nm"', '"50 nm"\ntilt = "5 deg"',
     "[flyer]: tilt has no effect on a sphere"),
    ("sphere", '"50 nm"', '"50 nm"\n[film]\nareal_density = "1 g/m^2"\nabsorptance = 0.5\n'
     "emittance = 0.1\ntac_top = 0.8\ntac_bottom = 0.9",
     '[film]: [film] does not belong to shape = "sphere", which has none'),
    ("sphere", '"50 nm"', '"50 nm"\n[force]\nmodel = "kinetic"',
     '[force.model]: force.model = "kinetic" is not for shape = "sphere"; choose from'),
    ("carbon", '"a-C"', '"unobtainium"', 'flyer.material: material "unobtainium"'),
    ("carbon", 'material = "a-C"\n', "",
     "[flyer]: extrapolation has no effect without material"),
    ("carbon", 'material = "a-C"\nextrapolation = "hold"\n', "",
     "[flyer]: needs absorption_efficiency and emittance, or a"),
    ("carbon", 'material = "a-C"\nextrapolation = "hold"\n', "emittance = 0.2\n",
     "[flyer]: needs absorption_efficiency, or a material"),
    ("carbon", '"hold"', '"hold"\nspectrum = "moon"',
     'flyer.spectrum: spectrum "moon" is unknown'),
]  # fmt: skip


def line_of(text, name):
    """Line of a file in which a section begins, or a key of one stands."""
    section, _, key = name.rpartition(".")
    if f"[{name}]" in text:
        return text.count("\n", 0, text.index(f"[{name}]")) + 1
    return text.count("\n", 0, text.index(f"\n{key} = ", text.index(f"[{section}]"))) + 2


@pytest.mark.parametrize(("kind", "old", "new", "error"), MISTAKES)
def test_mistakes_in_a_file_are_one_line_each(flyer_file, kind, old, new, error):
    path = flyer_file(old, new, FILES[kind])
    number = line_of(path.read_text("utf-8"), re.search(r"[\w.]+", error)[0])
    with pytest.raises(lf.ConfigurationError) as caught:
        lf.read_flyer_file(path)
    lines = str(caught.value).splitlines()
    assert any(line.startswith(f"{path}:{number}: {error}") for line in lines), lines
    assert all(line.startswith(str(path)) for line in lines)
    assert len(lines) == 1 or kind in ("hollow", "plate", "sandwich")  # two faults, two lines


@pytest.mark.parametrize("kind", ["balloon", "plate", "sphere"])
def test_no_excess_is_above_the_bound(read, kind):
    """Even in vacuum, where radiation alone cools."""
    flyer = read(kind).build().flyer
    radiation = lf.environment.Radiation(0.0)
    state = lf.environment.EnvironmentState(5500.0, 220.0, 9.7, lf.gas.AIR, radiation)
    for excess in (1e-9, 0.1, 0.3, 2.0, 3.0, -0.5):
        with lf.float64():
            power = sum(flyer.heat_losses(state, (excess,) * (1 if kind == "balloon" else 2)))
            assert abs(excess) <= float(flyer.highest_excess(state, power)) * (1.0 + 1e-14)


@pytest.mark.parametrize(
    ("kind", "model", "says"),
    [
        ("balloon", lf.Lu2023(), "Lu2023 is not for Balloon"),
        ("plate", lf.Schafer2025(), "Schafer2025 is not for Plate"),
        ("sandwich", lf.Lu2023(), "Lu2023 is not for Sandwich; it is for Disk"),
        ("disk", lf.BalloonConvection(), "BalloonConvection is not for Disk"),
        ("disk", lf.ChannelPump(), "ChannelPump is not for Disk; it is for Plate"),
        ("disk", lf.Schafer2025(), "Schafer2025 is not for Disk"),
    ],
)
def test_models_are_for_the_flyers_they_name(read, disk, kind, model, says):
    flyer = disk if kind == "disk" else read(kind).build().flyer
    with pytest.raises(lf.ParameterError, match=says):
        lf.Setup(flyer, lf.Chamber(), model)
    with pytest.raises(lf.ParameterError, match=says):
        lf.lift(flyer, lf.Chamber().state(1.0), model)
