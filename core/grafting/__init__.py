"""Cut and paste of surfaces: a region of one mesh set into another and joined by a new band of triangles."""
