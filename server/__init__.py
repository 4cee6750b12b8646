"""The embedded set-up: one command that supervises API, worker and a private Valkey in a data folder."""
