"""One file per format and a registry: bytes to Mesh and back."""
