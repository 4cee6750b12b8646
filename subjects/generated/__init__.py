"""Closed surfaces made by formula: each is hard for a shell engine in one way."""
