"""One file per process: the only place where algorithms are combined."""
