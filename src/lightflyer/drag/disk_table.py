r"""What the kinetic equation says of the drag of a slow disk between thin and dense gas.

The table has the drag coefficient :math:`G` over rarefaction and TAC. What is interpolated is the
share :math:`b` of the resistance of dense gas that is left,

.. math:: \frac1G = \frac1{G_\mathrm{fm}} + b\,\frac{\pi\delta}{16},

as :math:`(1-b)(\delta+1.5)`, which hardly varies and is constant in both limits. So :math:`b` goes
to one in dense gas, and its term to zero in thin gas, beyond the table as well.
"""

import math
from functools import lru_cache

import numpy as np

from lightflyer.array.namespace import Array, Numeric, by_numpy, xp
from lightflyer.core.validity import Validity
from lightflyer.drag import free_molecular
from lightflyer.files.table import shipped_table
from lightflyer.numerics.curves import Curves

_OFFSET = 1.5  # any of the size of the rarefaction at which both resistances are alike

TAC_RANGE = Validity(
    "the mean TAC of the faces",
    0.2,
    1.0,
    "its effect on the drag between thin and dense gas is held at the end",
)
"""Of the table."""


def dense_share(rarefaction: Numeric, tac: Numeric, molecules: str) -> Array:
    """Share of the resistance of dense gas that a slow disk meets, broadside [1]."""
    kind = "monatomic" if molecules == "monatomic" else "diatomic"
    nodes, curves = _curves(kind)
    tac = xp.clip(tac, nodes[0], nodes[-1])
    reduced: Array = xp.zeros(())
    for node, value in zip(nodes, curves(xp.log(rarefaction)), strict=True):
        others = [other for other in nodes if other != node]
        weight = math.prod((tac - other) / (node - other) for other in others)
        reduced = reduced + weight * value
    return 1.0 - reduced / (rarefaction + _OFFSET)


@lru_cache
def _curves(kind: str) -> tuple[tuple[float, ...], Curves]:
    """TACs of the table, and the reduced share over ln δ for each."""
    table = shipped_table("drag_disk.csv")
    of_kind = np.array(table.texts["gas"]) == kind
    columns = {name: values[of_kind] for name, values in table.numbers.items()}
    nodes = tuple(float(tac) for tac in np.unique(columns["tac"]))
    delta = np.unique(columns["rarefaction"])
    reduced = []
    for tac in nodes:
        with by_numpy():  # also while another function is traced
            free = float(free_molecular.broadside_disk(0.0, tac, 1.0))
        drag = columns["drag"][columns["tac"] == tac]
        share = (1.0 / drag - 1.0 / free) * 16.0 / (math.pi * delta)
        reduced.append((1.0 - share) * (delta + _OFFSET))
    return nodes, Curves.through(np.log(delta), np.stack(reduced, axis=1))
