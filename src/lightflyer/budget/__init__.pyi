from .link import RadioLink as RadioLink
from .link import free_space_loss as free_space_loss
from .payload import Budget as Budget
from .payload import Item as Item
from .payload import Needs as Needs
from .payload import SolarCells as SolarCells
