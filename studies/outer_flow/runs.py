"""Cases of OpenFOAM: their files, their runs until the force stands still, what they found.

Lengths are in radii of the disk. Velocities are in that of the gas through the disk, or, around a
warm disk, in the velocity U = √(g a ΔT/T) of gas that rises by a radius.
"""

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import mesh as wedge
import numpy as np

HERE = Path(__file__).parent
ENVIRONMENT = "/usr/share/openfoam/etc/bashrc"  # of Debian's package
STEADY = 1e-5  # relative change of the force over a chunk of iterations
CHUNK, MOST_CHUNKS = 150, 60
PRANDTL = 0.71  # of air


@dataclass(frozen=True)
class Pumped:
    """Gas at rest but for what a disk pumps.

    Attributes
    ----------
    reynolds : float
        ρ a u/μ, with the velocity u of the gas through the disk and the disk's radius a.
    mesh : Mesh
    """

    template = "case"
    reynolds: float
    mesh: wedge.Mesh

    @property
    def settings(self):
        """What the template leaves open; convection needs more relaxation."""
        if self.reynolds <= 300.0:
            velocity = float(np.interp(np.log10(self.reynolds), [-1, 1, 2.5], [0.99, 0.97, 0.8]))
            relaxed = {"consistent": "yes", "relax_p": 1.0, "relax_u": round(velocity, 3)}
        else:
            relaxed = {"consistent": "no", "relax_p": 0.3, "relax_u": 0.7}
        return {"viscosity": f"{1.0 / self.reynolds:.10g}", **relaxed}

    @property
    def scale(self):
        """Force in the run over that over μ a u."""
        return self.reynolds


@dataclass(frozen=True)
class Warm:
    """A disk that is warmer than the gas by ΔT and pumps; Boussinesq's approximation.

    Attributes
    ----------
    grashof : float
        g a³ ρ² ΔT/(T μ²), the square of ρ a U/μ.
    pumped : float
        Velocity of the gas through the disk over U.
    mesh : Mesh
    """

    template = "warm"
    grashof: float
    pumped: float
    mesh: wedge.Mesh
    scale = 1.0 / np.pi  # to a force over ρ U² π a²

    @property
    def settings(self):
        """What the template leaves open."""
        viscosity = self.grashof**-0.5
        return {
            "viscosity": f"{viscosity:.10g}",
            "diffusivity": f"{viscosity / PRANDTL:.10g}",
            "pumped": self.pumped,
            "consistent": "no",
            "relax_p": 0.3,
            "relax_u": 0.7,
        }


def prepare(case, folder):
    """Write a case; returns the area of a face of the disk in its mesh."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(HERE / case.template, folder)
    values = {"iterations": CHUNK, **case.settings}
    for path in (path for path in folder.rglob("*") if path.is_file()):
        text = path.read_text("utf-8")
        for name, value in values.items():
            text = text.replace(f"@{name}@", str(value))
        path.write_text(text, "utf-8")
    return wedge.write(case.mesh, folder / "constant" / "polyMesh")


def run(case, folder):
    """Force over its scale, pressure's share of it, and how much it changed in the end."""
    scale = np.pi / prepare(case, folder) * case.scale
    found = [np.array([np.inf, np.inf])]
    for chunk in range(1, MOST_CHUNKS + 1):
        set_end(folder, chunk * CHUNK)
        solve(folder)
        found.append(scale * read_force(folder))
        change = abs(found[-1][0] / found[-2][0] - 1.0)
        if change < STEADY:
            break
    total, pressure = found[-1]
    return {
        "coefficient": float(total),
        "pressure": float(pressure),
        "change": float(change),
        "iterations": chunk * CHUNK,
    }


def set_end(folder, iteration):
    """Where the next chunk of iterations ends."""
    path = folder / "system" / "controlDict"
    path.write_text(re.sub(r"endTime( +)\d+", rf"endTime\g<1>{iteration}", path.read_text()))


def solve(folder):
    """Run simpleFoam to the end time; its log is beside the case."""
    constant = folder / "0" / "Cp"  # read with each start, but not written
    if constant.exists():
        start = newest_time(folder)
        if start != constant.parent:
            shutil.copy(constant, start)
    command = f". {ENVIRONMENT} > /dev/null 2>&1; nice -n 19 simpleFoam -case '{folder}'"
    with (folder / "log").open("a") as log:
        subprocess.run(["bash", "-c", command], stdout=log, stderr=log, check=True)


def read_force(folder):
    """Total and pressure's force on the disk along z, over ρ u² a², in the wedge."""
    newest = max(folder.glob("postProcessing/forces/*/force*.dat"), key=_start)
    last = newest.read_text("utf-8").splitlines()[-1]
    values = np.array(re.sub(r"[()]", " ", last).split(), float)
    return values[[3, 6]]


def _start(path):
    return float(path.parent.name), path.name


def newest_time(folder):
    """Folder of the fields of the last iteration."""
    times = (path for path in folder.iterdir() if path.name.isdigit())
    return max(times, key=lambda path: int(path.name))


def internal_field(folder, name):
    """Values of a scalar field of the last iteration, in cells or on inner faces."""
    text = (newest_time(folder) / name).read_text("utf-8")
    pattern = r"internalField\s+nonuniform List<scalar>\s+\d+\s*\(([^)]*)\)"
    return np.array(re.search(pattern, text).group(1).split(), float)


def heat_loss(folder, mesh):
    """Heat that a warm disk gives to the gas, over κ a ΔT: 8 by conduction alone."""
    warmth = internal_field(folder, "T").reshape(mesh.around, mesh.outward)[:, 0]
    xi, eta = mesh.coordinates()
    slope = (1.0 - warmth) / (0.5 * (xi[1] - xi[0]))
    # q dA = κ ∂T/∂ξ 2π cos η dη on the disk
    return float(2.0 * np.pi * np.sum(slope * np.diff(np.sin(eta))))


def streamfunction(folder, mesh):
    """Stokes' stream function at the mesh's points, from the fluxes through its faces.

    Returns
    -------
    array, shape (3, outward + 1, around + 1)
        r, z and ψ: the upward flux through the circle about the axis through a point, over 2π.
    """
    many, around = mesh.outward, mesh.around
    flux = iter(internal_field(folder, "phi"))
    upward = np.zeros((many, around + 1))  # through faces of constant η
    for j in range(around):
        for i in range(many):
            if i + 1 < many:
                next(flux)  # of constant ξ, not needed
            if j + 1 < around:
                upward[i, j + 1] = next(flux)
    xi, eta = mesh.coordinates()
    psi = np.empty((many + 1, around + 1))
    psi[0] = -0.5 * np.cos(eta) ** 2  # gas goes down through the disk
    psi[1:] = psi[0] + np.cumsum(upward, axis=0) / wedge.WEDGE
    radius = np.cosh(xi)[:, None] * np.cos(eta)[None, :]
    height = np.sinh(xi)[:, None] * np.sin(eta)[None, :]
    return np.array([radius, height, psi])
