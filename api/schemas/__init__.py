"""What travels over HTTP: pydantic models of answers and bodies, after OGC API - Processes Part 1 where it names them."""
