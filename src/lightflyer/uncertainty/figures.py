"""Uncertainty bands in a prediction's dataset and figures."""

from typing import TYPE_CHECKING

import numpy as np

from lightflyer.prediction.prediction import AltitudePrediction, ChamberPrediction
from lightflyer.uncertainty.propagation import BANDS, PredictionUncertainty

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_KILOMETRE = 1e3
_MILLIGRAMS = 1e6
_OPACITY = 0.2
_HEADROOM = 1.1
_FAR = 1e9  # beyond every axis
# Which line of its axes belongs to a quantity.
_LINES = {
    "levitation_irradiance": 0,
    "temperature": 0,
    "levitation_temperature": 1,
    "payload": 0,
}


def add_to_dataset(
    dataset: "xr.Dataset",
    prediction: AltitudePrediction | ChamberPrediction,
    uncertainty: PredictionUncertainty,
) -> None:
    """Add the 95 % bands as variables ``..._low`` and ``..._high`` over a coordinate of their own.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of the prediction; changed.
    prediction : AltitudePrediction or ChamberPrediction
    uncertainty : PredictionUncertainty
    """
    chamber = isinstance(prediction, ChamberPrediction)
    name, units, long_name = (
        ("band_pressure", "Pa", "gas pressure")
        if chamber
        else ("band_altitude", "m", "geometric altitude")
    )
    attributes = {"units": units, "long_name": long_name}
    dataset.coords[name] = (name, uncertainty.coordinate, attributes)
    for end, table in (("low", uncertainty.low), ("high", uncertainty.high)):
        for quantity in BANDS:
            about = dataset[quantity].attrs
            long_name = f"{about['long_name']}, {end} end of the 95 % band"
            attributes = {"units": about["units"], "long_name": long_name}
            dataset[f"{quantity}_{end}"] = (name, table[quantity], attributes)


def add_to_figures(
    figures: "dict[str, Figure]",
    prediction: AltitudePrediction | ChamberPrediction,
    uncertainty: PredictionUncertainty,
) -> None:
    """Shade the 95 % bands around the lines of a prediction's figures.

    Parameters
    ----------
    figures : dict of str to matplotlib.figure.Figure
        From :func:`lightflyer.foundation.drawing.prediction_figures`; changed.
    prediction : AltitudePrediction or ChamberPrediction
    uncertainty : PredictionUncertainty
    """
    axes = figures["levitation-irradiance"].axes
    if isinstance(prediction, ChamberPrediction):
        _shade(axes[0], "levitation_irradiance", uncertainty, 1.0, 1.0)
        return
    across = 1.0 / _KILOMETRE
    _shade(axes[0], "levitation_irradiance", uncertainty, across, 1.0)
    _shade(axes[1], "levitation_temperature", uncertainty, across, 1.0)
    _shade(axes[1], "temperature", uncertainty, across, 1.0)
    payload = figures["payload"].axes[0]
    _shade(payload, "payload", uncertainty, across, _MILLIGRAMS)
    bottom, top = payload.get_ylim()
    highest = _HEADROOM * _MILLIGRAMS * float(np.nanmax(uncertainty.high["payload"]))
    payload.set_ylim(bottom, max(top, highest))


def _shade(
    ax: "Axes", name: str, uncertainty: PredictionUncertainty, across: float, scale: float
) -> None:
    """Shade a band in the colour of its line, found by its place in the figure."""
    # a lower end without an upper one: some samples need more light than there is a number for
    low, high = uncertainty.low[name] * scale, uncertainty.high[name] * scale
    ceiling = np.where(np.isfinite(low) & ~np.isfinite(high), _FAR, high)
    colour = ax.get_lines()[_LINES[name]].get_color()
    ax.fill_between(
        uncertainty.coordinate * across, low, ceiling, color=colour, alpha=_OPACITY, lw=0, zorder=0
    )
