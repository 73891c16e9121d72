"""How published flyers hold their shape, and the size from which structure is the limit.

Writes ``flyers.json``, docs/images/structure.png and docs/images/structure-cut.png; three minutes.
"""

import dataclasses
import json
import math
import tempfile
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.film.media.library import MECHANICS, mechanics_of
from lightflyer.flyer.hanging import Held
from lightflyer.flyer.shape import BentSheets, Core, core_of_posts, shape_of_film, shape_of_sandwich
from lightflyer.structure import (
    Lamina,
    Laminate,
    Ligaments,
    laminate_stiffness,
    perforated_share,
    sandwich_stiffness,
)

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"
ROOM, GRAVITY = 293.15, 9.8
SAMPLES, SEED = 200, 0
DENSITY = {"Al2O3": 3000.0, "PET": 1390.0, "Ge": 5323.0, "Cr": 7150.0}
WARMER = 10.0  # [K] of the lower film of a sandwich, about that of levitation
FLAT, GAP_LEFT = 0.2, 0.5  # where a prediction warns: edge over radius, closed share of a gap
SPREAD = 0.68  # radius of the circle from which a payload hangs, over the flyer's
DIAMETERS = np.geomspace(2e-3, 1.0, 31)
PAYLOADS = np.geomspace(1e-3, 1e3, 91)  # over the flyer's own mass
BULK, ALUMINA_POISSON = 1.4e11, 0.24

FILMS = {  # layers, top to bottom, by name and thickness [m]
    "mylar": (("PET", 5e-7),),
    "germanium disk": (("Al2O3", 5e-8), ("Ge", 2e-8), ("PET", 5e-7), ("Ge", 2e-8)),
    "face": (("Al2O3", 1e-7),),
    "absorbing face": (("Al2O3", 1e-7), ("Cr", 1e-8)),
    "thin face": (("Al2O3", 5e-8),),
}


def draw(samples):
    """Mechanical numbers of each material, one error for all its layers; shape (samples, 1)."""
    generator, found = np.random.default_rng(SEED), {}
    for name in DENSITY:
        for number, value in mechanics_of(name).items():
            error = generator.standard_normal((samples, 1)) if samples else 0.0
            least = -np.inf if number in ("stress", "expansion") else 0.1 * value.value
            found[name, number] = np.maximum(value.value + value.uncertainty * error, least)
    return found


def laminate(name, numbers):
    """A film as a structure."""
    return Laminate([
        Lamina(thickness, **{key: numbers[material, key] for key in MECHANICS
                             if (material, key) in numbers})
        for material, thickness in FILMS[name]
    ])  # fmt: skip


