"""Paths for `rank`: a risk-aware roadmap, OMPL's planners in worker processes, what improves paths.

`RiskRoadmap` is a planner for OMPL's SimpleSetup, `SST` one for its control spaces. `Portfolio`
runs any planners side by side. Without OMPL, `roadmap_of` grows a roadmap for a `Problem`, and
`flight_roadmap` one that a helicopter flies: `alternative_routes` are its ways of equal time,
`pareto_routes` all that are not undercut in both duration and risk. `earliest_arrival` finds the
way through a network among moving obstacles.
"""

from ompl_risk.planners.candidate_ranking import CandidateRanking as CandidateRanking
from ompl_risk.planners.candidate_ranking import rank_candidates as rank_candidates
from ompl_risk.planners.criteria import Criterion as Criterion
from ompl_risk.planners.criteria import Length as Length
from ompl_risk.planners.criteria import WeightedRisk as WeightedRisk
from ompl_risk.planners.criteria import parse_criterion as parse_criterion
from ompl_risk.planners.engine_choice import engine_of as engine_of
from ompl_risk.planners.engines import Engine as Engine
from ompl_risk.planners.generation import candidates as candidates
from ompl_risk.planners.improve import Improvement as Improvement
from ompl_risk.planners.improve import improve_path as improve_path
from ompl_risk.planners.improve import refine as refine
from ompl_risk.planners.improve import simplify as simplify
from ompl_risk.planners.low_level import low_level_flight as low_level_flight
from ompl_risk.planners.menu import menu as menu
from ompl_risk.planners.menu import parse_task as parse_task
from ompl_risk.planners.methods import METHODS as METHODS
from ompl_risk.planners.methods import Heeds as Heeds
from ompl_risk.planners.methods import method_of as method_of
from ompl_risk.planners.portfolio import Portfolio as Portfolio
from ompl_risk.planners.problem import Problem as Problem
from ompl_risk.planners.roadmap.alternatives import alternatives as alternatives
from ompl_risk.planners.roadmap.building import roadmap_of as roadmap_of
from ompl_risk.planners.roadmap.equal_time import equal_time_paths as equal_time_paths
from ompl_risk.planners.roadmap.equal_time_flights import EqualTimeFlights as EqualTimeFlights
from ompl_risk.planners.roadmap.equal_time_flights import equal_time_flights as equal_time_flights
from ompl_risk.planners.roadmap.exploring import Front as Front
from ompl_risk.planners.roadmap.exploring import alternative_routes as alternative_routes
from ompl_risk.planners.roadmap.exploring import pareto_routes as pareto_routes
from ompl_risk.planners.roadmap.flights import flight_roadmap as flight_roadmap
from ompl_risk.planners.roadmap.front import ParetoSet as ParetoSet
from ompl_risk.planners.roadmap.graph import Graph as Graph
from ompl_risk.planners.roadmap.graph import Way as Way
from ompl_risk.planners.roadmap.pareto import pareto_set as pareto_set
from ompl_risk.planners.roadmap.planner import RiskRoadmap as RiskRoadmap
from ompl_risk.planners.roadmap.roadmap import Roadmap as Roadmap
from ompl_risk.planners.roadmap.roadmap import Route as Route
from ompl_risk.planners.selection import Selection as Selection
from ompl_risk.planners.selection import select as select
from ompl_risk.planners.shortcut import shortcut as shortcut
from ompl_risk.planners.sides import Sides as Sides
from ompl_risk.planners.solving import solve_task as solve_task
from ompl_risk.planners.spacetime import Arrival as Arrival
from ompl_risk.planners.spacetime import Network as Network
from ompl_risk.planners.spacetime import TimedRoute as TimedRoute
from ompl_risk.planners.spacetime import Wait as Wait
from ompl_risk.planners.spacetime import earliest_arrival as earliest_arrival
from ompl_risk.planners.sst.planner import SST as SST
from ompl_risk.planners.task import Candidate as Candidate
from ompl_risk.planners.task import Status as Status
from ompl_risk.planners.task import Task as Task
from ompl_risk.planners.warming import warm_up as warm_up
