"""One file per resource. A route reads the request, asks the store, and shapes the answer; nothing else."""
