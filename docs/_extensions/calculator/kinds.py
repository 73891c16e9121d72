"""Kinds of flyers that the calculator has, and the numbers of each that a reader may change."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number that a reader may change.

    Attributes
    ----------
    name : str
        As in a design; ``altitude`` or ``pressure`` for the coordinate.
    label : str
    unit : str
        As a flyer file has it, empty for a pure number.
    low, high : float
        Ends of its slider, in the unit.
    digits : int
        Digits after the point of one step.
    logarithmic : bool
        Whether the slider is.
    computed : bool
        Whether results depend on it; a limit and a correlation change none.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    digits: int = 2
    logarithmic: bool = False
    computed: bool = True


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of flyer in some surroundings.

    Attributes
    ----------
    name : str
        Of its page and script.
    title : str
    template : str
        Of ``lightflyer init``.
    groups : dict
        Numbers by the heading that they stand under.
    start : float
        Coordinate to start from, in its unit.
    mass : str
        Unit of payloads and masses.
    lights : tuple of float
        Ends of the axis of irradiance [W/m²].
    assumed : str
        What flyer this is, in a sentence.
    another : tuple of str
        Another design to look at: what its link says, and its numbers in an address. May be empty.
    """

    name: str
    title: str
    template: str
    groups: dict[str, tuple[Number, ...]]
    start: float
    mass: str
    lights: tuple[float, float]
    assumed: str
    another: tuple[str, str] | tuple[()] = ()

    @property
    def numbers(self) -> tuple[Number, ...]:
        """All numbers."""
        return tuple(number for group in self.groups.values() for number in group)

    @property
    def computed(self) -> tuple[Number, ...]:
        """Arguments of the compiled functions, in order."""
        return tuple(number for number in self.numbers if number.computed)

    @property
    def coordinate(self) -> Number:
        """Along which the flyer is looked at."""
        return next(one for one in self.numbers if one.name in ("altitude", "pressure"))

    @property
    def size(self) -> Number:
        """Size of the flyer."""
        return next(one for one in self.numbers if one.name in ("flyer.diameter", "flyer.size"))

    @property
    def payload(self) -> Number:
        """What the flyer carries."""
        return next(one for one in self.numbers if one.name == "flyer.payload")

    @property
    def limits(self) -> tuple[str, ...]:
        """Names of the temperatures that films withstand."""
        return tuple(one.name for one in self.numbers if one.name.endswith("highest_temperature"))


def _film(part: str, *faces: str, through: bool = False, named: str = "") -> tuple[Number, ...]:
    """Numbers of a film in a section; faces are those whose accommodation matters."""
    of = f", {named} film" if named else ""
    transmittance = Number(f"{part}.transmittance", f"transmittance{of}", "", 0.0, 1.0)
    return (
        Number(f"{part}.areal_density", f"areal density{of}", "g/m^2", 0.05, 20.0, 3,
               logarithmic=True),
        Number(f"{part}.absorptance", f"absorptance for sunlight{of}", "", 0.01, 1.0),
        *([transmittance] if through else []),
        Number(f"{part}.emittance_top", f"emittance, top{of}", "", 0.01, 1.0),
        Number(f"{part}.emittance_bottom", f"emittance, bottom{of}", "", 0.01, 1.0),
        *(
            Number(f"{part}.tac_{face}", f"accommodation coefficient (TAC), {face}{of}", "", 0.3,
                   1.0)
            for face in faces
        ),
        Number(f"{part}.highest_temperature", f"temperature it withstands{of}", "K",
               300.0, 1500.0, 0, computed=False),
    )  # fmt: skip


