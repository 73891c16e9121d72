"""Where a sweep is computed: on this machine's processors, or on its GPUs."""

from collections.abc import Callable
from typing import Any, Literal, get_args

import numpy as np

from lightflyer.array.namespace import load_jax
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra

Device = Literal["cpu", "gpu"]  # Kinds of devices, by JAX's names

_AXIS = "designs"


def find_devices(kind: str) -> list[Any]:
    """All devices of a kind that this process has."""
    if kind not in get_args(Device):
        raise ConfigurationError(f"device {kind}: is not one of {', '.join(get_args(Device))}")
    extra("jax", f"device {kind}", "jax")
    try:
        return load_jax().local_devices(backend=kind)
    except RuntimeError:
        raise ConfigurationError(
            f'device {kind}: JAX finds none here; for one of NVIDIA install "jax[cuda13]", else '
            "leave the device out"
        ) from None


class OnDevices:
    """Divides arrays over devices and computes each part where it lies."""

    # The parts do not wait for each other: a search ends on each device when its own designs have
    # converged. Float64 throughout.

    def __init__(self, kind: str):
        devices = find_devices(kind)
        self.count = len(devices)
        jax = load_jax()
        self._mesh = jax.sharding.Mesh(np.array(devices), (_AXIS,))
        self._each = jax.sharding.PartitionSpec(_AXIS)

    def divide_work(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """A function of arrays of designs that is computed part by part."""
        return load_jax().shard_map(
            function, mesh=self._mesh, in_specs=self._each, out_specs=self._each, check_vma=False
        )

    def place(self, arrays: Any) -> Any:
        """Arrays on the devices, a part on each; their length is a multiple of the devices'."""
        jax = load_jax()
        return jax.device_put(arrays, jax.sharding.NamedSharding(self._mesh, self._each))
