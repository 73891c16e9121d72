"""Programs: what a traced function computes, as plain data, and the ways to run it.

All that is needed of JAX's inside is in :mod:`~lightflyer.program.tracing` and
:mod:`~lightflyer.program.primitives`. They make a
:class:`~lightflyer.program.program.Program`, which holds operations on arrays whose lengths are
symbols: one trace serves arrays of every length. :mod:`~lightflyer.program.numpy_backend` runs it
without a compiler, by the :mod:`~lightflyer.program.operations`, and
:mod:`~lightflyer.program.entry_point` decides between that and XLA.
:mod:`~lightflyer.program.scalar` writes it number by number: in JavaScript for a page, in Python
for what is called very many times.
"""
