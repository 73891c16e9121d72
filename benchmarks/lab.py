"""Time and memory of the lab bench's readers and fits on files of a million rows.

    python benchmarks/lab.py

Each task runs in a process of its own, from the file to the record, as a user would run it.
"""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROWS = 1_000_000


def write_tac(path):
    """A run of a heater logged for very long."""
    from lightflyer.lab.tac.fit import heater_power

    rng = np.random.default_rng(0)
    pressure = np.exp(rng.uniform(np.log(1e-4), np.log(200.0), ROWS))
    heater, ambient = np.full(ROWS, 323.0), np.full(ROWS, 295.0)
    power = heater_power(pressure, heater, ambient, 0.75, 1.22, 4.09)
    power *= 1.0 + 0.01 * rng.normal(size=ROWS)
    heater += 0.05 * rng.normal(size=ROWS)
    header = "pressure [Pa],heater_power [W],heater_temperature [K],ambient_temperature [K]"
    np.savetxt(path, np.stack([pressure, power, heater, ambient], 1), "%.6g", ",",
               header=header, comments="")  # fmt: skip


def write_ftir(path):
    """A spectrum of very many points."""
    rng = np.random.default_rng(0)
    wavenumber = np.linspace(400.0, 4000.0, ROWS)
    value = 100.0 * (0.9 + 0.002 * rng.normal(size=ROWS))
    np.savetxt(path, np.stack([wavenumber, value], 1), "%.8g", ",",
               header="wavenumber [cm^-1],transmittance [%]", comments="")  # fmt: skip


TASKS = {
    "ftir": (write_ftir, "million.csv", ["ftir", "million.csv", "--out", "out"]),
    "tac": (write_tac, "million.csv", ["tac", "million.csv", "--out", "out"]),
}


def main():
    for name, (write, file, arguments) in TASKS.items():
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder, file))
            size = Path(folder, file).stat().st_size / 1e6
            start = time.perf_counter()
            command = [sys.executable, "-m", "lightflyer", "lab", *arguments]
            subprocess.run(command, cwd=folder, check=True, capture_output=True)
            seconds = time.perf_counter() - start
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(
            f"{name}: {ROWS} rows, {size:.0f} MB: {seconds:.1f} s, "
            f"{usage.ru_utime + usage.ru_stime:.1f} s of CPU so far, "
            f"{usage.ru_maxrss / 1e6:.2f} GB at most"
        )


if __name__ == "__main__":
    main()
