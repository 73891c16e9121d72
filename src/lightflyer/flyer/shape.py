"""How flyers of films with known layers hold their shape under stress, heat, pressure and loads."""

import math
from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.flyer.hanging import HOLD, HangingPlate, Held, hung
from lightflyer.structure.laminate import (
    Curl,
    Laminate,
    Stiffness,
    bending_stresses,
    curl_of_film,
    flat_load,
    free_curvature,
    free_strain,
    laminate_stiffness,
    layer_stresses,
    perforated_share,
    projected_share,
    tac_within,
    tension_at_holes,
)
from lightflyer.structure.plates import (
    clamped_deflection,
    cylinder_buckling_pressure,
    fold_curvature,
    fold_tension,
    rim_buckling_pressure,
    sphere_buckling_pressure,
)
from lightflyer.structure.sandwich import (
    Ligaments,
    dimpling_load,
    ligament_shear_stiffness,
    root_moment,
    sandwich_stiffness,
)
from lightflyer.structure.vibrations import open_sphere_frequency, sphere_frequency

_NONE = 1e-30  # in place of no stress to spare [Pa], so that derivatives stay finite


class Shape(NamedTuple):
    """How a flyer holds its shape; NaN where that is not known."""

    #: Largest tension in a layer over its strength [1]; NaN where no layer's strength is known
    stress_over_strength: Numeric
    curvature: Numeric = math.nan  #: The larger one of its principal curvatures [1/m]
    deflection: Numeric = math.nan  #: How far its edge is from the height of its middle [m]
    gap_closed: Numeric = math.nan  #: Share of the gap by which two membranes come closer [1]
    #: Compression, or pressure from outside, over that at which it buckles [1]
    load_over_buckling: Numeric = math.nan
    buckling_pressure: Numeric = math.nan  #: Pressure from outside that a shell withstands [Pa]
    lift_kept: Numeric = math.nan  #: Lift of the curled flyer over that of a flat one [1]
    #: Load beside its payload's that it withstands where it is held or carries [N]
    bearable_load: Numeric = math.nan
    lowest_frequency: Numeric = math.nan  #: Of a flat flyer, without gas [Hz]


OF_FILMS = (
    *("curvature", "deflection", "stress_over_strength"),
    *("lift_kept", "bearable_load", "lowest_frequency"),
)
OF_SANDWICHES = (*OF_FILMS, "gap_closed", "load_over_buckling")


class Bent(NamedTuple):
    """A thin flyer that curls and carries."""

    curl: Curl
    plate: HangingPlate
    load: Numeric  # Weight of the payload [N]

    @property
    def together(self) -> Curl:
        """Curl and droop as one."""
        droop = 2.0 * self.plate.droop * self.load / xp.asarray(self.plate.radius) ** 2
        return Curl(self.curl.largest + droop, self.curl.smallest + droop)

    @property
    def rise(self) -> Array:
        """How far the edge is from the height of the middle, at most the radius [m]."""
        # Curl and droop add up though one may be upward and the other downward: their forms differ.
        # Of an arc this is within 3 % up to where its ends stand upright.
        radius = xp.asarray(self.plate.radius)
        curled = 0.5 * xp.abs(self.curl.largest) * radius**2
        shallow = curled + self.plate.droop * self.load
        return shallow / xp.sqrt(1.0 + (shallow / radius) ** 2)

    def lift_kept(self, tacs: tuple[Numeric, Numeric] | None = None) -> Array:
        """Lift over a flat flyer's, by light and force that go with the area seen from above [1].

        ``tacs``: of top and bottom face, where the force goes with their difference.
        """
        share = projected_share(self.together, self.plate.radius)
        if tacs is None:
            return share**2
        top, bottom = (xp.asarray(tac) for tac in tacs)
        up = self.together.largest > 0.0
        within = (
            xp.where(up, tac_within(top, share), top),
            xp.where(up, bottom, tac_within(bottom, share)),
        )
        same = top == bottom
        change = (within[1] - within[0]) / xp.where(same, 1.0, bottom - top)
        return share**2 * xp.where(same, np.nan, change)

    def cut(self, at: Numeric) -> tuple[Array, Array]:
        """Heights over the middle at a distance from it that its payload gives it [m].

        Towards one of three points, and opposite.
        """
        towards, opposite = self.plate.cut(at)
        return self.load * towards, self.load * opposite


