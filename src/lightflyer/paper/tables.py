"""Tables 1 and S2 with derived columns, from what the paper's text states.

A cell that the text does not give is None, in CSV ``not available``.
"""

import math
from typing import Any

from lightflyer.paper.conditions import facts

NOT_AVAILABLE = "not available"

Row = dict[str, Any]


def emissivity_from(transmittance: float, reflectance: float) -> float:
    r"""Emissivity, or absorptivity, :math:`1 - \tau - \rho` [1].

    Parameters
    ----------
    transmittance, reflectance : float
        [1].

    Returns
    -------
    float
    """
    return 1.0 - transmittance - reflectance


def difference_uncertainty(first: float, second: float, correlation: float) -> float:
    r"""Standard uncertainty of a difference.

    .. math:: u^2 = u_1^2 + u_2^2 - 2\rho\,u_1 u_2

    Parameters
    ----------
    first, second : float
        Standard uncertainties of the two values.
    correlation : float
        Between -1 and 1.

    Returns
    -------
    float
    """
    variance = first**2 + second**2 - 2.0 * correlation * first * second
    return math.sqrt(max(variance, 0.0))  # rounding may leave a negative zero


def table_1() -> list[Row]:
    """Optical properties of the films.

    Returns
    -------
    list of dict
        One for each sample. Transmittance and reflectance are not in the text, so what would
        follow from them is None too.
    """
    return [_optical_row(stated) for stated in facts()["optical"]]


def _optical_row(stated: Row) -> Row:
    transmittance, reflectance = stated.get("transmittance"), stated.get("reflectance")
    derived = None
    if transmittance is not None and reflectance is not None:
        derived = emissivity_from(transmittance, reflectance)
    emissivity, absorptivity = stated["emissivity"], stated["absorptivity"]
    return {
        "sample": stated["sample"],
        "infrared_transmittance": transmittance,
        "infrared_reflectance": reflectance,
        "emissivity_from_t_and_r": derived,
        "emissivity": emissivity,
        "emissivity_uncertainty": stated["emissivity_uncertainty"],
        "emissivity_upper_bound_ftir": stated.get("emissivity_upper_bound_ftir"),
        "absorptivity": absorptivity,
        "absorptivity_over_emissivity": absorptivity / emissivity,
    }


def table_s2() -> list[Row]:
    """Pairs of faces: mean TAC, and their difference with its uncertainty.

    Returns
    -------
    list of dict
        One for each pair of top (alumina or mylar) and bottom (Ge or CNT). The uncertainty of a
        difference is given for the lowest and the highest stated uncertainty of a TAC, with
        independent errors and with fully correlated ones, which cancel where they are equal.
    """
    tac = {stated["sample"]: stated["tac"] for stated in facts()["accommodation"]}
    stated = facts()["accommodation_uncertainty"]
    low, high = stated["lowest"], stated["highest"]
    return [
        {
            "top": top,
            "bottom": bottom,
            "tac_top": tac[top],
            "tac_bottom": tac[bottom],
            "tac_uncertainty_lowest": low,
            "tac_uncertainty_highest": high,
            "tac_mean": 0.5 * (tac[top] + tac[bottom]),
            "tac_difference": tac[bottom] - tac[top],
            "difference_uncertainty_independent_lowest": difference_uncertainty(low, low, 0.0),
            "difference_uncertainty_independent_highest": difference_uncertainty(high, high, 0.0),
            "difference_uncertainty_correlated_lowest": difference_uncertainty(low, low, 1.0),
            "difference_uncertainty_correlated_highest": difference_uncertainty(low, high, 1.0),
        }
        for bottom in ("Ge", "CNT")
        for top in ("mylar", "alumina")
    ]


def to_csv(rows: list[Row]) -> str:
    """Rows as comma-separated values with a header.

    Parameters
    ----------
    rows : list of dict
        All with the same keys.

    Returns
    -------
    str
    """
    lines = [",".join(rows[0])]
    lines += [",".join(_cell(value) for value in row.values()) for row in rows]
    return "\n".join(lines) + "\n"


def _cell(value: Any) -> str:
    if value is None:
        return NOT_AVAILABLE
    return f"{value:.6g}" if isinstance(value, float) else str(value)
