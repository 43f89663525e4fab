"""A library of the default helicopter that is quick to make, with manoeuvres in closed form."""

from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT

X_CELL = Helicopter()
GRID = {
    "speeds": [0.0, 10.0],
    "turns": [[-0.8, -0.3, 0.3, 0.8], [-0.6, -0.2, 0.2, 0.6]],
    "climbs": [[-2.0, 2.0], [-2.0, 2.0]],
}


def lifting(speed, before, after, steps=160):
    """A change of the climb rate at constant acceleration: exact, by the collective alone."""
    lift = X_CELL.weight + X_CELL.mass * (after - before) / (steps * DT)
    return (speed, before, 0.0), (speed, after, 0.0), [[lift, 0.0, 0.0, 0.0]] * steps


def left_turn(shipped):
    """First key, last key and inputs of a shipped manoeuvre into a left turn at 10 m/s."""
    found = shipped.manoeuvre(shipped.trim(10.0), shipped.trim(10.0, 0.0, shipped.turns[1, 2]))
    return found.first.key, found.last.key, found.controls


def grid_with(turn):
    """The grid with another gentle turn rate at 10 m/s."""
    return {"turns": [GRID["turns"][0], [-3.0 * turn, -turn, turn, 3.0 * turn]]}


def library(*manoeuvres, **changed):
    return PrimitiveLibrary(X_CELL, Limits(), manoeuvres=manoeuvres, **{**GRID, **changed})