def bent_film(film: Laminate, radius: Numeric, temperature: Numeric, held: Held) -> Bent:
    """A round film that curls and carries."""
    stiffness = laminate_stiffness(film)
    curl = curl_of_film(free_curvature(film, temperature), stiffness, radius)
    plate = hung(held, radius, HOLD * radius, stiffness.plate, stiffness.poisson)
    return Bent(curl, plate, held.load)


def shape_of_film(
    film: Laminate,
    radius: Numeric,
    temperature: Numeric,
    held: Held,
    tacs: tuple[Numeric, Numeric] | None = None,
) -> Shape:
    """Shape of a round film; ``tacs`` of its top and bottom face."""
    bent = bent_film(film, radius, temperature, held)
    plate, strain = bent.plate, free_strain(film, temperature)
    own = layer_stresses(film, temperature, (strain, strain), tuple(bent.curl))
    # What it carries bends it as a plate, or folds it at the hold, whichever strains less.
    tension, membrane = held.load / plate.perimeter, laminate_stiffness(film).membrane
    shares, loads = [], []
    for layer, stress, bending in zip(film.layers, own, bending_stresses(film), strict=True):
        if layer.strength is None:
            continue
        margin = xp.maximum(layer.strength - stress, _NONE)
        as_plate = bending * (1.0 + layer.poisson) * plate.load_curvature
        pulled = layer.modulus / membrane
        folded = pulled * tension + bending * fold_curvature(tension, plate.stiffness)
        folds_at = plate.perimeter * fold_tension(margin, pulled, bending, plate.stiffness)
        shares.append((stress + xp.minimum(as_plate * held.load, folded)) / layer.strength)
        loads.append(xp.maximum(margin / as_plate, folds_at) - held.load)
    return Shape(
        stress_over_strength=most(shares),
        curvature=bent.curl.largest,
        deflection=bent.rise,
        lift_kept=bent.lift_kept(tacs),
        bearable_load=_least_load(loads),
        lowest_frequency=plate.frequency(held),
    )


class Core(NamedTuple):
    """What holds two films apart."""

    shear: Numeric  # Shear stiffness of the whole [N/m]
    free_radius: Numeric  # Of the widest circle of film that it leaves free [m]
    spacing: Numeric  # Between its parts [m]
    root_moment: Numeric = 0.0  # In a film at a post's end, over the shear force [m]


def core_of_posts(
    ligaments: Ligaments, films: Sequence[Laminate], gap: Numeric, open_fraction: Numeric
) -> Core:
    """Posts between films with holes; these hold the posts' ends."""
    shear = ligament_shear_stiffness(ligaments, gap, *faces_of(films, open_fraction))
    return Core(shear, ligaments.free_radius, ligaments.spacing, root_moment(ligaments))


class BentSheets(NamedTuple):
    """Two films with holes, top and bottom, and what holds them apart."""

    films: Sequence[Laminate]
    temperatures: Sequence[Numeric]  # [K]
    core: Core
    gap: Numeric  # [m]
    open_fraction: Numeric
    radius: Numeric  # [m]

    @property
    def faces(self) -> list[Stiffness]:
        """Stiffness of both films with their holes."""
        return faces_of(self.films, self.open_fraction)

    @property
    def distance(self) -> Numeric:
        """Between the neutral heights of both films [m]."""
        top, bottom = self.faces
        thick = sum(layer.thickness for layer in self.films[1].layers)
        return self.gap + thick - bottom.neutral + top.neutral

    @property
    def whole(self) -> Stiffness:
        """Stiffness of both as one."""
        top, bottom = self.faces
        return sandwich_stiffness(top, bottom, self.distance)

    @property
    def arms(self) -> tuple[Numeric, Numeric]:
        """Heights of both over what bending does not strain [m]."""
        return self.distance - self.whole.neutral, -self.whole.neutral

    @property
    def tensions(self) -> list[Array]:
        """Of both, held flat [N/m]."""
        share = perforated_share(self.open_fraction)
        pairs = zip(self.films, self.temperatures, strict=True)
        return [share * flat_load(film, heat)[0] for film, heat in pairs]


