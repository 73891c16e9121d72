"""Fit of the perforated disk beside its table, rows that were left out, and open space.

    python studies/schafer2025_table/study.py

Writes perforated-disk.png and results.json.
"""

import json
import sys
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.membranes.sandwich import perforated_disk_fit, rarefaction

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent))

from kinetic_fits.perforated import fit, perforated_disk_table  # noqa: E402

INNER = slice(1, 6)  # open fractions 0.2 to 0.9; the outermost rows cannot be left out
SMALL_EXCESS = 0.01  # relative, of one face, at which open space is compared
CONTINUUM = 4.0 / np.pi**1.5  # force coefficient of a wide domain, over β/((1+β)δ)
PERCENT = 100.0


def ratios(found, beta, delta):
    """Force, own and cross heat ratios of a fit."""
    with lf.float64():
        force = np.asarray(found.force_ratio(beta, delta))
        heat = found.heat_ratios(beta, delta)
        solid = 1.0 - beta
        return force, np.asarray(heat.own) / solid, np.asarray(heat.cross) / solid


def deviations(found, table):
    """Relative deviation of force and own heat, and of cross heat over the own [%]."""
    beta, delta = np.meshgrid(table.open_fraction, table.rarefaction, indexing="ij")
    force, own, cross = ratios(found, beta, delta)
    own_there = 0.5 * (table.common_ratio + table.difference_ratio)
    cross_there = 0.5 * (table.common_ratio - table.difference_ratio)
    return {
        "force": PERCENT * (force / table.force_ratio - 1.0),
        "heat_own": PERCENT * (own / own_there - 1.0),
        "heat_cross": PERCENT * (cross - cross_there) / own_there,
    }


def left_out(table):
    """Deviations where the fit has not seen the row of this open fraction [%]."""
    found = {}
    for row in range(table.open_fraction.size):
        kept = np.ones(table.force_ratio.shape, bool)
        kept[row] = False
        for name, values in deviations(fit(table, kept), table).items():
            found.setdefault(name, np.empty(values.shape))[row] = values[row]
    return found


def summary(table, values):
    """Largest deviation at each rarefaction, over open fractions 0.2 to 0.9 [%]."""
    return {
        name: {
            f"{delta:g}": round(float(largest), 2)
            for delta, largest in zip(
                table.rarefaction, np.abs(part[INNER]).max(axis=0), strict=True
            )
        }
        for name, part in values.items()
    }


def near_end(table):
    """Largest share by which the model's force exceeds that in open space, in helium."""
    film = lf.FilmProperties(3e-4, 0.5, 0.1, 0.1, tac_top=1.0, tac_bottom=1.0)
    beta = np.linspace(table.open_fraction[INNER][0], table.open_fraction[INNER][-1], 15)[:, None]
    sandwich = lf.Sandwich(film, film, 0.01, 1e-6, beta, 1e-6, 1e-6, 1.0)
    chamber = lf.Chamber(gas=lf.gas.HELIUM)
    temperature = float(chamber.state(1.0).temperature)
    at_one_pascal = rarefaction(sandwich.radius, 1.0, temperature, lf.gas.HELIUM)
    state, unknowns = chamber.state(table.rarefaction / float(at_one_pascal)), (0.0, SMALL_EXCESS)
    forces = [model.force(sandwich, state, unknowns) for model in (lf.Kinetic(), lf.Schafer2025())]
    share = (1.0 - forces[0] / forces[1]).max(axis=0)
    return {f"{d:g}": round(float(s), 3) for d, s in zip(table.rarefaction, share, strict=True)}


def draw(table):
    """Force and heat ratios over rarefaction: table and fit."""
    figure = plot.new_figure(columns=3, width=5.4, height=4.8)
    delta = np.geomspace(0.03, 1e3, 400)
    force_axes, common_axes, difference_axes = figure.axes
    for row, colour in zip((0, 1, 3, 5, 6), palette.PALETTE, strict=False):
        beta = table.open_fraction[row]
        force, own, cross = ratios(perforated_disk_fit(), beta, delta)
        for axes, line, points in (
            (force_axes, force, table.force_ratio),
            (common_axes, own + cross, table.common_ratio),
            (difference_axes, own - cross, table.difference_ratio),
        ):
            axes.plot(delta, line, color=colour, label=f"β = {beta:g}")
            axes.plot(table.rarefaction, points[row], "o", ms=4, color=colour)
    for axes, title in zip(
        figure.axes,
        ("force", "heat, both faces equally hot", "heat, one as hot as the other is cold"),
        strict=True,
    ):
        axes.set(xscale="log", xlabel="rarefaction δ", ylabel=f"{title}, over free molecules")
        axes.grid(alpha=0.3)
    force_axes.set(yscale="log", ylim=(1e-3, 1.5))
    force_axes.legend(fontsize=8)
    plot.save(figure, [HERE / "perforated-disk.png"])


def main():
    """Write the figure and the numbers."""
    table = perforated_disk_table()
    draw(table)
    dense = table.rarefaction[-1]
    force, _, _ = ratios(perforated_disk_fit(), 0.5, dense)
    beta = 0.5
    open_space = CONTINUUM * beta / (1.0 + beta) / dense / (0.25 * (1.0 - beta))
    results = {
        "largest_deviation_percent": summary(table, deviations(perforated_disk_fit(), table)),
        "largest_deviation_left_out_percent": summary(table, left_out(table)),
        "largest_excess_over_open_space": near_end(table),
        "continuum_in_open_space_over_fit_at_100": round(open_space / float(force), 3),
    }
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
