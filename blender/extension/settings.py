"""The user's settings, and their conversion to arguments of the library."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

# Minimum weight of a vertex in the mask.
IN_MASK = 0.5


class RemeshSettings(bpy.types.PropertyGroup):
    density: EnumProperty(
        name="Density",
        items=[
            ("POINTS", "Vertices", "Exactly this many vertices"),
            ("LENGTH", "Edge Length", "Edges of this mean length"),
        ],
    )
    points: IntProperty(
        name="Vertices",
        description="Number of vertices of the result; with a mask, of those strictly inside it",
        default=5000,
        min=4,
        soft_max=1_000_000,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description="Mean edge length of the result, in the units of the scene",
        default=0.1,
        min=1e-6,
        unit="LENGTH",
    )
    grading: EnumProperty(
        name="Lengths",
        items=[
            ("EVEN", "Even", "The same length everywhere"),
            ("SHAPE", "By Shape", "Shorter where the surface bends or is thin"),
            ("GROUP", "By Vertex Group", "Shorter where vertices have weight"),
        ],
    )
    adapt: FloatProperty(
        name="Adapt",
        description="How strongly edge lengths adapt to the shape: 0 is uniform",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    sizing_group: StringProperty(name="Group", description="Vertex group whose weights make edges shorter")
    finer: FloatProperty(
        name="Times Finer",
        description="Factor by which edges are shorter at weight 1 than at weight 0",
        default=3.0,
        min=1.0,
        soft_max=10.0,
        max=100.0,
    )
    features: EnumProperty(
        name="Sharp Edges",
        items=[
            ("AUTO", "Automatic", "Decided by the surface: edges of CAD parts stay sharp, scans get no false ones"),
            ("ANGLE", "By Angle", "Edges across which the surface turns by at least this angle"),
            ("MARKED", "Marked", "Edges that are marked sharp"),
            ("NONE", "None", "No edge stays sharp"),
        ],
    )
    angle: FloatProperty(name="Angle", default=np.radians(30), min=np.radians(1), max=np.pi, subtype="ANGLE")
    mask_group: StringProperty(
        name="Mask",
        description=f"Remesh only triangles whose vertices all have a weight of at least {IN_MASK} in this vertex group",
    )
    seed: IntProperty(name="Seed", description="Seed of the random numbers", min=0)
    hide_original: BoolProperty(
        name="Hide Original", description="Hide the original object, and show the result", default=True
    )


def options(settings, source):
    """Returns the arguments of `spectral_remesh.remesh`. Raises `ValueError` for a group that `source` does not have."""
    chosen = {"seed": settings.seed}
    if settings.density == "POINTS":
        chosen["points"] = settings.points
    else:
        chosen["edge_length"] = settings.edge_length
    if settings.grading == "SHAPE":
        chosen["adapt"] = settings.adapt
    elif settings.grading == "GROUP":
        # The lengths are relative: a common factor scales them to the requested density.
        chosen["sizing"] = settings.finer ** -source.weights(settings.sizing_group, "Lengths by vertex group")
    if settings.features == "ANGLE":
        chosen["features"] = float(np.degrees(settings.angle))
    elif settings.features == "MARKED":
        chosen["features"] = source.sharp_edges
    elif settings.features == "NONE":
        chosen["features"] = "none"
    if settings.mask_group:
        chosen["select"] = source.weights(settings.mask_group, "Mask") >= IN_MASK
    return chosen
