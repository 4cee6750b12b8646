"""Parameters and results of every process: pydantic models without I/O, the one source for API, worker, client and docs."""
