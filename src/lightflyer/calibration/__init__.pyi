from .bayes import Posterior as Posterior
from .bayes import posterior as posterior
from .calibration import Calibration as Calibration
from .fitting import calibrate as calibrate
from .points import Points as Points
from .points import read_points as read_points
from .steps import found_step as found_step
