"""`integument admin doctor`: everything a server needs, looked at and measured; what is wrong is said with what to do."""
