"""Mesh around the disk, rays through it, and the kernels over both."""
