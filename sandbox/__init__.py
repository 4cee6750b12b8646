"""Run one function in a child process that may be hostile, hungry or hung, and never harm the parent."""
