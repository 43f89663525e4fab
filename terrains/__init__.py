"""Elevation as a triangulated height field: files in, catalogue, heights, meshes, hillshade."""

from ompl_risk.terrains import parametric as parametric
from ompl_risk.terrains.catalogue import names as names
from ompl_risk.terrains.georeference import Georeference as Georeference
from ompl_risk.terrains.loading import load as load
from ompl_risk.terrains.reprojection import reproject_max as reproject_max
from ompl_risk.terrains.terrain import Terrain as Terrain
from ompl_risk.terrains.voids import fill_voids as fill_voids
