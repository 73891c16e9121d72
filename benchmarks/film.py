"""Speed of film optics beside `tmm`, jaxlayerlumos and tmmax, in one run, as ratios.

Run: python -O benchmarks/film.py

jaxlayerlumos and tmmax are left out where they are not installed, and jaxlayerlumos without -O: it
asserts something of its arguments' values, which compiled code does not have. All compute in
float64 but tmmax, which computes in float32 only. What they compute is compared first.
"""

import importlib.util
import time

import jax
import jax.numpy as jnp
import numpy as np
import tmm

import lightflyer as lf
from lightflyer.film.optics.transfer_matrix import transfer

STACKS, LAYERS, WAVELENGTHS, ANGLES = 1000, 4, 400, 16
SAMPLE = 400  # calls of tmm that are timed; one per wavelength, angle and polarisation
FEW = 50  # stacks in a call of the gradient and of the peers
REPEATS = 3
SPEED_OF_LIGHT = 299792458.0

rng = np.random.default_rng(0)
WAVELENGTH = np.geomspace(0.4e-6, 15e-6, WAVELENGTHS)
INCIDENCE = np.arccos(np.linspace(0.05, 0.99, ANGLES))


def stacks():
    """n, k and thickness of random stacks, shapes (stacks, layers, w) and (stacks, layers)."""
    shape = (STACKS, LAYERS, WAVELENGTHS)
    n, k = rng.uniform(1.0, 4.0, shape), 10.0 ** rng.uniform(-4.0, 0.5, shape)
    return n, k, rng.uniform(1e-8, 1e-6, (STACKS, LAYERS))


def ours(n, k, d):
    """R and T, shape (2, angles, w)."""
    found = transfer(
        n[:, None], k[:, None], d[:, None, None], WAVELENGTH, INCIDENCE[:, None], inside=False
    )
    return found.reflectance, found.transmittance


def mean_absorptance(n, k, d):
    reflected, transmitted = ours(n, k, d)
    return jnp.mean(1.0 - reflected - transmitted)


def gradient(n, k, d):
    return jax.value_and_grad(mean_absorptance, argnums=(0, 1, 2))(n, k, d)


def by_jaxlayerlumos(n, k, d):
    """Its function of one point, mapped as it maps it itself: that mapping cannot be compiled."""
    from jaxlayerlumos.jaxlayerlumos import stackrt_eps_mu_base

    outside = jnp.ones((WAVELENGTHS, 1), complex)
    permittivity = jnp.concatenate([outside, ((n - 1j * k) ** 2).T, outside], axis=1)
    depth = jnp.concatenate([jnp.zeros(1), d, jnp.zeros(1)])
    frequency, angle = jnp.asarray(SPEED_OF_LIGHT / WAVELENGTH), jnp.asarray(INCIDENCE)
    along = jax.vmap(stackrt_eps_mu_base, (0, 0, None, 0, None))
    mapped = jax.vmap(along, (None, None, None, None, 0))
    found = mapped(permittivity, jnp.ones_like(permittivity), depth, frequency, angle)
    return jnp.stack([found[0], found[2]]), jnp.stack([found[1], found[3]])


def by_tmmax(n, k, d):
    """Its function of all angles and wavelengths, which interpolates indices in a table."""
    from tmmax.tmm import vectorized_coh_tmm

    wavelength = jnp.asarray(WAVELENGTH)
    table = jnp.stack(
        [jnp.stack([wavelength, one, other]) for one, other in zip(n, k, strict=True)]
    )
    vacuum = jnp.stack([wavelength, jnp.ones(WAVELENGTHS), jnp.zeros(WAVELENGTHS)])
    data = jnp.concatenate([vacuum[None], table])
    order = jnp.array([0, *range(1, LAYERS + 1), 0])
    found = [
        vectorized_coh_tmm(data, order, d, wavelength, jnp.asarray(INCIDENCE), jnp.array([p]))
        for p in (False, True)
    ]
    shares = [[part.reshape(ANGLES, WAVELENGTHS) for part in one] for one in found]
    return jnp.stack([one[0] for one in shares]), jnp.stack([one[1] for one in shares])