_CARRIED = Number("flyer.payload", "payload carried", "mg", 0.0, 10.0, 2)
_ALTITUDE = Number("altitude", "altitude", "km", 20.0, 120.0, 1)
_PRESSURE = Number("pressure", "pressure", "Pa", 0.1, 1000.0, 3, logarithmic=True)
_DIAMETER = Number("flyer.diameter", "diameter", "cm", 0.1, 20.0, 3, logarithmic=True)
_IRRADIANCE = Number("environment.irradiance", "irradiance of the beam", "W/m^2", 0.0, 5000.0, 0)
_INCIDENCE = Number("environment.incidence", "beam from the vertical", "deg", 0.0, 85.0, 0)
_AROUND = (
    _IRRADIANCE,
    _INCIDENCE,
    Number("environment.albedo", "albedo below", "", 0.0, 1.0),
    Number("environment.infrared_bottom", "heat radiation from below", "W/m^2", 0.0, 400.0, 0),
    Number("environment.infrared_top", "heat radiation from above", "W/m^2", 0.0, 400.0, 0),
)
_LIGHT = "Light and heat around"
_CORRELATION = Number("film.tac_correlation", "correlation of the errors of both TACs", "", -1.0,
                      1.0, computed=False)  # fmt: skip
_DISK = {
    "Flyer": (_DIAMETER, _CARRIED, _ALTITUDE),
    "Film": (*_film("film", "top", "bottom"), _CORRELATION),
}
_SMALL_LIGHT, _STRONG_LIGHT = (100.0, 1e4), (100.0, 1e5)