def areal_density(name):
    """Of a film [kg/m²]."""
    return sum(DENSITY[material] * thickness for material, thickness in FILMS[name])


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of flyer: its films, what holds them apart, its template, and the size built."""

    films: tuple[str, ...]
    template: str
    built: float  # [m]
    reported: str
    posts: Ligaments | None = None
    walls: Core | None = None
    gap: float = 0.0
    open_fraction: float = 0.0
    core_density: float = 0.0  # [kg/m²]

    @property
    def density(self):
        """Areal density [kg/m²]."""
        solid = 1.0 - self.open_fraction
        return solid * sum(map(areal_density, self.films)) + self.core_density

    def shape(self, numbers, radius, payload, hanging=None, gravity=GRAVITY):
        """Shape with a payload over its own mass; ``hanging``: circle [m]."""
        own = self.density * math.pi * radius**2
        held = Held(own, payload * own, gravity, hanging)
        films = [laminate(name, numbers) for name in self.films]
        if len(films) == 1:
            return shape_of_film(films[0], radius, ROOM, held)
        core = self.walls
        if core is None:
            posts = dataclasses.replace(self.posts, modulus=numbers["Al2O3", "modulus"])
            core = core_of_posts(posts, films, self.gap, self.open_fraction)
        sheets = BentSheets(
            films, (ROOM, ROOM + WARMER), core, self.gap, self.open_fraction, radius
        )
        return shape_of_sandwich(sheets, held, (1.0 + payload) * self.density * gravity)

    def holds(self, numbers, radius, payload):
        """Whether it stays flat, whole and open with a payload that hangs from a circle."""
        found = self.shape(numbers, radius, payload, SPREAD * radius)
        flat = found.deflection <= FLAT * radius
        whole = ~(np.asarray(found.stress_over_strength) > 1.0)
        return np.asarray(flat & whole & ~(np.asarray(found.gap_closed) > GAP_LEFT))


POSTS = Ligaments(5e-4, 1e-5, 1e-7)  # the template's guess
GAP = 1.25e-4
# the nanocardboard of Cortes et al. (2020): rectangles of 50 µm by 500 µm, 50 µm apart, 50 µm high
WALL_SHARE, PLATE_HEIGHT, PLATE_OPEN = 2 * 5.5e-4 * 5e-8 / (1e-4 * 5.5e-4), 5e-5, 0.4545
SHEAR = 0.5 * WALL_SHARE * BULK / (2 * (1 + ALUMINA_POISSON)) * PLATE_HEIGHT
KINDS = {
    "mylar, 0.5 µm": Kind(("mylar",), "earth", 0.04, "levitated; thermal deformation when hot"),
    "germanium disk": Kind(("germanium disk",), "earth", 0.02, "levitated; curl not reported"),
    "sandwich on posts": Kind(
        ("face", "absorbing face"), "ligaments", 0.01, "levitated, made up to 3 cm wide",
        posts=POSTS, gap=GAP, open_fraction=0.5, core_density=3000.0 * float(POSTS.fraction) * GAP,
    ),
    "nanocardboard": Kind(
        ("thin face", "thin face"), "plate", 0.008, "levitated; made up to 1 cm wide",
        walls=Core(SHEAR, 2.5e-5, 5.5e-4), gap=PLATE_HEIGHT, open_fraction=PLATE_OPEN,
        core_density=3000.0 * WALL_SHARE * PLATE_HEIGHT,
    ),
}  # fmt: skip


def lifted(kind, folder):
    """Largest payload over own mass that the force lifts, at each diameter, where it is best."""
    text, found = templates()[kind.template].read(), []
    line = next(line for line in text.splitlines() if line.startswith("diameter"))
    for diameter in DIAMETERS:
        path = folder / "flyer.toml"
        path.write_text(text.replace(line, f'diameter = "{1e3 * diameter:g} mm"'), encoding="utf-8")
        setup = lf.read_flyer_file(path).build()
        found.append(lf.predict(setup).best.values["relative_payload"])
    return np.array(found)


def borne(kind, numbers):
    """The same that the structure holds; shape (samples, diameters)."""
    rows = []
    for diameter in DIAMETERS:
        holds = kind.holds(numbers, 0.5 * diameter, PAYLOADS)
        last = np.cumprod(np.atleast_2d(holds), axis=1).sum(axis=1)  # up to the first that fails
        rows.append(np.where(last > 0, PAYLOADS[np.maximum(last - 1, 0)], 0.0))
    return np.array(rows).T


def crossing(force, structure):
    """Diameter from which less is borne than lifted [m], infinite where force always ends first."""
    less = structure < force
    if not less.any():
        return math.inf
    first = int(np.argmax(less))
    if first == 0:
        return DIAMETERS[0]
    gap = np.log(np.maximum(structure, 0.5 * PAYLOADS[0])) - np.log(np.maximum(force, PAYLOADS[0]))
    way = gap[first - 1] / (gap[first - 1] - gap[first])
    return float(np.exp(np.interp(way, [0.0, 1.0], np.log(DIAMETERS[first - 1 : first + 1]))))


def centimetres(length):
    """A length in centimetres, None for one that is infinite."""
    return 1e2 * float(length) if math.isfinite(length) else None


def enhancements():
    """Bending stiffness over that of a solid plate of the same mass, of published panels."""
    found, numbers = {}, draw(0)
    for name, film, kind in (
        ("Lin et al. (2018), 50 nm, 50 µm", "thin face", KINDS["nanocardboard"]),
        ("sandwich of the template", "face", KINDS["sandwich on posts"]),
    ):
        one = laminate_stiffness(laminate(film, numbers))
        share = perforated_share(kind.open_fraction)
        plate = float(share * sandwich_stiffness(one, one, kind.gap).plate)
        solid = BULK * (kind.density / 3000.0) ** 3 / 12 / (1 - ALUMINA_POISSON**2)
        found[name] = {
            "stiffness [N m]": plate,
            "over a solid plate": plate / solid,
            "areal density [g/m²]": 1e3 * kind.density,
            "density [kg/m³]": kind.density / kind.gap,
        }
    return found


def plain(shape):
    """A shape of one flyer in plain numbers."""
    return {
        name: number if math.isfinite(number := float(np.ravel(value)[0])) else None
        for name, value in shape._asdict().items()
    }


def describe(kind, nominal, drawn):
    """The published size, carrying its own mass from a circle."""
    radius = 0.5 * kind.built
    found = plain(kind.shape(nominal, radius, 1.0, SPREAD * radius))
    own = kind.density * math.pi * radius**2
    empty = plain(kind.shape(nominal, radius, 0.0))
    bands = kind.shape(drawn, radius, 1.0, SPREAD * radius)
    edge = np.ravel(np.asarray(bands.deflection)) / radius
    return {
        "areal density [g/m²]": 1e3 * kind.density,
        "built [cm]": 1e2 * kind.built,
        "curvature [1/m]": found["curvature"],
        "edge over radius": found["deflection"] / radius,
        "95 % band of that": [float(end) for end in np.percentile(edge, (2.5, 97.5))],
        "stress over strength": found["stress_over_strength"],
        "gap closed": found["gap_closed"],
        "compression over buckling": found["load_over_buckling"],
        "lowest frequency [Hz]": found["lowest_frequency"],
        "bears, held in its middle [g]": empty["bearable_load"] / own / GRAVITY,
        "reported": kind.reported,
    }


def draw_cut():
    """The template's sandwich with half a milligram at one place, on a circle, at three points."""
    text = templates()["ligaments"].read()
    figure = plot.new_figure(columns=1, rows=3, height=6.0)
    for ax, (title, keys) in zip(
        figure.axes,
        {
            "0.5 mg in the middle": "",
            "0.5 mg on a circle": 'hanging_radius = "6.8 mm"',
            "0.5 mg at three points": 'hanging_radius = "6.8 mm"\nhanging = "three points"',
        }.items(),
        strict=True,
    ):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "flyer.toml"
            loaded = text.replace('payload = "0 mg" ', f'payload = "0.5 mg"\n{keys}\n#', 1)
            path.write_text(loaded, encoding="utf-8")
            lf.predict(lf.read_flyer_file(path).build()).plot("shape", ax)
        ax.set_title(title)
    plot.save(figure, [IMAGES / "structure-cut.png"])


