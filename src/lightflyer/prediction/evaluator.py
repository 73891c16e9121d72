"""Outputs of one flyer at any number of coordinates."""

from typing import TypeAlias

import numpy as np

from lightflyer.design.outputs import predicted_names, tabulate_places
from lightflyer.design.setup import Setup
from lightflyer.flight.balance import require_converged
from lightflyer.numerics.rootfind import Ending

POINTS = 301
"""Coordinates of a prediction's table."""

Table: TypeAlias = dict[str, np.ndarray]
"""Outputs by name, each an array over the same coordinates, in SI units."""


class Evaluator:
    """Evaluates a setup's outputs at any number of coordinates."""

    def __init__(self, setup: Setup):
        self.setup = setup
        self.irradiance = float(setup.environment.radiation.irradiance)

    def __call__(self, coordinates: np.ndarray, irradiance: np.ndarray | None = None) -> Table:
        """Outputs at coordinates, shape (n,); ``coordinates`` (n,); ``irradiance`` (n,)."""
        light = np.full(coordinates.shape, self.irradiance) if irradiance is None else irradiance
        table = tabulate_places(self.setup, coordinates, light)
        failed = table.pop("converged") < 0.5
        ending = np.where(failed, int(Ending.TOLERANCE_MISSED), int(Ending.CONVERGED))
        require_converged("prediction", ending, table.pop("residual"))
        # in the order in which they are listed: JAX sorts them by name
        return {name: table[name] for name in predicted_names(self.setup)}
