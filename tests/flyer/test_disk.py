from dataclasses import replace

import numpy as np
import pytest

import lightflyer as lf


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("areal_density", 0.0),
        ("absorptance", 1.1),
        ("emittance_top", 1.4),
        ("emittance_bottom", 0.0),
        ("tac_top", 1.31),
        ("tac_bottom", 0.0),
        ("tac_bottom", np.nan),
        ("absorptance_bottom", -0.1),
        ("emittance_top", np.array([0.1, 2.0])),
    ],
)
@pytest.mark.filterwarnings("ignore:.*exceeds 1")  # said before the bound is found exceeded
def test_impossible_properties_raise(film, name, value):
    with pytest.raises(lf.ParameterError, match=name):
        replace(film, **{name: value})


def test_tac_above_one_warns(film):
    with pytest.warns(lf.ParameterWarning, match=r"tac_bottom = 1.08 exceeds 1"):
        replace(film, tac_bottom=1.08)


def test_derived_properties(film):
    assert film.tac_mean == pytest.approx(0.85)
    assert film.tac_difference == pytest.approx(0.1)
    assert replace(film, emittance_bottom=0.1).emittance_sum == pytest.approx(0.18)
    assert film.absorptance_below == 0.75
    assert replace(film, absorptance_bottom=0.3).absorptance_below == 0.3


def test_disk_geometry_and_mass(film):
    disk = lf.Disk(film, radius=0.02, payload=1e-7)
    assert disk.area == pytest.approx(np.pi * 4e-4)
    assert disk.mass == pytest.approx(np.pi * 4e-7 + 1e-7)
    assert lf.statics.weight(disk, lf.Earth(gravity=10.0).state(0.0)) == pytest.approx(
        10 * disk.mass, abs=0.0
    )
