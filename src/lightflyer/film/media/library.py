"""The materials that the package knows: pages of n and k, densities and TACs, with their sources.

The pages are those of the refractiveindex.info database ([Polyanskiy2024]_, CC0).
"""

import dataclasses
import difflib

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import load_plugins
from lightflyer.core.units import Measured
from lightflyer.film.media.medium import Medium


@dataclasses.dataclass(frozen=True)
class Page:
    """A page of the database, or the part of it in use."""

    shelf: str
    book: str
    page: str
    shortest_um: float = 0.0  # Limits of use within the page's own range [µm]
    longest_um: float = np.inf


@dataclasses.dataclass(frozen=True)
class Entry:
    """Pages, density and measured TAC of a material."""

    description: str
    pages: tuple[Page, ...]  # In order of wavelength
    density: float | None  # [kg/m³]
    density_source: str
    tac: Measured | None = None  # Measured thermal accommodation coefficient [1]
    # Temperature at which a film of it melts or loses its shape [K]
    highest_temperature: float | None = None
    # Volume fraction of the pages' medium as a mat of needles in vacuum; None where it is all [1]
    mat_fraction: float | None = None
    remark: str = ""  # What results must say of it


TAC_SOURCE = "measured in air, Lu et al. (2023), table 1; alumina: text on TACs [Lu2023]"

_CRC = "CRC Handbook of Chemistry and Physics, 95th ed. [CRC2014]"
_GE_BULK = f"crystal, {_CRC}; evaporated films are up to about 10 % lighter"

# Highest temperatures are melting points by [CRC2014]; that of PET is by [DuPontTeijin2003], that
# of polyimide the onset of its glass transition by [DuPont2006].
PAGES: dict[str, Entry] = {
    "Ge": Entry(
        "germanium, evaporated 0.42-µm film (amorphous)",
        (Page("main", "Ge", "Amotchkina-film"),),
        5323.0,
        _GE_BULK,
        Measured(0.90, 0.03),
        highest_temperature=1211.0,
    ),
    "Ge-20nm": Entry(
        "germanium, evaporated 20-nm film on silica",
        (Page("main", "Ge", "Ciesielski-20nm"),),
        5323.0,
        _GE_BULK,
        Measured(0.90, 0.03),
        highest_temperature=1211.0,
    ),
    "Ge-crystal": Entry(
        "germanium crystal",
        (
            Page("main", "Ge", "Nunley"),
            Page("main", "Ge", "Amotchkina", shortest_um=2.5),
        ),
        5323.0,
        _CRC,
        highest_temperature=1211.0,
    ),
    "PET": Entry(
        "polyethylene terephthalate (mylar)",
        (Page("organic", "polyethylene_terephthalate", "Zhang"),),
        1390.0,
        "Mylar polyester film, DuPont Teijin Films data sheet H-37232 [DuPontTeijin2003]",
        Measured(0.77, 0.03),
        highest_temperature=527.0,
    ),
    # beyond what was measured (58.4 nm to 43 µm) the page holds the authors' extrapolations
    "Al2O3": Entry(
        "alumina film by plasma-enhanced atomic layer deposition at 300 °C",
        (Page("main", "Al2O3", "Rodriguez_de_Marcos", shortest_um=0.0584, longest_um=43.0),),
        3000.0,
        "film deposited at 177 °C [Groner2004]",
        Measured(0.79, 0.03),
        highest_temperature=2327.0,
    ),
    "Au": Entry(
        "gold, evaporated",
        (Page("main", "Au", "Olmon-ev"),),
        19_300.0,
        _CRC,
        highest_temperature=1337.0,
    ),
    "Ag": Entry(
        "silver, template-stripped",
        (Page("main", "Ag", "Yang"),),
        10_500.0,
        _CRC,
        highest_temperature=1235.0,
    ),
    "Al": Entry(
        "aluminium, evaporated",
        (Page("main", "Al", "Rakic"),),
        2700.0,
        _CRC,
        highest_temperature=933.0,
    ),
    "Cr": Entry(
        "chromium: measurements from several sources, fitted by Brendel and Bormann's model",
        (Page("main", "Cr", "Rakic-BB"),),
        7150.0,
        _CRC,
        highest_temperature=2180.0,
    ),
    "Si": Entry(
        "silicon crystal, 300 K",
        (Page("main", "Si", "Franta-300K"),),
        2329.6,
        _CRC,
        highest_temperature=1687.0,
    ),
    "a-Si": Entry(
        "amorphous silicon, 60-nm film",
        (Page("main", "Si", "Pierce"),),
        2285.0,
        "1.8 % below the crystal [Custer1994]",
    ),
    "GaAs": Entry(
        "gallium arsenide",
        (
            Page("main", "GaAs", "Papatryfonos", longest_um=0.895),
            Page("main", "GaAs", "Franta-300K"),
        ),
        5317.6,
        _CRC,
        highest_temperature=1511.0,
    ),
    "SiO2": Entry(
        "silica, evaporated film", (Page("main", "SiO2", "Franta-25C"),), 2200.0, f"glass, {_CRC}"
    ),
    "polyimide": Entry(
        "polyimide (Kapton)",
        (Page("other", "Kapton", "French"), Page("other", "Kapton", "Zhang")),
        1420.0,
        "Kapton HN, DuPont data sheet H-38492 [DuPont2006]",
        highest_temperature=633.0,
    ),
    "a-C": Entry(
        "amorphous carbon, arc-evaporated film",
        (Page("main", "C", "Arakawa"),),
        None,
        "1.8 to 2.1 g/cm³, depending on the deposition: give the sample's",
    ),
    "ta-C": Entry(
        "tetrahedral amorphous carbon film",
        (Page("main", "C", "Larruquert"),),
        3250.0,
        "the same film as the index [Larruquert2013]",
    ),
    "graphite": Entry("pyrolytic graphite", (Page("main", "C", "Querry-Pyrolytic"),), 2200.0, _CRC),
    "SWCNT": Entry(
        "single-walled carbon nanotube film, aerosol CVD (porous)",
        (Page("main", "C", "Ermolaev"),),
        None,
        "porous, different in every film: give the sample's",
        Measured(1.08, 0.05),
    ),
    # studies/nanotube_film: fraction and pellet that absorb and emit as the film of [Lu2023]
    "CNT-mat": Entry(
        "model of a mat of carbon nanotubes: needles of graphite (Micro 260) in the film's "
        "plane, 30 % by volume, which absorb and emit as the nanotube film of [Lu2023]",
        (Page("main", "C", "Querry-AsburyMicro260"),),
        660.0,
        f"30 % of graphite, {_CRC}",
        Measured(1.08, 0.05),
        mat_fraction=0.30,
        remark="CNT-mat is a model: n and k of graphite needles in vacuum, along the film's plane; "
        "its one number, 30 % by volume, is fitted to one film of [Lu2023]",
    ),
}
"""Materials by their name in a flyer file."""

