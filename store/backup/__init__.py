"""Copies of everything that outlives a process, and the way back: rows as text, files by their hash."""
