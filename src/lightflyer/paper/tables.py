"""Tables 1 and S2 with derived columns, from what the paper's text states.

A cell that the text does not give is None, in CSV ``not available``.
"""

import math
import statistics
from typing import Any

from lightflyer.paper.conditions import facts

NOT_AVAILABLE = "not available"

Row = dict[str, Any]

_MOST_TESTS = 3  # of one material in Table S2


def emissivity_from(transmittance: float, reflectance: float) -> float:
    r"""Emissivity, or absorptivity, :math:`1 - \tau - \rho` [1]."""
    return 1.0 - transmittance - reflectance


def difference_uncertainty(first: float, second: float, correlation: float) -> float:
    r"""Standard uncertainty of a difference; ``correlation``: between -1 and 1."""
    # .. math:: u^2 = u_1^2 + u_2^2 - 2\rho\,u_1 u_2
    variance = first**2 + second**2 - 2.0 * correlation * first * second
    return math.sqrt(max(variance, 0.0))  # rounding may leave a negative zero


def table_1() -> list[Row]:
    """Optical properties of the films."""
    return [_optical_row(stated) for stated in facts()["optical"]]


def _optical_row(stated: Row) -> Row:
    transmittance, reflectance = stated["transmittance"], stated["reflectance"]
    errors = stated["transmittance_uncertainty"], stated["reflectance_uncertainty"]
    return {
        "sample": stated["sample"],
        "band": stated["band"],
        "transmittance": transmittance,
        "transmittance_uncertainty": errors[0],
        "reflectance": reflectance,
        "reflectance_uncertainty": errors[1],
        "absorptance": stated["absorptance"],
        "absorptance_uncertainty": stated["absorptance_uncertainty"],
        "absorptance_from_t_and_r": emissivity_from(transmittance, reflectance),
        "its_uncertainty_independent": math.hypot(*errors),
        "its_uncertainty_sum": sum(errors),
        "upper_bound_from_t": emissivity_from(transmittance, 0.0),
        "upper_bound_ftir": stated.get("upper_bound_ftir"),
    }


def table_s2() -> list[Row]:
    """Thermal accommodation coefficients: each test with its 95 % interval, and their mean."""
    return [_accommodation_row(stated) for stated in facts()["accommodation"]]


def _accommodation_row(stated: Row) -> Row:
    tests: list[Any] = list(zip(stated["tests"], stated["lowest"], stated["highest"], strict=True))
    tests += [(None, None, None)] * (_MOST_TESTS - len(tests))
    row: Row = {"sample": stated["sample"]}
    for number, (tac, lowest, highest) in enumerate(tests, start=1):
        row |= {f"test_{number}": tac, f"lowest_{number}": lowest, f"highest_{number}": highest}
    row["literature"] = stated.get("literature")
    values = stated["tests"]
    row["mean"], row["deviation"] = statistics.mean(values), statistics.stdev(values)
    row["printed_mean"] = stated.get("tac")
    row["printed_uncertainty"] = stated.get("tac_uncertainty")
    return row


def tac_pairs() -> list[Row]:
    """Pairs of faces: mean TAC, and their difference with its uncertainty."""
    stated = {row["sample"]: row for row in facts()["accommodation"]}
    rows = []
    for bottom in ("Ge", "CNT"):
        for top in ("mylar", "alumina"):
            tac = stated[top]["tac"], stated[bottom]["tac"]
            errors = stated[top]["tac_uncertainty"], stated[bottom]["tac_uncertainty"]
            rows.append(
                {
                    "top": top,
                    "bottom": bottom,
                    "tac_top": tac[0],
                    "tac_top_uncertainty": errors[0],
                    "tac_bottom": tac[1],
                    "tac_bottom_uncertainty": errors[1],
                    "tac_mean": 0.5 * (tac[0] + tac[1]),
                    "tac_difference": tac[1] - tac[0],
                    "difference_uncertainty_independent": difference_uncertainty(*errors, 0.0),
                    "difference_uncertainty_correlated": difference_uncertainty(*errors, 1.0),
                }
            )
    return rows


def to_csv(rows: list[Row]) -> str:
    """Rows as comma-separated values with a header; ``rows``: all with the same keys."""
    lines = [",".join(rows[0])]
    lines += [",".join(_cell(value) for value in row.values()) for row in rows]
    return "\n".join(lines) + "\n"


def _cell(value: Any) -> str:
    if value is None:
        return NOT_AVAILABLE
    return f"{value:.6g}" if isinstance(value, float) else str(value)