MEDIA: dict[str, Medium] = {}
"""Further ones, which plug-ins add."""

VACUUM = "vacuum"  # Name of empty space, as a part of mixtures

ALIASES = {
    "germanium": "Ge",
    "mylar": "PET",
    "alumina": "Al2O3",
    "gold": "Au",
    "silver": "Ag",
    "aluminium": "Al",
    "aluminum": "Al",
    "chromium": "Cr",
    "silicon": "Si",
    "amorphous silicon": "a-Si",
    "silica": "SiO2",
    "kapton": "polyimide",
    "amorphous carbon": "a-C",
    "CNT": "SWCNT",
    "nanotube mat": "CNT-mat",
    "air": VACUUM,
    "void": VACUUM,
}
"""Other names of the same materials."""


def canonical_name(name: str) -> str:
    """Name of a material in the library, from any of its names in any case."""
    name = " ".join(name.split())
    load_plugins()
    known = {alias.lower(): target for alias, target in ALIASES.items()}
    known |= {target.lower(): target for target in (*PAGES, VACUUM, *MEDIA)}
    if name.lower() in known:
        return known[name.lower()]
    near = difflib.get_close_matches(name.lower(), known, n=3, cutoff=0.5)
    names = list(dict.fromkeys(known[match] for match in near))
    hint = f"did you mean {' or '.join(names)}?" if names else f"the library has {', '.join(PAGES)}"
    raise ParameterError(
        f'material "{name}" is unknown; {hint} (or give a page of refractiveindex.info, as '
        "lightflyer materials --search lists them, or a CSV file of n and k)"
    )
