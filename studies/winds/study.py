"""The gradient wind of NRLMSIS 2.1 beside the zonal mean of HWM14."""

import csv
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from lightflyer.environment import HWM14, GlobalNRLMSIS, GradientWind, Place
from lightflyer.environment.wind.gradient import CLOSE_TO_EQUATOR, NEAREST_EQUATOR
from lightflyer.files import palette

HERE = Path(__file__).parent
FIGURE = HERE.parents[1] / "docs" / "images" / "winds.png"

ALTITUDES = np.arange(10e3, 101e3, 5e3)
LATITUDES = np.radians(np.arange(-85.0, 86.0, 5.0))
LATITUDES = LATITUDES[np.abs(LATITUDES) >= NEAREST_EQUATOR]
MERIDIANS = np.radians(np.arange(0.0, 360.0, 45.0))
HOURS = np.arange(0.0, 24.0, 6.0) * 3600.0
MONTHS = (np.arange(12) * 30.44 + 14.0) * 86400.0
COMPARED = np.radians(30.0)
LEVELS = np.arange(-100, 101, 10)


def zonal_mean(wind, month):
    """Mean over longitude and time of day, shape (latitudes, altitudes) [m/s]."""
    return np.mean(
        [
            wind.velocity(ALTITUDES, Place(LATITUDES[:, None], meridian, month + hour)).east
            for meridian in MERIDIANS
            for hour in HOURS
        ],
        axis=0,
    )


def compare(gradient, model):
    """Rows by altitude: root mean square and largest difference poleward of 30°, closer to 20°."""
    beside = gradient - model
    far, near = np.abs(LATITUDES) >= COMPARED - 1e-9, np.abs(LATITUDES) < CLOSE_TO_EQUATOR
    for number, altitude in enumerate(ALTITUDES):
        here = beside[:, far, number]
        yield {
            "altitude_km": f"{altitude / 1e3:.0f}",
            "rms_m_s": f"{np.sqrt(np.mean(here**2)):.1f}",
            "largest_m_s": f"{np.abs(here).max():.1f}",
            "share_beyond_20_m_s": f"{np.mean(np.abs(here) > 20.0):.2f}",
            "rms_within_20_deg_m_s": f"{np.sqrt(np.mean(beside[:, near, number] ** 2)):.1f}",
            "rms_of_hwm14_m_s": f"{np.sqrt(np.mean(model[:, far, number] ** 2)):.1f}",
        }


def draw(winds):
    """Both winds in January and July."""
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 6.0), sharex=True, sharey=True)
    for row, (name, months) in zip(axes, winds.items(), strict=True):
        for ax, month, index in zip(row, ("January", "July"), (0, 6), strict=True):
            filled = None
            for side in (LATITUDES < 0.0, LATITUDES > 0.0):
                where = np.degrees(LATITUDES[side]), ALTITUDES / 1e3, months[index][side].T
                filled = ax.contourf(*where, LEVELS, cmap=palette.SIGN_MAP, extend="both")
                ax.contour(*where, [0.0], colors="black", linewidths=0.8)
            ax.set_title(f"{name}, {month}", fontsize=10)
            ax.set_xticks([-60, -30, 0, 30, 60])
            ax.text(0.0, 55.0, "no gradient wind here", rotation=90, ha="center", va="center",
                    fontsize=9, color=palette.GREY)  # fmt: skip
    for ax in axes[:, 0]:
        ax.set_ylabel("altitude [km]")
    for ax in axes[1]:
        ax.set_xlabel("latitude [°]")
    bar = figure.colorbar(filled, ax=axes, shrink=0.8, ticks=LEVELS[::2])
    bar.set_label("wind towards the east [m/s]")
    figure.savefig(FIGURE, dpi=150, bbox_inches="tight")


def main(path):
    """Compute, write, draw."""
    gradient = GradientWind(GlobalNRLMSIS(f107=150.0, ap=4.0))
    model = HWM14(path)
    place = Place(LATITUDES[:, None], 0.0, 0.0)
    winds = {
        "gradient wind": np.array(
            [gradient.velocity(ALTITUDES, place._replace(time=month)).east for month in MONTHS]
        ),
        "HWM14": np.array([zonal_mean(model, month) for month in MONTHS]),
    }
    rows = list(compare(*winds.values()))
    with (HERE / "gradient_wind.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    draw(winds)


if __name__ == "__main__":
    main(sys.argv[1])
