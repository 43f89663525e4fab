"""Which objective is worth minimising: objectives, planners and scenes in one campaign.

``python -m benchmarks objectives`` runs it; ``cli`` has the options.
"""
