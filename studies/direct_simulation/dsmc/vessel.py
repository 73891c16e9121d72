"""Where the gas ends: a cylinder around the disk, each part a reservoir or a solid wall."""

from typing import NamedTuple

FLOOR, SIDE, LID = range(3)
PARTS = ("floor", "side", "lid")


class Vessel(NamedTuple):
    """A cylinder, for compiled loops.

    Gas at rest enters through a reservoir. A solid wall sends back each molecule diffusely, at the
    wall's temperature.

    Attributes
    ----------
    distance : tuple of float
        Of floor, side and lid from the disk's centre [radii].
    solid : tuple of bool
        Floor, side, lid.
    temperature : tuple of float
        Of the solid parts, over that of the gas far away.
    """

    distance: tuple[float, float, float]
    solid: tuple[bool, bool, bool] = (False, False, False)
    temperature: tuple[float, float, float] = (1.0, 1.0, 1.0)


def build_vessel(
    boundary: float,
    floor: float | None = None,
    lid: float | None = None,
    solid: str = "",
    floor_temperature: float = 1.0,
) -> Vessel:
    """A vessel of some radius.

    Parameters
    ----------
    boundary : float
        Radius; distance of floor and lid where they have none of their own [radii].
    floor, lid : float, optional
        Distances below and above the disk [radii].
    solid : str
        Names of solid parts, such as ``"floor side"``.
    floor_temperature : float
        Of a solid floor; other walls are as cold as the gas.

    Returns
    -------
    Vessel

    Raises
    ------
    ValueError
        If a name is unknown, or all parts are solid: nothing would hold the pressure.
    """
    names = solid.split()
    unknown = set(names) - set(PARTS)
    if unknown:
        raise ValueError(f"solid part {unknown.pop()!r}: must be of {', '.join(PARTS)}")
    if len(set(names)) == len(PARTS):
        raise ValueError("one part of the vessel must be a reservoir, which holds the pressure")
    return Vessel(
        (floor or boundary, boundary, lid or boundary),
        tuple(part in names for part in PARTS),
        (floor_temperature, 1.0, 1.0),
    )
