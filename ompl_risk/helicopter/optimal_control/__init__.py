"""Manoeuvres of minimum time by optimal control: an offline tool, with the extra ``primitives``.

``python -m ompl_risk.helicopter.optimal_control --help``
"""
