"""Probabilities of collision from rollouts: how sure they are, how they differ, when to stop."""
