"""PRM.solve with three goal states and a validity checker written in Python."""

from ompl import base as ob
from ompl import geometric as og
from scene import reached, report, setup, state_at


def main():
    """The second thread of PRM validates the second goal and wants Python for it."""
    simple = setup()
    information = simple.getSpaceInformation()
    goals = ob.GoalStates(information)
    for y in (0.4, 0.5, 0.6):
        goals.addState(state_at(information, 0.9, y, 0.9))
    simple.setGoal(goals)
    simple.setPlanner(og.PRM(information))
    reached()
    report(good=True, saw=f"returns: {simple.solve(0.5)}")


if __name__ == "__main__":
    main()
