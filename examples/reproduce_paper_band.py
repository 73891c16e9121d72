"""The paper's main result: a 2-cm germanium-coated disk levitates in sunlight at 68-78 km."""

import lightflyer as lf

film = lf.FilmProperties(
    areal_density=1e-3,
    absorptance=0.75,
    emittance_top=0.08,
    emittance_bottom=0.08,
    tac_top=0.8,
    tac_bottom=0.9,
)
disk = lf.Disk(film, radius=0.01)
band = lf.levitation_band(disk, lf.lu2023_earth(), lf.Lu2023(), (60e3, 90e3))
lower, upper = band.lower / 1e3, band.upper / 1e3
print(f"levitates from {lower:.3f} km to {upper:.3f} km")
assert abs(lower - 68.022) < 5e-4
assert abs(upper - 78.047) < 5e-4
