"""Arrays: the namespace of the models, records, and all that differs between NumPy and JAX.

A model is a function of arrays, written once against :data:`xp`. Called with numbers or NumPy's
arrays it is NumPy. JAX is loaded by what asks for it, and by nothing else.
"""
