"""Programs of single numbers, written in JavaScript.

:mod:`~lightflyer.program.javascript.emitter` makes a graph of scalar operations of a program, and
:mod:`~lightflyer.program.javascript.writer` a function of that.
"""
