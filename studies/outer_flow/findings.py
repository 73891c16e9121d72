"""What the tables of the runs say."""

import csv
from pathlib import Path

import claim
import numpy as np
from scipy.optimize import least_squares

import lightflyer as lf
from lightflyer.files.table import shipped_table
from lightflyer.force.laws.outer_flow import CREEPING, through_flow_coefficient

HERE = Path(__file__).parent
SHOWN = 90  # points outward of which the stream function is kept
ORDER = 1.5  # of the error over the cells' size, in creeping flow
REGULAR = 50.0  # Reynolds number up to which it is; a jet is not resolved as regularly
MOST_OPEN = 0.75  # denser gas is needed for more
SLOW = 0.5  # Reynolds number up to which the square law is looked at
PERCENT = 100.0


def read(name):
    """Columns of one of the study's tables."""
    with (HERE / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def coefficients():
    """Reynolds number, force over μ a u in the limit of small cells, and how far that is."""
    table = read("pumped")
    found = []
    for reynolds in np.unique(table["reynolds"]):
        wide = table["domain"] == table["domain"][table["reynolds"] == reynolds].max()
        here = (table["reynolds"] == reynolds) & wide
        order = np.argsort(table["cells_around"][here])[-2:]
        cells = table["cells_around"][here][order]
        force = table["force_over_mu_a_u"][here][order]
        step = force[1] - force[0]
        if reynolds <= REGULAR:
            step /= (cells[1] / cells[0]) ** ORDER - 1.0
        found.append((reynolds, force[1] + step * (reynolds <= REGULAR), abs(step)))
    return np.array(found).T


def fitted(reynolds, values):
    """Constants of the formula that fit the coefficients best."""

    def deviation(constants):
        jet, layer, onset = constants
        growth = jet + layer / np.sqrt(onset + reynolds)
        return np.log(np.hypot(CREEPING, growth * reynolds) / values)

    return least_squares(deviation, [2.0, 6.0, 5.0]).x


def flow():
    """Numbers of the flow around a disk that pumps."""
    reynolds, value, step = coefficients()
    with lf.float64():
        formula = np.asarray(through_flow_coefficient(reynolds))
    slow = reynolds <= SLOW
    table = read("pumped")
    domains = {}
    for number in np.unique(table["reynolds"]):
        here = (table["reynolds"] == number) & (table["cells_around"] == 100.0)
        if here.sum() > 1:
            near, far = table["force_over_mu_a_u"][here][np.argsort(table["domain"][here])][[0, -1]]
            domains[f"{number:g}"] = round(PERCENT * (near / far - 1.0), 2)
    return {
        "force_over_mu_a_u": {
            f"{number:g}": {"value": round(one, 3), "cells": round(error, 3)}
            for number, one, error in zip(reynolds, value, step, strict=True)
        },
        "creeping": round(float(value[0]), 3),
        "square_law": round(
            float(np.polyfit(reynolds[slow] ** 2, (value - value[0])[slow], 1)[0]), 3
        ),
        "force_over_rho_u2_area": {
            f"{number:g}": round(float(one / (np.pi * number)), 3)
            for number, one in zip(reynolds, value, strict=True)
            if number >= 1.0
        },
        "constants_that_fit_best": [round(float(one), 2) for one in fitted(reynolds, value)],
        "largest_deviation_of_formula_percent": round(
            float(PERCENT * np.abs(formula / value - 1.0).max()), 2
        ),
        "domain_of_100_radii_percent": domains,
    }


def kinetic():
    """Force by the kinetic equation in its densest gas, over that of creeping flow.

    Of a disk with holes, its faces apart by θ: F = (p π a²/4) s θ times the table's ratio, beside
    16 μ a u with u = β v θ/(4√π (1 + β)).
    """
    table = shipped_table("kinetic_sandwich.csv")
    numbers, gases = table.numbers, np.array(table.texts["gas"])
    densest = numbers["rarefaction"].max()
    here = (gases == "diatomic") & (numbers["rarefaction"] == densest) & (numbers["tac"] == 1.0)
    found = {}
    for beta, ratio in zip(
        numbers["open_fraction"][here], numbers["force_ratio"][here], strict=True
    ):
        if 0.0 < beta < MOST_OPEN:
            creeping = CREEPING / np.pi**1.5 * beta / ((1.0 + beta) * (1.0 - beta) * densest)
            found[f"{beta:g}"] = round(float(ratio / creeping), 3)
    return {"rarefaction": densest, "by_open_fraction": found}


def warm():
    """Numbers of the flow around a warm disk, by Grashof number."""
    table = read("warm")
    wide = table["domain"] == table["domain"].min()
    coarse = wide & (table["cells_around"] == table["cells_around"].min())
    force, heat, velocity = (
        table[name]
        for name in ("force_over_rho_U2_area", "heat_over_kappa_a_dT", "velocity_over_U")
    )
    found = {}
    for grashof in np.unique(table["grashof"]):
        here = coarse & (table["grashof"] == grashof)
        still, slow = (here & (velocity == one) for one in np.unique(velocity[here])[:2])
        found[f"{grashof:g}"] = {
            "force_over_rho_U2_area": round(float(force[still][0]), 3),
            "added_over_rho_U_u_area": round(
                float((force[slow][0] - force[still][0]) / velocity[slow][0]), 3
            ),
            "heat_over_kappa_a_dT": round(float(heat[still][0]), 2),
        }
    return found


def warm_checks():
    """Other meshes and domains beside the ones used."""
    table = read("warm")
    still = (table["grashof"] == 3000.0) & (table["velocity_over_U"] == 0.0)
    return [
        {
            "domain": domain,
            "cells_around": cells,
            "force_over_rho_U2_area": round(force, 4),
            "heat_over_kappa_a_dT": round(heat, 3),
        }
        for domain, cells, force, heat in zip(
            *(
                table[name][still].tolist()
                for name in (
                    "domain", "cells_around", "force_over_rho_U2_area", "heat_over_kappa_a_dT",
                )
            ),
            strict=True,
        )
    ]  # fmt: skip


def summary():
    """All results."""
    around_warm = warm()
    return {
        "flow": flow(),
        "kinetic_over_creeping": kinetic(),
        "warm": around_warm,
        "warm_checks": warm_checks(),
        "claim": claim.summary(around_warm),
    }
