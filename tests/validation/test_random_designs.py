"""Random designs over every pressure and size: all converge, and a balance closes."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation
from lightflyer.force import PRINTED, REPORTED
from lightflyer.gas import LU2023_AIR

DESIGNS = 500_000


def random_designs(rng, count):
    def spread(lowest, highest):
        return np.exp(rng.uniform(np.log(lowest), np.log(highest), count))

    emittance = spread(0.01, 1.0)
    tac_top, tac_bottom = rng.uniform(0.05, 1.0, (2, count))
    film = lf.FilmProperties(
        areal_density=spread(1e-5, 1.0),
        absorptance=rng.uniform(0.0, 1.0, count),
        emittance_top=emittance,
        emittance_bottom=emittance,
        tac_top=tac_top,
        tac_bottom=tac_bottom,
    )
    state = EnvironmentState(
        pressure=spread(1e-3, 1e5),
        temperature=rng.uniform(100.0, 320.0, count),
        gravity=9.8,
        gas=LU2023_AIR,
        radiation=Radiation(spread(1.0, 2e4)),
    )
    return lf.Disk(film, radius=spread(1e-4, 10.0)), state


@pytest.mark.parametrize("reading", [REPORTED, PRINTED], ids=["reported", "printed"])
def test_heat_balance(rng, reading):
    model = lf.Lu2023(reading=reading)
    disk, state = random_designs(rng, DESIGNS)
    result = lf.equilibrium(disk, state, model, throw=False)
    assert np.all(result.converged)
    assert np.abs(result.residual).max() < 1e-10
    assert np.all(np.isfinite(result.temperature))
    assert np.all(result.temperature >= state.temperature)
    # energy closes by the package's own account and by adding up here
    lost = result.gas_power + result.radiated_power
    np.testing.assert_allclose(lost, result.absorbed_power, rtol=1e-10)


def test_levitation(rng):
    model = lf.Lu2023()
    disk, state = random_designs(rng, DESIGNS)
    result = lf.levitate(disk, state, model, throw=False)
    assert np.all(result.converged)
    assert np.abs(result.residual).max() < 1e-10
    lifts = result.levitates
    assert 0.001 < lifts.mean() < 0.999
    assert np.all(np.isfinite(result.irradiance[lifts]))
    assert np.all(np.isfinite(result.temperature[lifts]))
    assert np.all(np.isinf(result.irradiance[~lifts]))
    assert np.all(np.isnan(result.temperature[~lifts]))
    # downward pushers never levitate
    downward = disk.film.tac_bottom <= disk.film.tac_top
    assert not np.any(lifts & downward)
