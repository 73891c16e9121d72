"""What a prediction says beside its numbers: what it assumes, and where it is not to be trusted."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.config.designs import as_design
from lightflyer.design.diagnostics import diagnose_at, diagnose_design, diagnose_designs
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.uncertainty.inputs import uncertain_inputs

FILM = {"areal_density": "1.0 g/m^2", "absorptance": 0.75, "emittance": 0.08}
TACS = {"tac_top": 0.8, "tac_bottom": 0.9}
PAPERS_FORCE = {"force": {"model": "lu2023", "force_error": 0}}


def flyer_file(film=None, diameter="2 cm", **sections):
    film = FILM | TACS if film is None else film
    return lf.FlyerFile(flyer={"diameter": diameter}, film=film, **PAPERS_FORCE | sections)


def warnings_of(*args, **kwargs):
    return " / ".join(lf.predict(flyer_file(*args, **kwargs)).warnings)


def test_every_prediction_names_the_light_it_assumes():
    prediction = lf.predict(flyer_file(environment={"albedo": 0.4}))
    told = prediction.summary()["assumptions"]
    assert any("0.4 of it (albedo)" in text for text in told)
    assert any(text.startswith("infrared: from above 0 W/m², from below") for text in told)
    assert prediction.dataset.attrs["assumptions"] == "; ".join(told)
    paper = lf.predict(flyer_file(environment={"atmosphere": "lu2023"})).summary()["assumptions"]
    assert "reflected light: none" in paper


@pytest.mark.parametrize(
    ("film", "says"),
    [
        ({"tac_top": 0.9, "tac_bottom": 0.8}, "the gas pushes the flyer down"),
        ({"tac_top": 0.8, "tac_bottom": 0.8}, "does not push the flyer"),
        (TACS | {"highest_temperature": "400 K"}, r"its film withstands 400 K"),
    ],
)
def test_what_a_designer_must_know(film, says):
    # in the paper's surroundings, where nothing is colder than the gas
    environment = {"atmosphere": "lu2023"}
    assert says in warnings_of(FILM | film, environment=environment)
    assert says not in warnings_of(environment=environment)


def test_numbers_most_likely_of_a_wrong_unit_are_said():
    force = {"model": "lu2023", "c_fm": 162.0, "force_error": -5.0}
    told = warnings_of(FILM | TACS | {"emittance": 8e-4}, force=force)
    assert "force.c_fm = 162 is unlikely" in told
    assert "force.force_error = -5 is unlikely" in told
    assert "flyer.film.emittance_bottom = 0.0008 is unlikely" in told
    assert "unlikely" not in warnings_of()


@pytest.mark.parametrize(
    ("sections", "says"),
    [
        ({"film": FILM | TACS | {"areal_density": "1 g/cm^2"}},
         "flyer.film.areal_density = 10 kg/m^2 is unlikely"),
        ({"environment": {"kind": "chamber", "temperature": "20 K"}},
         "environment.temperature = 20 K is unlikely"),
        ({"environment": {"kind": "chamber", "temperature": "293 °C"}},
         "environment.temperature = 566.1 K is unlikely"),
        ({"environment": {"kind": "earth", "wind": {"kind": "uniform", "east": "-6 km/s"}}},
         "environment.wind.east = -6000 m/s is unlikely"),
    ],
)  # fmt: skip
def test_surroundings_and_films_of_a_wrong_unit(sections, says):
    assert says in warnings_of(**sections)


def test_a_film_upside_down_is_pushed_down_under_a_cold_sky_too():
    """High up it is colder than the gas, which pushes it up a little."""
    film = FILM | {"tac_top": 0.9, "tac_bottom": 0.8}
    assert "the gas pushes the flyer down" in warnings_of(film)


def test_night_is_named_in_place_of_light_that_does_not_come():
    """The sun of 85° N on 21 December at noon UTC, 0° E, is 18.4° below the horizontal."""
    night = {"sun": "ephemeris", "date": "2026-12-21T12:00:00Z", "latitude": "85 deg",
             "longitude": "0 deg"}  # fmt: skip
    found = lf.predict(flyer_file(environment=night))
    assert "the sun is 18° below the horizontal, hidden by the planet" in " ".join(found.warnings)
    assert str(found).splitlines()[0].endswith("in the dark")
    day = lf.predict(flyer_file(environment=night | {"date": "2026-06-21T12:00:00Z"}))
    assert "below the horizontal" not in " ".join(day.warnings)
    assert "W/m²" in str(day).splitlines()[0]


def test_a_flyer_upside_down_is_not_told_to_change_its_tacs():
    told = " / ".join(lf.predict(lf.FlyerFile(
        flyer={"diameter": "2 cm", "tilt": "100 deg"}, film=FILM | TACS, **PAPERS_FORCE
    )).warnings)  # fmt: skip
    assert "tilted by 100° it is upside down" in told
    assert "tac_bottom must exceed" not in told


def test_the_fitted_coefficients_hold_where_they_were_fitted():
    kwargs = {"environment": {"atmosphere": "lu2023"}}
    assert "the diameter [m] is 0.06" in warnings_of(diameter="6 cm", **kwargs)
    assert "the diameter" not in warnings_of(diameter="3 cm", **kwargs)
    # others than the paper's hold where those who fitted them say
    own = {"model": "lu2023", "c_fm": 0.5, "c_cont": 2.0}
    assert "the diameter" not in warnings_of(diameter="6 cm", force=own, **kwargs)


def test_a_flyer_colder_than_the_gas_does_not_melt(film):
    state = lf.Earth().state(80e3)
    (cold,) = lf.Lu2023().diagnostics(lf.Disk(film, 0.01), state, 0.9 * state.temperature)
    assert "below 1: c_fm and c_cont of lu2023 were fitted to films warmer than the gas" in cold
    (hot,) = lf.Lu2023().diagnostics(lf.Disk(film, 0.01), state, 1.8004 * state.temperature)
    assert hot.startswith("T_h/T_c is 1.8004 at")  # and not "1.8, above 1.8"


def test_the_kinetic_table_says_where_it_ends():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.04, tac_bottom=0.06)
    disk, model = lf.Disk(film, 0.01), lf.Kinetic()
    state = lf.Earth().state(np.array([40e3, 80e3]))
    texts = model.diagnostics(disk, state, np.array([300.0, 700.0]))
    dense, hot_dense, hot, tac, *_ = texts
    assert dense.startswith("the Knudsen number is 0.00")
    assert "below 0.006: the kinetic table ends there" in dense
    assert "below 0.013: the kinetic table of large temperature differences" in hot_dense
    assert hot.startswith("T_h/T_c is 3.5")
    assert "above 3.5" in hot
    assert tac.startswith("the mean TAC is 0.05")
    # at the gas's temperature the linear table alone is used
    (dense,) = lf.Kinetic(wall="maxwell").diagnostics(
        lf.Disk(lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.2, 0.9), 0.01),
        lf.Earth().state(40e3),
        lf.Earth().state(40e3).temperature,
    )
    assert "below 0.006" in dense
    inside = lf.Disk(lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9), 0.01)
    assert model.diagnostics(inside, lf.Earth().state(80e3), 400.0) == ()


def index_csv(path, longest_um):
    wavelength = np.geomspace(0.1, longest_um, 200)
    rows = [f"{w:.6f},1.6,{0.02 + 0.01 * np.log(w) ** 2:.6f}" for w in wavelength]
    path.write_text("wavelength [um],n,k\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return str(path)


def layered(path, **given):
    layer = {"material": path, "thickness": "500 nm", "density": "1.4 g/cm^3"}
    return {"layers": [layer], **TACS, **given}


def test_missing_optical_data_are_in_the_band(tmp_path):
    """Truth: the same material with data for all wavelengths, and the film at its bounds."""
    short, whole = (index_csv(tmp_path / f"{end}.csv", end) for end in (3, 2000))
    film = layered(short, absorptance=0.75, areal_density="1.0 g/m^2")
    file = flyer_file(film, environment={"atmosphere": "lu2023"})
    prediction = lf.predict(file, at=[72e3])
    assert any(
        text.startswith("emittance_top is computed from data for 0.")
        for text in prediction.warnings
    )
    assert prediction.summary()["warnings"] == list(prediction.warnings)
    found = lf.propagate(file, prediction=prediction, samples=300)
    assert found.summary()["between_bounds"] == ["film.emittance_without_data"]
    band = found.summary()["results"]["at[0].temperature_k"]["monte_carlo"]
    full = flyer_file(film | {"layers": [film["layers"][0] | {"material": whole}]},
                      environment={"atmosphere": "lu2023"})  # fmt: skip
    true = float(lf.predict(full, at=[72e3]).at["temperature"][0])
    assert band["low"] < true < band["high"]
    bounds = LayeredFilmSection.model_validate(film).bounds()["emittance_without_data"]
    state, model = lf.lu2023_earth().state(72e3), lf.Lu2023()
    hot, cold = (float(lf.equilibrium(lf.Disk(end, 0.01), state, model).temperature)
                 for end in bounds)  # fmt: skip
    assert cold < band["low"] < cold + 0.1 * (hot - cold)
    assert hot - 0.1 * (hot - cold) < band["high"] < hot


def test_tacs_of_materials_have_their_errors():
    """As if they had been written into the file with their ±."""
    layers = {"layers": [{"material": "Al2O3", "thickness": "50 nm"},
                         {"material": "Ge", "thickness": "20 nm"}]}  # fmt: skip
    given = FILM | {"emittance": 0.08}
    environment = {"atmosphere": "lu2023"}
    implied = flyer_file(layers | given, environment=environment)
    told = flyer_file(
        layers | given | {"tac_top": "0.79 ± 0.03", "tac_bottom": "0.90 ± 0.03"},
        environment=environment,
    )
    assert implied.uncertainties() == told.uncertainties()
    one, other = (lf.propagate(file, samples=0).first_order for file in (implied, told))
    assert one == other
    assert one["best.payload_mg"] > 0.05


def test_one_material_has_one_error():
    """Both faces of bare germanium have the same TAC, whatever it is."""
    film = FILM | {"layers": [{"material": "Ge", "thickness": "200 nm"}]}
    file = flyer_file(film, environment={"atmosphere": "lu2023"})
    pair = ("film.tac_top", "film.tac_bottom")
    assert file.design().correlations == {pair: 1.0}
    found = lf.propagate(file, samples=0, prediction=lf.predict(file, at=[72e3]))
    assert found.first_order["at[0].lift_n"] == pytest.approx(0.0, abs=1e-15)


def test_thicknesses_go_through_to_flight():
    """Against the flyer whose film is computed from the other thickness."""
    layers = [{"material": "Ge", "thickness": "20 ± 1 nm"},
              {"material": "PET", "thickness": "500 nm"}]  # fmt: skip
    film = {"layers": layers, "extrapolation": "hold", **TACS}
    inputs = uncertain_inputs(flyer_file(film, environment={"atmosphere": "lu2023"}).design())
    row = inputs.names.index("film.layers.0.thickness")
    section = LayeredFilmSection.model_validate(film)
    state, model = lf.lu2023_earth().state(72e3), lf.Lu2023()

    def exact(nanometres):
        film = section.with_values({"layers.0.thickness": nanometres * 1e-9}).build()
        return float(lf.payload(lf.Disk(film, 0.01), state, model))

    def propagated(nanometres):
        values = inputs.values.copy()
        values[row] = nanometres * 1e-9
        return float(lf.payload(inputs.build(values).flyer, state, model))

    known = {nanometres: exact(nanometres) for nanometres in (19.0, 21.0)}
    assert abs(known[21.0] - known[19.0]) > 2e-3 * abs(known[21.0])
    for nanometres, payload in known.items():
        assert propagated(nanometres) == pytest.approx(payload, rel=1e-9)


@pytest.mark.parametrize(
    ("model", "radius"),
    [
        (lf.Kinetic(), 0.01),
        (lf.Lu2023(), 0.0049),
        (lf.Lu2023(), 0.01),
        (lf.FreeMolecular(), 0.01),
    ],
)
def test_covered_is_where_nothing_is_said_to_be_outside(model, radius, film):
    setup = lf.Setup(lf.Disk(film, radius), lf.Earth(), model)
    for altitude in (30e3, 62e3, 78e3, 100e3, 119e3):
        found = lf.predict(setup, at=[altitude])
        said = diagnose_at(setup, [altitude], found.at["temperature"])
        outside = [line for line in said if ", below " in line or ", above " in line]
        assert found.at["covered"].tolist() == [0.0 if outside else 1.0], (altitude, said)


@pytest.mark.parametrize("key", ["areal_density", "altitude", "diameter"])
def test_designs_are_diagnosed_together_as_one_by_one(key):
    """Such as fly nowhere, get too hot, are given a place, or differ in nothing."""
    film = {"areal_density": "1 g/m^2", "absorptance": 0.75, "emittance": 0.08, "tac_top": 0.8,
            "tac_bottom": 0.9, "highest_temperature": "390 K"}  # fmt: skip
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    several = {
        "areal_density": [{"film.areal_density": value} for value in (2e-4, 1e-3, 9e-3)],
        "altitude": [{"altitude": value, "film.emittance": 0.08} for value in (60e3, 75e3, 95e3)],
        "diameter": [{"flyer.diameter": 0.02}] * 2,
    }[key]
    design = as_design(flyer)
    together = diagnose_designs(design, several)
    assert together == [diagnose_design(design, values) for values in several]
    assert len({*together}) == len({*map(str, several)})
