"""Better triangles, same surface."""
