"""The flyer file: its grammar, and the design that it describes."""