KINDS = (
    Kind(
        "disk", "Disk over Earth", "laden", {**_DISK, _LIGHT: _AROUND},
        76.0, "mg", _SMALL_LIGHT, "a level, flat, thin disk of one temperature",
        ("Try the 2-cm germanium disk at 80 km", "flyer.diameter=2&flyer.payload=0&altitude=80"),
    ),
    Kind(
        "mars", "Disk over Mars", "mars",
        {**_DISK, _LIGHT: (
            *_AROUND,
            Number("environment.dust_optical_depth", "optical depth of dust", "", 0.0, 5.0),
        )},
        60.0, "mg", _SMALL_LIGHT, "a level, flat, thin disk of one temperature",
    ),
    Kind(
        "chamber", "Disk in a chamber", "chamber",
        {
            "Flyer": (_DIAMETER, _CARRIED, _PRESSURE),
            "Film": _DISK["Film"],
            _LIGHT: (
                Number("environment.irradiance", "irradiance of the lamp", "W/m^2", 0.0, 1e4, 0),
                _INCIDENCE,
                Number("environment.temperature", "temperature of gas and walls", "K", 200.0,
                       400.0, 0),
            ),
        },
        4.0, "mg", _SMALL_LIGHT, "a level, flat, thin disk of one temperature, far from the walls",
    ),
    Kind(
        "sandwich", "Sandwich", "sandwich",
        {
            "Flyer": (
                _DIAMETER, _CARRIED, _ALTITUDE,
                Number("flyer.gap", "gap", "um", 1.0, 5000.0, 3, logarithmic=True),
                Number("flyer.open_fraction", "share that is holes", "", 0.0, 0.95),
                Number("flyer.support_fraction", "share that supports take", "", 1e-6, 1e-2, 6,
                       logarithmic=True),
            ),
            "Upper film": _film("flyer.top", "bottom", through=True, named="upper"),
            "Lower film": _film("flyer.bottom", "top", named="lower"),
            _LIGHT: _AROUND,
        },
        75.0, "mg", (10.0, 1e4), "a level sandwich of two films, each of one temperature",
    ),
    Kind(
        "plate", "Nanocardboard plate", "plate",
        {
            "Flyer": (
                Number("flyer.diameter", "diameter", "mm", 1.0, 100.0, 3, logarithmic=True),
                _CARRIED, _PRESSURE,
                Number("flyer.channel_width", "width of channels", "um", 5.0, 1000.0, 3,
                       logarithmic=True),
                Number("flyer.spacing", "film between channels", "um", 1.0, 1000.0, 3,
                       logarithmic=True),
                Number("flyer.height", "height", "um", 5.0, 2000.0, 3, logarithmic=True),
                Number("flyer.wall_thickness", "thickness of walls", "nm", 5.0, 1000.0, 3,
                       logarithmic=True),
            ),
            "Upper film": _film("flyer.top", "top", "bottom", through=True, named="upper"),
            "Lower film": _film("flyer.bottom", "top", "bottom", named="lower"),
            _LIGHT: (
                Number("environment.irradiance", "irradiance of the lamp", "kW/m^2", 0.0, 50.0, 2),
                _INCIDENCE,
                Number("environment.temperature", "temperature of gas and walls", "K", 200.0,
                       400.0, 0),
            ),
        },
        30.0, "mg", _STRONG_LIGHT, "a level plate of two films, each of one temperature",
    ),
    Kind(
        "hollow", "Hollow sphere", "hollow",
        {
            "Flyer": (
                Number("flyer.size", "diameter", "cm", 1.0, 1000.0, 3, logarithmic=True),
                Number("flyer.payload", "payload carried", "mg", 0.0, 1000.0, 1), _ALTITUDE,
                Number("flyer.outlet_diameter", "outlet", "cm", 0.5, 800.0, 3, logarithmic=True),
                Number("flyer.open_fraction", "share that is channels", "", 0.05, 0.95),
                Number("flyer.channel_width", "width of channels", "mm", 0.01, 10.0, 3,
                       logarithmic=True),
                Number("flyer.wall_thickness", "thickness of the wall", "mm", 0.05, 20.0, 3,
                       logarithmic=True),
                Number("flyer.sheet_thickness", "thickness of sheets", "nm", 5.0, 500.0, 3,
                       logarithmic=True),
            ),
            "Outer film": _film("flyer.outer", "top", "bottom", through=True, named="outer"),
            "Inner film": _film("flyer.inner", "top", named="inner"),
            _LIGHT: _AROUND,
        },
        73.0, "mg", _SMALL_LIGHT, "a hollow sphere with its outlet below",
    ),
    Kind(
        "balloon", "Solar balloon", "balloon",
        {
            "Flyer": (
                Number("flyer.diameter", "diameter", "m", 1.0, 50.0, 3, logarithmic=True),
                Number("flyer.payload", "payload carried", "kg", 0.0, 100.0, 2),
                Number("altitude", "altitude", "km", 1.0, 50.0, 1),
            ),
            "Film": _film("film", through=True),
            _LIGHT: _AROUND,
        },
        15.0, "kg", (1.0, 1e4), "an open balloon of one temperature",
    ),
    Kind(
        "particle", "Particle", "particle",
        {
            "Particle": (
                Number("flyer.diameter", "diameter", "um", 0.1, 100.0, 3, logarithmic=True),
                Number("flyer.payload", "payload carried", "pg", 0.0, 1000.0, 1),
                Number("altitude", "altitude", "km", 10.0, 120.0, 1),
                Number("flyer.density", "density", "g/cm^3", 0.01, 20.0, 3, logarithmic=True),
                Number("flyer.conductivity", "thermal conductivity", "W/(m*K)", 0.01, 400.0, 3,
                       logarithmic=True),
                Number("flyer.mass_offset", "middle to centre of mass", "nm", 0.1, 1e4, 3,
                       logarithmic=True),
            ),
            "Surface": (
                Number("flyer.absorption_efficiency", "absorption efficiency", "", 0.01, 3.0),
                Number("flyer.emittance", "emittance", "", 0.01, 1.0),
                Number("flyer.infrared_asymmetry", "asymmetry of heat radiation, J₁", "", -0.5,
                       0.5),
                Number("flyer.tac_top", "accommodation coefficient (TAC), top", "", 0.3, 1.0),
                Number("flyer.tac_bottom", "accommodation coefficient (TAC), bottom", "", 0.3,
                       1.0),
            ),
            _LIGHT: _AROUND,
        },
        60.0, "pg", (10.0, 1e5), "a sphere that gravity holds upright as well as molecules let it",
    ),
)  # fmt: skip
"""All kinds, the first one that of the front page."""

DISK = KINDS[0]
