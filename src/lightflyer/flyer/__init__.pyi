from .base import AbstractFlyer as AbstractFlyer
from .disk import Disk as Disk
from .disk import DiskSection as DiskSection
from .section import FlyerSection as FlyerSection
