"""Layered films as the membranes of a sandwich, from the flyer file to the heat balance."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import ComputedFilm
from lightflyer.uncertainty.inputs import uncertain_inputs

MEASURED = {
    "areal_density": "0.3 g/m^2", "absorptance": 0.02, "transmittance": 0.9, "emittance": 0.1,
    "tac_top": "0.80 ± 0.05", "tac_bottom": "0.80 ± 0.05", "tac_correlation": 0.5,
}  # fmt: skip
CHROMIUM = {"material": "Cr", "thickness": "10 ± 1 nm"}
ALUMINA = {"material": "Al2O3", "thickness": "100 nm"}
LAYERED = {"layers": [ALUMINA, CHROMIUM], "tac_bottom": 0.7}
FLYER = {
    "shape": "sandwich", "diameter": "2 cm", "gap": "125 um", "open_fraction": 0.5,
    "hole_radius": "50 um", "support_fraction": 1e-4, "support_conductivity": "1.8 W/(m*K)",
}  # fmt: skip


def sandwich_file(top=MEASURED, bottom=LAYERED, **sections):
    return lf.FlyerFile(flyer=FLYER | {"top": top, "bottom": bottom}, **sections)


@pytest.fixture(scope="module")
def design():
    return sandwich_file().design()


def test_layers_become_the_properties_of_the_membrane(design):
    section = design.file.flyer.bottom
    expected = ComputedFilm.of(section.film(), section.measured_values()).properties
    flyer = design.setup.flyer
    for name in ("areal_density", "absorptance", "absorptance_bottom", "transmittance", "tac_top"):
        assert getattr(flyer.bottom, name) == getattr(expected, name)
    assert flyer.bottom.tac_bottom == 0.7
    assert flyer.top.transmittance == 0.9
    # as much passes as by the numbers of a film with the same properties
    numbers = {
        name: getattr(expected, name)
        for name in ("areal_density", "absorptance", "absorptance_bottom", "emittance_top",
                     "emittance_bottom", "tac_top", "transmittance", "transmittance_bottom",
                     "infrared_transmittance")
    }  # fmt: skip
    same = lf.Sandwich(
        flyer.top, lf.FilmProperties(tac_bottom=0.7, **numbers), 0.01, 125e-6, 0.5, 50e-6, 1e-4, 1.8
    )
    state = design.setup.environment.state(75e3)
    model = design.setup.model
    found, expected = (lf.equilibrium(one, state, model) for one in (flyer, same))
    np.testing.assert_allclose(found.temperatures, expected.temperatures, rtol=1e-12)
    assert abs(found.residual) < 1e-10
    low, high = found.temperatures
    assert high > low > float(state.temperature)


def test_light_reflected_from_below_passes_by_the_bottom_transmittance():
    """Only where it is diffuse: by hand for opaque top and bottom that only passes."""
    top = lf.FilmProperties(3e-4, 1.0, 0.1, 0.1, 0.8, 0.8)
    bottom = lf.FilmProperties(
        3e-4, 0.0, 0.1, 0.1, 0.8, 0.8, transmittance=0.2, transmittance_bottom=0.6
    )
    sandwich = lf.Sandwich(top, bottom, 0.01, 1e-4, 0.0, 1e-5, 1e-4, 1.8)
    radiation = lf.environment.Radiation(100.0, albedo=0.1)
    state = lf.environment.EnvironmentState(3.0, 220.0, 9.7, lf.gas.AIR, radiation)
    with lf.float64():
        top_area, bottom_area = sandwich.beam_areas(state)
    assert float(top_area) == pytest.approx((1.0 + 0.6 * 0.1) * sandwich.area, rel=1e-12)
    assert float(bottom_area) == pytest.approx(0.0, abs=1e-15)


def test_all_films_are_warned_of_left_open_and_prepared(design):
    assert all(text.startswith("flyer.bottom: ") for text in design.warnings)
    assert any("infrared_transmittance is computed from data" in text for text in design.warnings)
    names = {f"flyer.bottom.{what}_without_data" for what in (
        "absorptance", "transmittance", "emittance", "infrared_transmittance")}  # fmt: skip
    assert set(design.data_bounds()) == names
    costly = ["flyer.bottom.layers.1.thickness", "environment.incidence"]
    assert design.needs_recompute(["flyer.gap", "flyer.top.emittance", *costly]) == costly
    assert design.why_not_varied("flyer.top.tac_correlation").startswith("is about uncertainties")
    assert "flyer.top.tac_correlation" not in design.quantities
    assert design.number("flyer.bottom.tac_top") == pytest.approx(0.79)  # alumina's
    thinner = design.precompute({"flyer.bottom.layers.1.thickness": 5e-9})
    moved = design.build({"flyer.bottom.layers.1.thickness": 5e-9}, thinner).flyer.bottom
    assert moved.transmittance > design.setup.flyer.bottom.transmittance
    own = design.build({"flyer.bottom.tac_bottom": 0.6, "flyer.top.absorptance": 0.03}).flyer
    assert (own.bottom.tac_bottom, own.top.absorptance) == (0.6, 0.03)
    assert own.bottom.absorptance == design.setup.flyer.bottom.absorptance


def test_uncertain_numbers_of_all_films_and_their_correlations():
    both = sandwich_file({"layers": [ALUMINA]}, LAYERED).design()
    inputs = uncertain_inputs(both)
    assert "flyer.bottom.layers.1.thickness" in inputs.names
    assert "flyer.top.emittance_without_data" in inputs.names
    # alumina's TAC is one number, wherever alumina is
    tacs = ("flyer.top.tac_top", "flyer.top.tac_bottom", "flyer.bottom.tac_top")
    assert inputs.shared == {
        (tacs[0], tacs[1]): 1.0, (tacs[0], tacs[2]): 1.0, (tacs[1], tacs[2]): 1.0
    }  # fmt: skip
    alone = sandwich_file().design()
    assert alone.correlations == {("flyer.top.tac_top", "flyer.top.tac_bottom"): 0.5}


def test_a_disk_has_no_concern_with_what_passes():
    film = {"layers": [{"material": "Ge", "thickness": "20 nm"}], "absorptance": 0.5}
    file = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film)
    design = file.design()
    assert set(design.data_bounds()) == {"film.emittance_without_data"}
    assert not any("transmittance" in text for text in design.warnings)
    assert design.needs_recompute(["environment.incidence"]) == []
    assert design.setup.flyer.film.transmittance == 0.0


@pytest.mark.parametrize(
    ("bottom", "says"),
    [
        ({"layers": [CHROMIUM], "tac_top": 0.8}, r"\[flyer.bottom\] needs tac_bottom: no measured"),
        ({"layers": [{"material": "a-C", "thickness": "9 nm"}], "tac_top": 0.8, "tac_bottom": 0.8},
         r"\[flyer.bottom\] needs areal_density, or the layer of a-C its density"),
        ({"layers": []}, "at least 1"),
        ({"layers": [CHROMIUM | {"thickness": "-1 nm"}]}, "must be positive"),
        ({"layers": [CHROMIUM | {"thickness": "5 km"}]}, "at most 0.01 m: .*films are thinner"),
        (MEASURED | {"transmittance_bottom": 0.99}, "transmittance_bottom = 0.99 and absorptance"),
    ],
)  # fmt: skip
def test_bad_films_are_named(bottom, says):
    with pytest.raises(ValueError, match=says):
        sandwich_file(bottom=bottom)


def test_bad_layers_have_their_line(tmp_path):
    path = tmp_path / "flyer.toml"
    path.write_text(
        '[flyer]\nshape = "sandwich"\ndiameter = "2 cm"\ngap = "0.1 mm"\nopen_fraction = 0.5\n'
        'hole_radius = "50 um"\nsupport_fraction = 1e-4\nsupport_conductivity = "1.8 W/(m*K)"\n'
        '[flyer.top]\nlayers = [{material = "Al2O3", thickness = "100 nm"}]\n'
        '[flyer.bottom]\nlayers = [{material = "Chromum", thickness = "10 nm"}]\n'
    )
    with pytest.raises(lf.ConfigurationError, match=r"flyer.toml:12: .*did you mean Cr") as found:
        lf.read_flyer_file(path)
    told = str(found.value).splitlines()
    assert not any("needs at least" in line for line in told)  # that its one layer is wrong is told
