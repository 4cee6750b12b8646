"""Checks: each looks at one property and returns findings."""
