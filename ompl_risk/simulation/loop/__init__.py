"""The plans of vehicles, and how each follows its own in closed loop."""