def bent_sandwich(sheets: BentSheets, held: Held) -> Bent:
    """Two membranes that curl and carry as one."""
    whole, share = sheets.whole, perforated_share(sheets.open_fraction)
    moment = sum(
        share * flat_load(film, heat)[1] + tension * arm
        for film, heat, tension, arm in zip(
            sheets.films, sheets.temperatures, sheets.tensions, sheets.arms, strict=True
        )
    )
    curl = curl_of_film(moment / whole.bending, whole, sheets.radius)
    hold = xp.maximum(sheets.core.spacing, HOLD * sheets.radius)
    alone = sum(face.plate for face in sheets.faces)
    plate = hung(held, sheets.radius, hold, whole.plate, whole.poisson, sheets.core.shear, alone)
    return Bent(curl, plate, held.load)


def shape_of_sandwich(sheets: BentSheets, held: Held, pressure: Numeric) -> Shape:
    """Shape of two membranes; ``pressure``: of the lift, borne by either [Pa]."""
    bent, whole, core = bent_sandwich(sheets, held), sheets.whole, sheets.core
    plate, tensions = bent.plate, sheets.tensions
    mean = -sum(tensions) / whole.stretching
    carried = plate.load_curvature * held.load
    # force per width that shears the core where it carries
    inner = plate.ring / xp.asarray(sheets.radius)
    outward = 1.0 if plate.at_three_points else 1.0 - inner**2
    sheared = outward / plate.perimeter * core.root_moment
    shares, loads, closed, buckling = [], [], xp.zeros(()), xp.zeros(())
    for film, face, heat, arm, tension in zip(
        sheets.films, sheets.faces, sheets.temperatures, sheets.arms, tensions, strict=True
    ):
        strains = tuple(mean - curvature * arm for curvature in bent.curl)
        own = layer_stresses(film, heat, strains, tuple(bent.curl), sheets.open_fraction)
        at_posts = sheared / laminate_stiffness(film).plate  # where films have no holes
        for layer, stress, bending in zip(film.layers, own, bending_stresses(film), strict=True):
            if layer.strength is None:
                continue
            alike = layer.modulus / (1.0 - layer.poisson) * xp.abs(arm)
            alike = (alike + bending * (1.0 + layer.poisson)) * plate.load_curvature
            per_load = xp.maximum(
                tension_at_holes(alike, alike, sheets.open_fraction), bending * at_posts
            )
            shares.append((stress + per_load * held.load) / layer.strength)
            margin = xp.maximum(layer.strength - stress, _NONE)
            loads.append(margin / per_load - held.load)
        bowed = 0.5 * (strains[0] + strains[1])
        now = tension + face.stretching * bowed
        closed = closed + clamped_deflection(pressure, core.free_radius, face, now)
        pressed = face.stretching * xp.abs(carried * arm) - now
        buckling = xp.maximum(buckling, pressed / dimpling_load(core.free_radius, face))
    return Shape(
        stress_over_strength=most(shares),
        curvature=bent.curl.largest,
        deflection=bent.rise,
        gap_closed=closed / sheets.gap,
        load_over_buckling=buckling,
        lift_kept=bent.lift_kept(),
        bearable_load=_least_load(loads),
        lowest_frequency=plate.frequency(held),
    )


def faces_of(films: Sequence[Laminate], open_fraction: Numeric) -> list[Stiffness]:
    """Stiffness of films with holes."""
    share = perforated_share(open_fraction)
    whole = [laminate_stiffness(film) for film in films]
    return [Stiffness._make([*(share * part for part in one[:-1]), one[-1]]) for one in whole]


