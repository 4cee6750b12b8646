"""From labels of voxels to surfaces."""
