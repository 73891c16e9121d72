"""What a finite number of flights leaves open."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.clock import seconds_of
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Checked
from lightflyer.environment.atmosphere.earth import US1976
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.planetary import Planetary
from lightflyer.mission.areas import distances_between, geographic, units_of
from lightflyer.mission.path.integration import TerminationReason
from lightflyer.mission.path.motion import ELAPSED, Course, Vehicle, within
from lightflyer.mission.report.dataset import degrees_of
from lightflyer.mission.report.ground import time_within
from lightflyer.numerics.batches import in_batches

if TYPE_CHECKING:
    import xarray as xr


CONFIDENCE = 0.95  # Of the intervals of shares

_INTERVAL = (2.5, 50.0, 97.5)  # Percentiles of a 95 % interval and its median
HIGHEST_GROUND = 9e3  # Lowest altitude of a mission up to which its end there is a landing [m]
FLIGHT_LEVELS = 100, 245, 600  # Pressure altitudes [100 ft]
SHARES = 0.5, 0.95  # Of the landings that areas hold
FEWEST = 20  # Landings from which on the larger area is known

_FAR_ABOVE = 40e3  # Altitude above all flight levels, whatever the weather [m]
_HUNDRED_FEET = 30.48  # metres
_POINTS = 4096  # of tracks that are looked at together: an atmosphere takes 0.1 MB for each
_RESAMPLES = 400
_CORNERS = 120  # of the outline of an area
_PREFIXES = "ensemble_", "launch_", ""  # of the flights that landings are counted of, best first


def binomial_interval(counts: np.ndarray, trials: int) -> tuple[np.ndarray, np.ndarray]:
    """Interval of a share that was counted, by Clopper and Pearson; [ClopperPearson1934]_."""
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - CONFIDENCE)
    counts = np.asarray(counts)
    some, missed = np.maximum(counts, 1), np.maximum(trials - counts, 1)
    low = betaincinv(some, trials - some + 1, tail)
    high = betaincinv(trials - missed + 1, missed, 1.0 - tail)
    return np.where(counts > 0, low, 0.0), np.where(counts < trials, high, 1.0)


def interval_of(values: np.ndarray) -> dict[str, float]:
    """Median of flights, and what 95 % of them are between."""
    low, median, high = np.percentile(values, _INTERVAL)
    return {"low": float(low), "median": float(median), "high": float(high)}


class Landing(Checked):
    """What a landing is counted in.

    Attributes
    ----------
    objects : int
        Flyers that are released.
    flight_levels : tuple of int
        Pressure altitudes [100 ft] by the International Standard Atmosphere, 1013.25 hPa (29.92
        inHg) at its zero.
    """

    objects: int = field(static=True, default=1)
    flight_levels: tuple[int, ...] = field(static=True, default=FLIGHT_LEVELS)

    def __check_init__(self) -> None:
        levels = np.asarray(self.flight_levels, float)
        if levels.size == 0 or not np.all((levels > 0.0) & (levels <= 1000.0)):
            raise ParameterError("flight_levels are hundreds of feet from 1 to 1000, such as 245")
        if self.objects < 1:
            raise ParameterError(f"objects = {self.objects} must be at least 1")


class Ellipse(NamedTuple):
    """An area, or a volume, that holds a share of points."""

    share: float
    size: float  # [m²] or [m³]
    low: float  # of its 95 % interval, by resampling
    high: float
    axes: np.ndarray  # Half axes as columns, the longest first [m]
    middle: np.ndarray  # [m]


class Map(NamedTuple):
    """Lambert's azimuthal map about a place, in which areas are true."""

    centre: np.ndarray  # Unit vector
    radius: float  # Of the planet [m]

    def plane(self, latitude: Any, longitude: Any) -> np.ndarray:
        """Places in degrees, as eastward and northward coordinates [m], shape (..., 2)."""
        units, (east, north) = units_of(latitude, longitude), self._axes()
        scale = self.radius * np.sqrt(2.0 / np.maximum(1.0 + units @ self.centre, 1e-12))
        return np.stack([units @ east, units @ north], axis=-1) * scale[..., None]

    def places(self, plane: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Latitudes and longitudes [deg] of points of the map."""
        east, north = self._axes()
        square = np.sum((plane / self.radius) ** 2, axis=-1)
        across = np.sqrt(np.maximum(1.0 - 0.25 * square, 0.0))[..., None] / self.radius
        ahead = (1.0 - 0.5 * square)[..., None] * self.centre
        return degrees_of(ahead + across * (plane[..., :1] * east + plane[..., 1:] * north))

    def _axes(self) -> tuple[np.ndarray, np.ndarray]:
        """East and north at the centre; of a pole along the meridian of longitude 0."""
        x, y, _ = self.centre
        length = np.hypot(x, y)
        east = np.array([-y, x, 0.0]) / length if length > 0.0 else np.array([0.0, 1.0, 0.0])
        return east, np.cross(self.centre, east)


class Landings(NamedTuple):
    """Where flights land."""

    landed: np.ndarray  # Whether each does, shape (flights,)
    latitude: np.ndarray  # Of those that do [deg], shape (landings,)
    longitude: np.ndarray
    map: Map
    points: np.ndarray  # In the map [m], shape (landings, 2)
    areas: tuple[Ellipse, ...]  # That hold SHARES, as far as there are enough landings
    prefix: str = ""  # Of the names of the flights


def add_landing(
    dataset: "xr.Dataset",
    vehicle: Vehicle,
    course: Course,
    values: dict[str, Any],
    landing: Landing,
) -> None:
    """Add how long each flight is below flight levels, and how close the flights are there.

    ``values``: what the first flight is like on its ``course``.
    """
    environment = still = vehicle.setup.environment
    if isinstance(environment, Planetary):
        still = replace(environment, wind=None)
    where, released = environment.coordinate, seconds_of(dataset.time.values[0])

    def pressures(altitude: Any, *place: Any) -> Any:
        return _pressure(still, altitude, Place(*place))

    levels = {f"fl{level}": level_pressure(level) for level in landing.flight_levels}
    for prefix in _PREFIXES:
        if f"{prefix}end_altitude" not in dataset:
            continue
        # where flights are at the times that are kept, and from their end on there
        known = np.isfinite(np.atleast_2d(dataset[f"{prefix}altitude"].values))
        track = {"elapsed": np.where(known, dataset[ELAPSED].values, np.nan)}
        for name in ("altitude", "latitude", "longitude"):
            track[name] = np.atleast_2d(dataset[prefix + name].values)
        for name, column in track.items():
            end = np.atleast_1d(dataset[f"{prefix}end_{name}"].values)[:, None]
            track[name] = np.hstack([np.where(known, column, end), end])
        if track["altitude"].min() > _FAR_ABOVE:
            continue
        delay = dataset.launch_delay.values[:, None] if prefix == "launch_" else 0.0
        altitude = np.clip(track["altitude"], where.lowest, where.highest)
        latitude, longitude = (np.radians(track[name]) for name in ("latitude", "longitude"))
        columns = altitude, latitude, longitude, released + delay + track["elapsed"]
        pressure = in_batches(pressures, [one.ravel() for one in columns], _POINTS)
        pressure = pressure.reshape(altitude.shape)
        dims = dataset[f"{prefix}end_altitude"].dims
        for name, level in levels.items():
            below = time_within(track["elapsed"], -np.log(pressure), -np.log(level))
            text = f"time below {name.upper()}, {level / 100.0:.4g} hPa, until the end"
            about = {"units": "s", "long_name": text}
            dataset[f"{prefix}below_{name}"] = (dims, below if dims else below[0], about)
        dataset.attrs["objects"] = landing.objects
        if prefix == "ensemble_":
            below = pressure >= min(levels.values())
            crowd = np.full(dataset.sizes[ELAPSED], np.nan)
            below = below[:, :-1] & np.isfinite(dataset["ensemble_altitude"].values)
            radius = 1e3 * float(dataset.attrs["planet_radius_km"])
            for time in np.flatnonzero(below.sum(axis=0) >= FEWEST):
                rows = below[:, time]
                here = track["latitude"][rows, time], track["longitude"][rows, time]
                mean = units_of(*here).sum(axis=0)
                plane = Map(mean / np.linalg.norm(mean), radius).plane(*here)
                points = np.column_stack([plane, track["altitude"][rows, time]])
                volume = size_holding(points, SHARES[0])
                crowd[time] = SHARES[0] * rows.mean() / volume if volume > 0.0 else np.nan
            text = "share of the flights in a volume where they are densest below the levels"
            dataset["airspace_share"] = (ELAPSED, crowd, {"units": "m-3", "long_name": text})

    if "objects" in dataset.attrs:
        last = within(vehicle, course)
        place = Place(*geographic(last.position[-1:]), last.released + last.elapsed[-1:])
        state = environment.state(last.altitude[-1:], place)
        density = state.gas.density(state.pressure, state.temperature)
        diameter = 2.0 * np.sqrt(np.asarray(vehicle.setup.flyer.area) / np.pi)
        speed, viscosity = abs(values["axial_speed"][-1]), state.gas.viscosity(state.temperature)
        reynolds = float((density * speed * diameter / viscosity)[0])
        about = {"units": "1", "long_name": "Reynolds number at the end, by speed and diameter"}
        dataset["end_reynolds"] = ((), reynolds, about)


def landings_of(dataset: "xr.Dataset") -> Landings | None:
    """Where the flights of a mission that ends at the ground land; None of any other."""
    if "objects" not in dataset.attrs:
        return None
    prefix = next(name for name in _PREFIXES if f"{name}end_reason" in dataset)
    ends = {name: np.atleast_1d(dataset[f"{prefix}end_{name}"].values)
            for name in ("reason", "latitude", "longitude")}  # fmt: skip
    landed = ends["reason"] == TerminationReason.LOWEST_ALTITUDE
    latitude, longitude = ends["latitude"][landed], ends["longitude"][landed]
    mean = units_of(latitude, longitude).sum(axis=0) if landed.any() else np.array([1.0, 0.0, 0.0])
    about = Map(mean / np.linalg.norm(mean), 1e3 * float(dataset.attrs["planet_radius_km"]))
    points = about.plane(latitude, longitude)
    areas = tuple(_holding(points, share) for share in SHARES if len(points) >= FEWEST)
    return Landings(landed, latitude, longitude, about, points, areas, prefix)


def outline(landings: Landings, area: Ellipse) -> tuple[np.ndarray, np.ndarray]:
    """Corners of an area anticlockwise, the last is the first; latitudes, longitudes [deg]."""
    return landings.map.places(outline_in_map(area))


def outline_in_map(area: Ellipse) -> np.ndarray:
    """Corners of an area in the map [m], shape (n, 2)."""
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS + 1)
    angle[-1] = 0.0
    axes = area.axes * [1.0, np.sign(np.linalg.det(area.axes))]
    return area.middle + np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ axes.T


def level_pressure(level: float) -> float:
    """Pressure of a flight level [100 ft] [Pa]."""
    height, radius = level * _HUNDRED_FEET, constants.EARTH_EFFECTIVE_RADIUS
    # the standard counts in geopotential altitude
    return float(US1976().pressure(radius * height / (radius - height)))


def summarise_landing(dataset: "xr.Dataset") -> dict[str, Any] | None:
    """The landings in numbers, with a unit at the end of each name; None without a landing."""
    found = landings_of(dataset)
    if found is None:
        return None
    prefix = found.prefix
    count, total, objects = int(found.landed.sum()), found.landed.size, dataset.attrs["objects"]
    low, high = (float(edge) for edge in binomial_interval(np.array(count), total))
    numbers: dict[str, Any] = {
        "flights": total,
        "objects": objects,
        "stated_end_reynolds": float(dataset["end_reynolds"]),
        "landed": {"share": count / total, "low": low, "high": high},
        "below_h": {
            str(name).partition("below_")[2].upper(): interval_of(
                np.atleast_1d(values.values) / 3600.0
            )
            for name, values in dataset.items()
            if str(name).startswith(f"{prefix}below_")
        },
    }
    if count:
        (latitude,), (longitude,) = found.map.places(found.points.mean(axis=0)[None])
        release = units_of(dataset.latitude.values[0], dataset.longitude.values[0])
        away = distances_between(
            units_of(found.latitude, found.longitude), release, found.map.radius
        )
        after = np.atleast_1d(dataset[f"{prefix}end_elapsed"].values)[found.landed]
        numbers |= {
            "centre_latitude_deg": float(latitude),
            "centre_longitude_deg": float(longitude),
            "after_h": interval_of(after / 3600.0),
            "distance_from_release_km": interval_of(away / 1e3),
        }
    landing = count / total * objects
    numbers["areas"] = [
        {
            "holds": area.share,
            "area_km2": area.size / 1e6,
            "low_km2": area.low / 1e6,
            "high_km2": area.high / 1e6,
            "half_axes_km": [float(one) / 1e3 for one in np.linalg.norm(area.axes, axis=0)],
            "objects_per_km2": landing * area.share / (area.size / 1e6),
        }
        for area in found.areas
    ]
    crowd = dataset["airspace_share"].values if "airspace_share" in dataset else np.zeros(0)
    if np.isfinite(crowd).any():
        densest = int(np.nanargmax(crowd))
        numbers["airspace"] = {
            "objects_per_km3": float(crowd[densest]) * 1e9 * objects,
            "at_h": float(dataset[ELAPSED][densest]) / 3600.0,
        }
    return numbers


@entry_point
def _pressure(environment: AbstractEnvironment, altitude: Any, place: Place) -> Any:
    return environment.state(altitude, place).pressure


def size_holding(points: np.ndarray, share: float) -> float:
    """Area [m²] or volume [m³] of the ellipse or ellipsoid that holds a share of points (n, d)."""
    _, covariance, reach = _shape(points, share)
    unit = {2: np.pi, 3: 4.0 / 3.0 * np.pi}[points.shape[1]]
    determinant = np.linalg.det(covariance)
    return float(unit * reach ** points.shape[1] * np.sqrt(max(determinant, 0.0)))


def _shape(points: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Middle, covariance, and how many standard deviations hold a share of points."""
    middle = points.mean(axis=0)
    covariance = np.cov(points.T)
    # least squares, where points lie on a line
    away = points - middle
    squares = np.sum(away @ np.linalg.pinv(covariance) * away, axis=1)
    # one more point of the same kind is inside this one with that chance
    rank = min(int(np.ceil((len(points) + 1) * share)), len(points))
    return middle, covariance, float(np.sqrt(np.partition(squares, rank - 1)[rank - 1]))


def _holding(points: np.ndarray, share: float) -> Ellipse:
    middle, covariance, reach = _shape(points, share)
    values, vectors = np.linalg.eigh(covariance)
    axes = (vectors * np.sqrt(np.maximum(values, 0.0)) * reach)[:, ::-1]
    generator, count = np.random.default_rng(0), len(points)
    drawn = (points[generator.integers(count, size=count)] for _ in range(_RESAMPLES))
    low, high = np.percentile([size_holding(some, share) for some in drawn], (2.5, 97.5))
    return Ellipse(share, size_holding(points, share), float(low), float(high), axes, middle)
