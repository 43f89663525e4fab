"""The control planner SST, the only optimising one."""

from ompl import base as ob
from ompl import control as oc
from scene import reached, report, space


def main():
    """Its class is there, its constructor is not."""
    cube = space()
    controls = oc.RealVectorControlSpace(cube, 1)
    bounds = ob.RealVectorBounds(1)
    bounds.setLow(-1.0)
    bounds.setHigh(1.0)
    controls.setBounds(bounds)
    information = oc.SpaceInformation(cube, controls)
    reached()
    try:
        oc.SST(information)  # type: ignore[call-arg]
    except (TypeError, AttributeError) as error:
        report(good=False, saw=f"{type(error).__name__}: {str(error).split(': ')[-1]}")
    else:
        report(good=True, saw="can be constructed")


if __name__ == "__main__":
    main()