def most(shares: Sequence[Array]) -> Array:
    """The largest of some, NaN where there is none."""
    return reduce(xp.maximum, shares) if shares else xp.full((), np.nan)


def _least_load(loads: Sequence[Array]) -> Array:
    found = reduce(xp.minimum, loads) if loads else xp.full((), np.nan)
    return xp.maximum(found, 0.0)


OF_SHELLS = ("stress_over_strength", "load_over_buckling", "buckling_pressure")


class Wall(NamedTuple):
    """One film, or two of them apart, that curve around a body."""

    films: Sequence[Laminate]  # From outside in
    temperatures: Sequence[Numeric]  # [K]
    open_fraction: Numeric = 0.0
    distance: Numeric = 0.0  # Between the middles of two films [m]

    @property
    def stiffness(self) -> Stiffness:
        """Of the wall with its holes."""
        outer, *inner = faces_of(self.films, self.open_fraction)
        return sandwich_stiffness(outer, inner[0], self.distance) if inner else outer

    def stress_over_strength(self, tension: Numeric) -> Array:
        """Largest stress over strength under a tension alike in all directions [N/m]."""
        # A closed wall cannot curl: both films have one length.
        share = perforated_share(self.open_fraction)
        pairs = list(zip(self.films, self.temperatures, strict=True))
        own = sum(share * flat_load(film, heat)[0] for film, heat in pairs)
        strain, none = (tension - own) / self.stiffness.stretching, xp.zeros(())
        return most(
            [
                stress / layer.strength
                for film, heat in pairs
                for layer, stress in zip(
                    film.layers,
                    layer_stresses(film, heat, (strain,) * 2, (none,) * 2, self.open_fraction),
                    strict=True,
                )
                if layer.strength is not None
            ]
        )


def shape_of_sphere(
    wall: Wall,
    radius: Numeric,
    opening: Numeric | None,
    mass: Numeric,
    pressure: Numeric,
    gas_density: Numeric,
) -> Shape:
    """Shape of a sphere; ``opening``: radius of a hole with a free rim [m], None for none.

    ``mass``: of the wall [kg]; ``pressure``: within over that outside [Pa]; ``gas_density``: of
    the gas within and around [kg/m³].
    """
    stiffness = wall.stiffness
    buckles = sphere_buckling_pressure(radius, stiffness)
    density = mass / (4.0 * np.pi * radius**2)
    frequency = sphere_frequency(
        radius, density, stiffness.membrane, stiffness.poisson, gas_density
    )
    if opening is not None:
        buckles = xp.minimum(buckles, rim_buckling_pressure(radius, opening, stiffness.plate))
        bends = open_sphere_frequency(radius, opening, density, stiffness.plate, stiffness.poisson)
        frequency = 1.0 / xp.sqrt(1.0 / frequency**2 + 1.0 / bends**2)  # Dunkerley's rule
    found = _under_pressure(wall, 0.5 * pressure * radius, buckles, pressure)
    return found._replace(lowest_frequency=frequency)


def shape_of_tube(
    wall: Wall, radius: Numeric, length: Numeric, opening: Numeric, pressure: Numeric
) -> Shape:
    """Shape of a tube or cone with one open end; ``radius``: the mean across its side [m]."""
    stiffness = wall.stiffness
    buckles = xp.minimum(
        cylinder_buckling_pressure(radius, length, stiffness),
        rim_buckling_pressure(radius, opening, stiffness.plate),
    )
    return _under_pressure(wall, pressure * radius, buckles, pressure)


def _under_pressure(wall: Wall, tension: Numeric, buckles: Array, pressure: Numeric) -> Shape:
    return Shape(
        stress_over_strength=wall.stress_over_strength(tension),
        load_over_buckling=xp.maximum(-xp.asarray(pressure), 0.0) / buckles,
        buckling_pressure=buckles,
    )
