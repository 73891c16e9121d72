from .inputs import Inputs as Inputs
from .inputs import uncertain_inputs as uncertain_inputs
from .propagation import PredictionUncertainty as PredictionUncertainty
from .propagation import propagate as propagate
from .with_bands import predict as predict
