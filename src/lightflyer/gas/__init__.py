"""Gases: transport properties, and the lengths and speeds made of them."""
