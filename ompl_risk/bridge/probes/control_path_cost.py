"""PathControl.cost with OMPL's own path length."""

from ompl import base as ob
from ompl import control as oc
from scene import reached, report, space, state_at


def main():
    """Logs an error and returns the identity cost."""
    cube = space()
    controls = oc.RealVectorControlSpace(cube, 1)
    bounds = ob.RealVectorBounds(1)
    bounds.setLow(-1.0)
    bounds.setHigh(1.0)
    controls.setBounds(bounds)
    information = oc.SpaceInformation(cube, controls)
    information.setStatePropagator(lambda *_: None)
    information.setStateValidityChecker(lambda *_: True)
    information.setup()
    path = oc.PathControl(information)
    path.append(state_at(information, 0.1, 0.1, 0.1), information.allocControl(), 1.0)
    path.append(state_at(information, 0.9, 0.1, 0.1))
    reached()
    cost = path.cost(ob.PathLengthOptimizationObjective(information)).value()
    report(good=abs(cost - 0.8) < 1e-9, saw=f"cost {cost:g} of a path of length 0.8")


if __name__ == "__main__":
    main()
