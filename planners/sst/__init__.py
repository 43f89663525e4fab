"""Stable sparse RRT for the helicopter: a kinodynamic planner that improves its paths."""
