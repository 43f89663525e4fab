"""Closed-loop simulation: how often a vehicle that follows a plan in wind and error collides."""
