"""From a defective surface to a closed manifold one, with the smallest change."""
