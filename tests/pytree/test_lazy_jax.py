"""JAX loaded late, each time in a process of its own."""

import subprocess
import sys

import pytest

BEGIN = """
import sys, threading
import lightflyer as lf
from lightflyer.pytree.lazy_jax import jnp
assert "jax" not in sys.modules

def load():
    import jax.numpy

other = threading.Thread(target=load)
"""

IN_ANOTHER_THREAD = """
with lf.float64():
    with lf.float64():
        other.start()
        other.join()
        print(jnp.ones(1).dtype)
    print(jnp.ones(1).dtype)
print(jnp.ones(1).dtype)
"""

WHILE_ANOTHER_THREAD_WAITS = """
entered, loaded = threading.Event(), threading.Event()

def wait():
    with lf.float64():
        entered.set()
        loaded.wait()
        print(jnp.ones(1).dtype)

waiting = threading.Thread(target=wait)
waiting.start()
entered.wait()
load()
loaded.set()
waiting.join()
with lf.float64():
    print(jnp.ones(1).dtype)
print(jnp.ones(1).dtype)
"""


@pytest.mark.parametrize("script", [IN_ANOTHER_THREAD, WHILE_ANOTHER_THREAD_WAITS])
def test_precision_is_that_of_the_thread_that_asked_whoever_loads_jax(script):
    command = [sys.executable, "-c", BEGIN + script]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["float64", "float64", "float32"], done.stderr
