"""Studies: which designs, and what is asked of them."""
