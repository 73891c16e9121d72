from .evaluator import Place as Place
from .prediction import Prediction as Prediction
from .prediction import TemperatureMap as TemperatureMap
from .tables import to_dataset as to_dataset
from .tables import write_csv as write_csv
from .verdict import Verdict as Verdict
