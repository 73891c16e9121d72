from .comparison import Compared as Compared
from .comparison import Comparison as Comparison
from .comparison import compare as compare
from .text import Difference as Difference
from .text import to_dataset as to_dataset
from .text import write_csv as write_csv
