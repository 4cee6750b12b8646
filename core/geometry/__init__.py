"""Kernels and small functions on raw arrays; lengths in mm."""
