"""Fields of solvers brought onto surfaces: a value per triangle, with the distance to what it was taken from."""
