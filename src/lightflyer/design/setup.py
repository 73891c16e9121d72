"""A flyer, its environment and a force model, as one object."""

from lightflyer.array.records import Module, field
from lightflyer.budget.payload import Budget
from lightflyer.core.quantity import require_record
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel


class Setup(Module):
    """A flyer, its environment and a force model.

    Attributes
    ----------
    flyer : AbstractFlyer
    environment : AbstractEnvironment
    model : AbstractForceModel
    search_range : tuple of (float or None)
        Ends of the altitudes [m] or pressures [Pa] to search; None for the environment's own.
    budget : Budget or None
        What a payload needs, to be set beside what the flyer carries; of no effect on its flight.

    Raises
    ------
    ParameterError
        If a part is of another class, or the model is not for the flyer.
    """

    flyer: AbstractFlyer
    environment: AbstractEnvironment
    model: AbstractForceModel
    search_range: tuple[float | None, float | None] = field(static=True, default=(None, None))
    budget: Budget | None = None

    def __check_init__(self) -> None:
        require_record("flyer", (AbstractFlyer,), self.flyer)
        require_record("environment", (AbstractEnvironment,), self.environment)
        require_record("model", (AbstractForceModel,), self.model)
        self.model.require_flyer(type(self.flyer))

    @property
    def searched(self) -> tuple[float, float]:
        """Ends of the coordinates to search."""
        low, high = self.environment.coordinate.searched
        own_low, own_high = self.search_range
        return (low if own_low is None else own_low, high if own_high is None else own_high)
