"""Ways to break a healthy surface as scanners, converters, CAD programs and offsets break them; all from seeds."""
