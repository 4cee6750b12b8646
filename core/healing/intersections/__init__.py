"""From a closed surface that runs through itself to one that does not."""
