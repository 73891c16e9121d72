"""Speed of film optics beside the `tmm` package, in one run, as ratios.

Run: python benchmarks/film.py
"""

import time

import jax
import jax.numpy as jnp
import numpy as np
import tmm

import lightflyer as lf
from lightflyer.film.transfer_matrix import transfer

STACKS, LAYERS, WAVELENGTHS, ANGLES = 1000, 4, 400, 16
SAMPLE = 400  # calls of tmm that are timed; one per wavelength, angle and polarisation
GRADIENT_STACKS = 50


def timed(function, *arguments, repeats=3):
    """Best of a few runs after a first that compiles [s]."""
    jax.block_until_ready(function(*arguments))
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        jax.block_until_ready(function(*arguments))
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


def main():
    """Print the table."""
    rng = np.random.default_rng(0)
    shape = (STACKS, LAYERS, WAVELENGTHS)
    n, k = rng.uniform(1.0, 4.0, shape), 10.0 ** rng.uniform(-4.0, 0.5, shape)
    d = rng.uniform(1e-8, 1e-6, (STACKS, LAYERS))
    wavelength = np.geomspace(0.4e-6, 15e-6, WAVELENGTHS)
    incidence = np.arccos(np.linspace(0.05, 0.99, ANGLES))

    def optics(n, k, d):
        found = transfer(n[:, None], k[:, None], d[:, None, None], wavelength, incidence[:, None])
        return found.reflectance, found.transmittance

    def mean_absorptance(n, k, d):
        reflected, transmitted = optics(n, k, d)
        return jnp.mean(1.0 - reflected - transmitted)

    with lf.float64():
        n, k, d = (jnp.asarray(values) for values in (n, k, d))
        batched = jax.jit(lambda *stack: jax.lax.map(lambda one: optics(*one), stack, batch_size=4))
        ours = timed(batched, n, k, d, repeats=2) / STACKS
        few = tuple(values[:GRADIENT_STACKS] for values in (n, k, d))
        plain = jax.jit(lambda *s: jax.lax.map(lambda one: mean_absorptance(*one), s))
        slope = jax.jit(
            lambda *s: jax.lax.map(
                lambda one: jax.value_and_grad(mean_absorptance, argnums=(0, 1, 2))(*one), s
            )
        )
        forward, reverse = timed(plain, *few), timed(slope, *few)

    index = [1.0, *(np.asarray(n[0, :, 0]) + 1j * np.asarray(k[0, :, 0])), 1.0]
    thickness = [np.inf, *np.asarray(d[0]), np.inf]
    begin = time.perf_counter()
    for number in range(SAMPLE):
        tmm.coh_tmm("sp"[number % 2], index, thickness, incidence[number % ANGLES], 1e-6)
    theirs = (time.perf_counter() - begin) / SAMPLE * WAVELENGTHS * ANGLES * 2

    print(f"stack of {LAYERS} layers, {WAVELENGTHS} wavelengths, {ANGLES} angles, 2 polarisations")
    print(f"lightflyer  {ours * 1e3:9.2f} ms per stack, of {STACKS} in one call")
    print(f"tmm         {theirs * 1e3:9.2f} ms per stack, from {SAMPLE} calls")
    print(f"ratio       {theirs / ours:9.0f}")
    print(f"gradient    {reverse / forward:9.2f} times the plain call (n, k, thickness)")


if __name__ == "__main__":
    main()
