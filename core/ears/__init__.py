"""Ears: where they are on a body, and canals cut into them."""
