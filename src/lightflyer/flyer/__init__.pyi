from .base import AbstractFlyer as AbstractFlyer
from .disk import Disk as Disk
from .disk import DiskSection as DiskSection
from .sandwich import Sandwich as Sandwich
from .sandwich import SandwichSection as SandwichSection
from .section import FlyerSection as FlyerSection
