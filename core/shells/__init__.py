"""Nested shells below a skin."""
