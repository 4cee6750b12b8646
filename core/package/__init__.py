"""The delivered zip: files, manifest, README."""
