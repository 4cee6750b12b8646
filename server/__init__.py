"""`integument serve`: one command that runs API, worker and a private Valkey from a data folder."""
