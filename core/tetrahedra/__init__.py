"""The space between nested surfaces filled with tetrahedra, one region per tissue: proof that a set can be meshed."""
