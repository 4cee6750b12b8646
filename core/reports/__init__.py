"""Findings to figures and words."""
