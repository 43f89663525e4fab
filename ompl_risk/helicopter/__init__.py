"""A small helicopter: eqs. (7) and (8) of the paper, its trajectory primitives, its control space."""
