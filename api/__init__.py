"""HTTP only: routes, schemas of replies, problems. Knows the store, never the geometry."""
