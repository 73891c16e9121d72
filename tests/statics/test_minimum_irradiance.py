"""The search for the least light, on forces whose answer is known."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from lightflyer.array.namespace import by_numpy
from lightflyer.statics.minimum_irradiance import find_least_light

BRIGHTEST = 1e6
LOAD = np.array([1.0, 1.0, 1.0])

FORCES = {
    "linear": lambda light: 3e-4 * light,
    "from a lift in darkness": lambda light: 0.4 + 2e-4 * light,
    "saturating": lambda light: 2e-3 * light / (1.0 + 1e-3 * light),
    "quadratic but for a little": lambda light: 1e-6 * light + 1e-8 * light**2,
    "a bump far below where the first slope leads": lambda light: (
        1e-5 * light + 30.0 * (light / 60.0) ** 2 * np.exp(-light / 60.0)
    ),
}


class Lamp:
    """A flyer as warm as its light is bright, on which a force of that light acts."""

    flyer = SimpleNamespace(nodes=("film",))

    def __init__(self, force):
        self.force, self.looks = force, []

    def powers(self, light):
        if np.ndim(light) == 1 and (not self.looks or np.any(light != self.looks[-1])):
            self.looks.append(np.array(light))
        return (light,)

    def balance(self, unknowns):
        return unknowns, (0.0,), ()

    def upward_force(self, unknowns):
        return self.force(unknowns[0])


def search(force):
    """The least light, and the lights that were looked at, (looks, 3)."""
    lamp = Lamp(force)
    with by_numpy():
        found = find_least_light(lamp, np.full(3, BRIGHTEST), LOAD, (np.zeros(3),))
    return found, lamp.looks


@pytest.mark.parametrize("force", FORCES.values(), ids=FORCES)
def test_the_least_light_is_the_first_that_carries_the_load(force):
    grid = np.geomspace(1e-3, BRIGHTEST, 20_001)
    first = grid[np.argmax(force(grid) >= 1.0)]
    truth = brentq(lambda light: force(light) - 1.0, 1e-9, first, xtol=1e-12)
    found, _ = search(force)
    assert np.all(found.carries)
    np.testing.assert_allclose(found.light, truth, rtol=1e-9)


def test_what_darkness_tells_saves_looks():
    """In equal ratios from 1e-5 of the brightest to it: a ratio below 240 is the second light."""
    _, looks = search(lambda light: light / 240.0)
    np.testing.assert_allclose(looks[1], BRIGHTEST * 1e-5 ** (7.0 / 8.0), rtol=1e-9)
    assert len(looks) == 5


def test_a_force_that_is_never_enough():
    found, looks = search(lambda light: 1e-9 * light)
    assert not np.any(found.carries)
    assert max(map(np.max, looks)) == pytest.approx(BRIGHTEST, rel=1e-9)
