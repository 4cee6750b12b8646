"""Real anatomy that ships inside wheels, for demo, tests and benchmarks."""
