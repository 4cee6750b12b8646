"""Surfaces in 3D inside the report: packed small, shown by a viewer that the file carries itself."""
