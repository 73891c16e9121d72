"""Fit the kinetic force to the solver's tables, and write the coefficients that the package reads.

Run as ``python studies/kinetic_fits/make.py``, after a study has made its table anew. It writes
``kinetic_fits.json`` into the package's data.
"""

import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

from kinetic_fits import disk, perforated, sandwich, surfaces
from kinetic_fits.common import table_of, write

from lightflyer.force.fitted import GASES


def fits() -> dict[str, dict[str, Any]]:
    """All fits, by name and by the gas of the table."""
    found: dict[str, dict[str, Any]] = {
        "perforated disk": {"monatomic": perforated.fit(perforated.perforated_disk_table())},
        "chamber": {"diatomic": surfaces.fit_chamber(vars(table_of("kinetic_chamber")))},
        "local balance": {
            "diatomic": surfaces.fit_local_balance(vars(table_of("kinetic_local_balance")))
        },
    }
    for gas in GASES:
        of_gas = {
            name: vars(table_of(f"kinetic_{name}", gas))
            for name in ("walls", "scattering", "collisions", "sandwich_scattering")
        }
        own: dict[str, Any] = {
            "disk": disk.fit(gas, table_of("kinetic", gas), table_of("kinetic_boundary", gas)),
            "walls": surfaces.fit_walls(of_gas["walls"]),
            "collisions": surfaces.fit_collisions(of_gas["collisions"], gas),
        }
        own["sandwich"] = sandwich.fit(
            own["disk"],
            table_of("kinetic_sandwich", gas),
            table_of("kinetic_sandwich_hot"),
            table_of("kinetic_sandwich_boundary"),
        )
        pushed = surfaces.force_at_walls_of_one_temperature(
            of_gas["scattering"], gas, own["disk"], own["walls"]
        )
        own["scattering"] = surfaces.fit_scattering(of_gas["scattering"], pushed)
        own["sharing"] = surfaces.fit_sharing(gas, own["scattering"])
        own["sandwich walls"] = sandwich.fit_walls(
            of_gas["sandwich_scattering"], gas, own["sandwich"]
        )
        own["sandwich sharing"] = sandwich.fit_sharing(gas, own["sandwich walls"])
        for name, fit in own.items():
            found.setdefault(name, {})[gas] = fit
    return found


if __name__ == "__main__":
    write(fits())
