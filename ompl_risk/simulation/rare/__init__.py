"""Importance sampling of collisions that are rare."""