def over_stacks(function):
    """Compiled function of many stacks, worked through one after another."""
    return jax.jit(lambda *parts: jax.lax.map(lambda one: function(*one), parts))


def in_its_precision(name, function):
    """A function of arrays, in the precision that a package computes in."""
    if name != "tmmax":
        return function

    def single(*arrays):
        with jax.enable_x64(False):
            return function(*(jnp.asarray(np.asarray(one), jnp.float32) for one in arrays))

    return single


def per_stack(contenders):
    """Least time of some alternating runs, by the clock and of the processors [s per stack]."""
    for function, arguments in contenders.values():
        jax.block_until_ready(function(*arguments))
    times = {name: [] for name in contenders}
    for _ in range(REPEATS):
        for name, (function, arguments) in contenders.items():
            begin, used = time.perf_counter(), time.process_time()
            jax.block_until_ready(function(*arguments))
            spent = time.perf_counter() - begin, time.process_time() - used
            times[name].append(np.array(spent) / len(arguments[0]))
    return {name: np.min(found, axis=0) for name, found in times.items()}


def tmm_per_stack(n, k, d):
    """Time of tmm, which takes one wavelength, angle and polarisation a call [s per stack]."""
    index = [1.0, *(n[0, :, 0] + 1j * k[0, :, 0]), 1.0]
    thickness = [np.inf, *d[0], np.inf]
    begin, used = time.perf_counter(), time.process_time()
    for number in range(SAMPLE):
        tmm.coh_tmm("sp"[number % 2], index, thickness, INCIDENCE[number % ANGLES], 1e-6)
    calls = WAVELENGTHS * ANGLES * 2 / SAMPLE
    return np.array([time.perf_counter() - begin, time.process_time() - used]) * calls


def main():
    """Print the table."""
    n, k, d = stacks()
    peers = {"jaxlayerlumos": by_jaxlayerlumos, "tmmax": by_tmmax}
    peers = {name: one for name, one in peers.items() if importlib.util.find_spec(name)}
    if __debug__:
        peers.pop("jaxlayerlumos", None)
    theirs = tmm_per_stack(n, k, d)
    with lf.float64():
        many = tuple(jnp.asarray(values) for values in (n, k, d))
        few = tuple(values[:FEW] for values in many)
        contenders = {
            "lightflyer": (over_stacks(ours), many),
            "mean absorptance": (over_stacks(mean_absorptance), few),
            "its gradient in n, k and thickness": (over_stacks(gradient), few),
        }
        expected = jax.jit(ours)(*(values[0] for values in many))
        for name, peer in peers.items():
            contenders[name] = in_its_precision(name, over_stacks(peer)), few
            found = in_its_precision(name, jax.jit(peer))(*(values[0] for values in many))
            worst = max(
                float(np.abs(np.asarray(one) - np.asarray(other)).max())
                for one, other in zip(found, expected, strict=True)
            )
            print(f"largest difference of R and T from {name}: {worst:.1g}")
        times = {**per_stack(contenders), "tmm": theirs}
    plain = times["lightflyer"]
    print(f"stack of {LAYERS} layers, {WAVELENGTHS} wavelengths, {ANGLES} angles, 2 polarisations")
    print(f"{'[ms per stack]':36} {'clock':>9} {'CPU':>9}   ratio of clock, of CPU, to lightflyer")
    for name, spent in times.items():
        ratio = spent / plain
        print(
            f"{name:36} {spent[0] * 1e3:9.3f} {spent[1] * 1e3:9.3f} {ratio[0]:9.2f} {ratio[1]:9.2f}"
        )
    ratio = times["its gradient in n, k and thickness"] / times["mean absorptance"]
    print(f"gradient over its plain call: {ratio[0]:.2f} by the clock, {ratio[1]:.2f} of CPU")


if __name__ == "__main__":
    main()
