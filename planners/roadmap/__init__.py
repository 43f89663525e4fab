"""Paths through a graph of sampled states: building it, searching it, many ways at once."""
