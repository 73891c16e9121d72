"""A polyatomic gas by the diatomic table: checked where two tables exist, and in both limits."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.force.kinetic.disk import scaled_heat_ratio
from lightflyer.force.kinetic.ratios import kinetic_fit

SCALED = lf.Kinetic(polyatomic="scaled")
CO2 = lf.gas.CARBON_DIOXIDE


@pytest.mark.parametrize(
    ("hot", "heat_error", "force_error"), [(1.01, 0.01, 0.017), (2.4, 0.03, 0.09)]
)
def test_from_the_monatomic_table_to_the_diatomic_one(hot, heat_error, force_error):
    """Conductivity over μR: 15/4 and 4.865; free-molecular heat over that of atoms: 1 and 3/2."""
    knudsen, tac = np.geomspace(0.03, 30.0, 12), np.array([[0.5], [1.0]])
    atoms, pairs = kinetic_fit("monatomic"), kinetic_fit("diatomic")
    of_atoms = atoms.heat_ratio(knudsen, hot, tac)
    found = scaled_heat_ratio(of_atoms, 1.5 * 3.75 / 4.865)
    np.testing.assert_allclose(found, pairs.heat_ratio(knudsen, hot, tac), rtol=heat_error)
    force = atoms.force_ratio(knudsen, hot, tac) * found / of_atoms
    np.testing.assert_allclose(force, pairs.force_ratio(knudsen, hot, tac), rtol=force_error)


def test_limits_in_carbon_dioxide(disk):
    chamber = lf.Chamber(temperature=200.0, gas=CO2)
    excess, area = 0.02, np.pi * 0.01**2
    thin, dense = (chamber.state(pressure) for pressure in (1e-4, 500.0))
    (free,) = lf.FreeMolecular().heat_loss(disk, thin, (excess,))
    assert SCALED.heat_loss(disk, thin, (excess,))[0] == pytest.approx(float(free), rel=1e-3)
    maxwell = 0.5 * 1e-4 * area * 0.1 * (np.sqrt(1.0 + excess) - 1.0)
    assert SCALED.force(disk, thin, (excess,)) == pytest.approx(maxwell, rel=1e-3)
    # conduction from an isothermal disk into endless gas, 8 r κ ΔT
    conduction = 8.0 * 0.01 * CO2.conductivity(202.0) * excess * 200.0
    assert SCALED.heat_loss(disk, dense, (excess,))[0] == pytest.approx(conduction, rel=0.02)


def test_refused_unless_asked_for_and_then_said(disk):
    mars = lf.Mars().state(60e3)
    with pytest.raises(lf.ParameterError, match="Kinetic is not for co2"):
        lf.lift(disk, mars, lf.Kinetic())
    assert any("taken for a diatomic gas" in text for text in SCALED.diagnostics(disk, mars, 200.0))
    assert not lf.Kinetic().diagnostics(disk, lf.Earth().state(75e3), 260.0)
    uncertain = lf.Kinetic(0.0, 1.0, polyatomic="scaled")
    (off,), (heat,) = (model.heat_loss(disk, mars, (0.5,)) for model in (uncertain, SCALED))
    assert 0.015 < off / heat - 1.0 < 0.05
    with pytest.raises(lf.ParameterError, match='polyatomic = "taken" is unknown; choose from'):
        lf.Kinetic(polyatomic="taken")
