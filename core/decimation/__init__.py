"""Fewer triangles, same surface."""
