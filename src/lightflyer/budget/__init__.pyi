from .payload import Budget as Budget
from .payload import Item as Item
from .payload import Needs as Needs
from .payload import RadioLink as RadioLink
from .payload import SolarCells as SolarCells
from .payload import free_space_loss as free_space_loss
