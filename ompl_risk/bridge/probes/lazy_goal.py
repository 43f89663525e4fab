"""GoalLazySamples with a sampler written in Python."""

from ompl import base as ob
from ompl import geometric as og
from scene import reached, report, setup


def main():
    """The sampler's thread gets no chance to run Python."""
    simple = setup()

    def sample(goal, state):
        state[0:3] = [0.9, 0.5, 0.9]
        return goal.getStateCount() < 5

    goal = ob.GoalLazySamples(simple.getSpaceInformation(), sample, True, 1e-3)
    simple.setGoal(goal)
    simple.setPlanner(og.RRTConnect(simple.getSpaceInformation()))
    reached()
    status = simple.solve(0.5)
    report(good=simple.haveExactSolutionPath(), saw=f"returns: {status}")
    goal.stopSampling()


if __name__ == "__main__":
    main()
