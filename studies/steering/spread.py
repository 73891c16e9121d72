"""A swarm over two days: the figure of docs/swarms.md, docs/images/spread.png."""

from pathlib import Path

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.mission.report.figures import plot_spread

IMAGE = Path(__file__).parents[2] / "docs" / "images" / "spread.png"


def main():
    """Fly and draw."""
    film = lf.FilmProperties(0.37e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    found = lf.mission.disperse_ensemble(
        lf.Disk(film, radius=0.0025),
        lf.Earth(sky=lf.environment.Daylight()),
        lf.Kinetic(),
        release=lf.Release("72 km", latitude=45.0, longitude=10.0, time="2026-06-21T12:00Z"),
        duration="4 days",
        ensemble=lf.mission.Ensemble(members=1000, wind=10.0, vertical_wind=0.2),
        areas=[
            lf.mission.Circle(45.0, 10.0, "500 km"),
            lf.mission.Polygon([35, 35, 70, 70], [-10, 40, 40, -10]),
        ],
    )
    plot.save(plot_spread(found), [IMAGE])
    print(found.inside[:, ::24].values, found.distance[::24].values, found.flying[::24].values)


if __name__ == "__main__":
    main()
