"""``results.h5``: what it holds of one analysis, and how.

::

    /                       attributes: title, engine, status, reason, model (its text), ...
    /curve/<column>         (n_points,) every field of `CurvePoint`
    /poses                  (n_points, n, n_pose) m, m, rad; in space m, m, m, unit quaternion
    /contacts/offset        (n_points + 1,) rows of the contacts of point k: offset[k]:offset[k + 1]
    /contacts/<field>       every field of `ContactForces`, all points one after the other
    /blocks/id, centroid, weight, support
    /blocks/vertices, offset, body      shape s, of block body[s], has vertices from offset[s] on
    /blocks/rows, face_offset, part_faces, axes     of space only, see below
    /files/name, text       the files that the model names, of its site and its control
    /groups/name, offset, block         group k has the blocks block[offset[k]:offset[k + 1]]
    /ties/name              of ties, where there are any
    /ties/force, elongation, state      (n_points, n_ties) N, m, row of `ties.STATES`
    /blocks_left/<field>    every field of `BlockLeft`, once the analysis has ended

Shapes are outlines in the plane, one to a block, so that ``body`` is left out, but for those given
in parts.  In space they are the convex parts of the blocks: face f is made of the vertices
``rows[face_offset[f]:face_offset[f + 1]]``, counter-clockwise from outside, and shape s of the
faces from ``part_faces[s]`` to ``part_faces[s + 1]``; ``axes`` are the principal ones as designed,
in columns.  Poses are about the centroids, see `geometry.motion`; of contacts in space ``tangent``
is the first of two directions of ``tangential_reaction``, the second is normal x tangent.

`results_writer` writes it while the analysis runs, `results_reader` reads it.
"""

from __future__ import annotations

from dataclasses import fields

import h5py
import numpy as np

from drystone.contact.forces import ContactForces
from drystone.results.curve import CurvePoint

#: Status of a run that has not ended, or that was killed.
RUNNING = "running"

TYPES = {"int": "i8", "float": "f8", "str": "S8", "bool": "?"}
COLUMN_TYPES = {f.name: np.dtype(TYPES[str(f.type)]) for f in fields(CurvePoint)}
UNITS = {
    "control_displacement": "m",
    "penetration": "m",
    "motion": "m",
    "time_step": "s",
    "position": "m",
    "gap": "m",
    "area": "m2",
    "normal_reaction": "N",
    "tangential_reaction": "N",
    "vertices": "m",
    "centroid": "m",
    "weight": "N",
    "force": "N",
    "reaction": "N, N m",
    "elongation": "m",
}
STORED_AS = {"block_a": "i4", "block_b": "i4", "status": "i1"}
LEFT_TYPES = {"block": h5py.string_dtype(), "step": "i8", "control_displacement": "f8"}
#: Of ties: names in the file, fields of `TieState`, how they are stored.
TIE_FIELDS = (
    ("force", "force", "f8"),
    ("elongation", "elongation", "f8"),
    ("state", "branch", "i1"),
)
CONTACT_FIELDS = tuple(f.name for f in fields(ContactForces))
#: What files of plane models do not hold: it follows from the rest.
OF_SPACE = ("tangent",)
