from .design import AbstractDesign as AbstractDesign
from .design import Field as Field
from .design import ObjectDesign as ObjectDesign
from .operating_point import OperatingPoint as OperatingPoint
from .outputs import OUTPUTS as OUTPUTS
from .outputs import Output as Output
from .outputs import outputs_of as outputs_of
from .setup import Setup as Setup
