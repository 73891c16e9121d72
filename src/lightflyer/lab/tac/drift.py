"""Whether rows of a heater's run depend on when they were taken."""

import numpy as np

_SIGNIFICANT = 4.0  # standard errors
_LEAST = 2e-3  # relative; no bench holds a conductance better
_FEWEST = 8  # rows of a direction
_TIED = 0.9  # correlation of time and pressure, above which drift cannot be told from the law
_PERCENT = 100.0


def drift_warnings(residual: np.ndarray, pressure: np.ndarray, alike: float) -> list[str]:
    """Lines about hysteresis and drift; relative residuals of rows in their order, shape (m,)."""
    # The gauge lags behind a pressure that rises or falls; heater, leads and power meter drift.
    count = len(residual)
    level = np.log(pressure)
    time = np.linspace(-0.5, 0.5, count)
    rising = np.sign(np.gradient(level)) if count > 1 else np.zeros(count)
    causes = {
        "rise": 0.5 * rising,  # half above, half below
        "time": time - np.polynomial.Polynomial.fit(level, time, 2)(level),
    }
    if min(np.sum(rising > 0.0), np.sum(rising < 0.0)) < _FEWEST:
        del causes["rise"]
    if np.var(causes["time"]) < (1.0 - _TIED**2) * np.var(time):
        del causes["time"]
    if not causes:
        return []
    design = np.column_stack([np.ones(count), *causes.values()])
    found, *_ = np.linalg.lstsq(design, residual)
    scatter = np.var(residual - design @ found) * count / max(count - design.shape[1], 1)
    error = np.sqrt(alike * scatter * np.diag(np.linalg.pinv(design.T @ design)))
    words = {
        "rise": "rows taken while the pressure rose lie {} above those while it fell: the gauge "
        "lags, or the heater was not yet at rest",
        "time": "at the same pressure, rows at the end lie {} above those at the beginning: "
        "something drifts",
    }
    return [
        words[name].format(f"{_PERCENT * value:+.2g} ± {_PERCENT * one:.1g} %")
        for name, value, one in zip(causes, found[1:], error[1:], strict=True)
        if abs(value) > max(_SIGNIFICANT * one, _LEAST)
    ]
