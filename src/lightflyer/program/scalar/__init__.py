"""Programs of single numbers, as text of a language.

:mod:`~lightflyer.program.scalar.emitter` makes a graph of scalar operations of a program,
:mod:`~lightflyer.program.scalar.writer` a function of that:
:mod:`~lightflyer.program.scalar.javascript` for a page, :mod:`~lightflyer.program.scalar.python`
for what is called very many times with one number each.
"""
