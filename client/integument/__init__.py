"""Client of the Integument mesh server: a typed Python library and the `integument` command."""
