"""Direct simulation of the gas around a thin hot disk in a cylindrical reservoir.

Lengths are in disk radii, speeds in √(2RT_c), masses in that of a molecule and densities in
that far away. Then kT_c = 1/2 and p = 1/2. A pair is of the top and the bottom face.
"""