def main():
    """Compute everything and draw."""
    draw_cut()
    found = {}
    figure = plot.new_figure(columns=2, rows=2, height=6.4)
    with lf.float64(), tempfile.TemporaryDirectory() as folder:
        nominal, drawn = draw(0), draw(SAMPLES)
        for ax, (name, kind) in zip(figure.axes, KINDS.items(), strict=True):
            force = lifted(kind, Path(folder))
            middle, many = borne(kind, nominal)[0], borne(kind, drawn)
            limits = [crossing(force, row) for row in many]
            found[name] = describe(kind, nominal, drawn) | {
                "structure is the limit from [cm]": centimetres(crossing(force, middle)),
                "95 % band [cm]": [
                    centimetres(end) for end in np.percentile(limits, (2.5, 97.5), method="nearest")
                ],
            }
            band = np.percentile(many, (2.5, 97.5), axis=0)
            ax.plot(1e2 * DIAMETERS, force, color=palette.BLUE, label="lifted by the gas")
            shown = np.maximum(middle, 1e-9)
            ax.plot(1e2 * DIAMETERS, shown, color=palette.VERMILION, ls="--",
                    label="held by its structure")  # fmt: skip
            ax.fill_between(1e2 * DIAMETERS, *np.maximum(band, 1e-9), color=palette.VERMILION,
                            alpha=0.2, lw=0, label=plot.BAND)  # fmt: skip
            ax.axvline(1e2 * kind.built, color=palette.GREY, ls=":", label="built")
            ax.set(xscale="log", yscale="log", xlabel="diameter [cm]", title=name,
                   ylim=(1e-2, 1e3), xlim=1e2 * DIAMETERS[[0, -1]],
                   ylabel="payload over own mass")  # fmt: skip
            plot.plain_decades(ax.xaxis)
            plot.plain_decades(ax.yaxis)
        found["stiffness"] = enhancements()
    plot.shared_legend(figure, figure.axes[0].get_legend_handles_labels()[0])
    plot.save(figure, [IMAGES / "structure.png"])
    (HERE / "flyers.json").write_text(
        json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8"
    )


if __name__ == "__main__":
    main()
