"""The steps of `prepare`: each one a function of what came before it, resumable, with a section in the report."""
