"""Sound files that are changed: models of every table, and drawings of every format."""

from __future__ import annotations

import copy
import importlib.util
import io
import json
import struct
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from drawn import bent_dome, box, brick_wall, obj_text
from drystone.io.drawings import Shape, compas, dxf, ply, stl

ROOT = Path(__file__).resolve().parents[2]

LAW = """
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.65
normal_stiffness = 1e9
shear_stiffness = 1e9
"""
PUSH = '[load]\npattern = "mass"\ndirection = [1.0, 0.0]\n'
PUSH_IN_SPACE = '[load]\npattern = "mass"\ndirection = [1.0, 0.0, 0.0]\n'
TWO = """
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
groups = ["ground floor"]
[[block]]
id = "b1"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]
groups = ["top"]
"""
TWO_IN_SPACE = """
[[block]]
id = "base"
box = [[-1.0, -1.0, -0.2], [1.0, 1.0, 0.0]]
support = true
[[block]]
id = "b1"
outline = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]
depth = [-0.3, 0.3]
groups = ["top"]
"""

#: Models in which every table is, small enough to be run.
MODELS = {
    "plane": 'title = "a"\ndimension = 2\nthickness = 1.0\n' + LAW + TWO + PUSH,
    "corners": """
title = "a"
dimension = 2
thickness = 1.0
drawing_tolerance = 0.001
[material.stone]
density = 2000.0
[material.brick]
unit_weight = 18e3
[joint]
friction_coefficient = 0.6
dilatancy_angle = 5.0
dilatancy_end = 0.01
[joint.mortar]
thickness = 0.01
young_modulus = 2e9
poisson_ratio = 0.2
[joint.between."brick stone"]
cohesion = 1e4
tensile_strength = 1e4
friction_coefficient = 0.5
[corner]
radius = 0.02
[control]
block = "b1"
point = "top right"
direction = [1.0, 0.0]
[analysis]
engine = "equilibrium"
strategy = "displacement"
stop_multiplier = 0.01
max_displacement = 0.1
falling = "stop"
event_share = 0.5
ground = -1.0
max_penetration = 0.05
max_steps = 1000
displacement_step = 0.002
increment = 0.01
time_step = 0.05
mechanism_displacement = 0.1
[group.all]
blocks = ["b*"]
"""
    + TWO.replace('id = "b1"', 'id = "b1"\nmaterial = "brick"').replace(
        'id = "base"', 'id = "base"\nmaterial = "stone"'
    )
    + PUSH,
    "wall": """
title = "a"
dimension = 2
thickness = 0.5
[wall]
unit = [0.4, 0.2]
courses = ["h11", "11h"]
repeat = 2
base = true
origin = [1.0, 2.0]
[corner]
chamfer = 0.01
[analysis]
strategy = "published"
increment = 0.005
overshoot = 1.05
balance_tolerance = 0.001
patience = 20
"""
    + LAW
    + PUSH,
    "tied": "dimension = 2\nthickness = 1.0\n"
    + LAW
    + TWO
    + """
[[tie]]
name = "t"
from = { block = "b1", point = [0.2, 0.8] }
to = { block = "ground", point = [2.0, 0.8] }
area = 1e-4
young_modulus = 200e9
yield_force = 50e3
anchorage_force = 40e3
breaking_elongation = 0.05
pretension = 100.0
compression = false
[[spring]]
from = { block = "b1", point = [-0.2, 0.5] }
to = { block = "base", point = [-0.8, 0.0] }
stiffness = 1e6
pretension = 10.0
[[dead_load]]
kind = "force"
name = "roof"
mass = true
stage = 1
block = "b1"
point = "top"
force = [0.0, -1e3]
[[dead_load]]
kind = "surcharge"
mass = false
stage = 2
block = "b1"
weight = 500.0
[[dead_load]]
kind = "face"
mass = false
group = "top"
side = [0.0, 1.0]
within = 10.0
pressure = [0.0, -100.0]
[[dead_load]]
kind = "fill"
mass = false
group = "top"
side = [-1.0, 0.0]
unit_weight = 15e3
level = 0.5
at_rest = 0.4
[load]
pattern = "forces"
force = [{ block = "b1", point = "top", force = [1e3, 0.0] }]
""",
    "supports": "dimension = 2\nthickness = 1.0\n"
    + LAW
    + """
[[block]]
id = "left"
vertices = [[-1.0, -0.2], [0.0, -0.2], [0.0, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "right"
vertices = [[0.0, -0.2], [1.0, -0.2], [1.0, 0.0], [0.0, 0.0]]
support = true
[[block]]
id = "b1"
vertices = [[-0.4, 0.0], [0.4, 0.0], [0.4, 0.3], [-0.4, 0.3]]
held = ["x"]
[settlement]
blocks = ["right"]
direction = [0.0, -1.0]
max = 0.01
""",
    "turning": "dimension = 3\n"
    + LAW
    + TWO_IN_SPACE
    + """
[settlement]
blocks = ["base"]
centre = [0.0, 0.0, 0.0]
axis = [0.0, 1.0, 0.0]
max = 5.0
""",
    "space": 'title = "a"\ndimension = 3\n[contact]\npoints = 4\n'
    + LAW
    + TWO_IN_SPACE
    + """
[[block]]
id = "b2"
vertices = [[-0.2, -0.3, 0.9], [0.2, -0.3, 0.9], [0.2, 0.3, 0.9], [-0.2, 0.3, 0.9], [0.0, 0.0, 1.3]]
faces = [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
"""
    + PUSH_IN_SPACE,
    "parts": "dimension = 3\n[contact]\npoints = 9\n[corner]\nradius = 0.01\n"
    + LAW
    + """
[[block]]
id = "base"
box = [[-1.0, -1.0, -0.2], [1.0, 1.0, 0.0]]
support = true
[[block]]
id = "b1"
parts = [
  { box = [[-0.4, -0.2, 0.0], [0.0, 0.2, 0.8]] },
  { box = [[0.0, -0.2, 0.0], [0.4, 0.2, 0.4]] },
]
[control]
block = "b1"
point = [-0.4, -0.2, 0.8]
direction = [0.0, -1.0, 0.0]
[load]
pattern = "tilt"
direction = [0.0, -1.0, 0.0]
""",
    "accelerated": "dimension = 2\nthickness = 1.0\n"
    + LAW
    + TWO
    + """
[load]
pattern = "acceleration"
acceleration = [{ group = "top", acceleration = [1.0, 0.0] }]
""",
    "modes": "dimension = 2\nthickness = 1.0\n" + LAW + TWO + PUSH.replace("mass", "modal"),
    "at a site": "dimension = 2\nthickness = 1.0\n"
    + LAW
    + TWO
    + PUSH
    + """
[site]
code = "csv"
file = "spectrum.csv"
unit = "g"
damping = 5.0
soil_factor = 1.2
corner_period = 0.4
site_specific = true
return_period = 475.0
[site.floor]
height = 3.0
building_height = 9.0
damping = 5.0
storeys = 3
[assessment]
method = "rocking"
reading = "energy"
confidence_factor = 1.35
restitution = 0.9
sides = "two"
limit_states = ["SLV"]
displacement_limits = { SLV = 0.1 }
[[assessment.record]]
file = "record.csv"
unit = "g"
scale = 1.5
[[assessment.pulse]]
kind = "half_sine"
amplitude = 0.3
duration = 0.5
""",
    "imported": "dimension = 3\n"
    + LAW
    + '[[import]]\nfile = "a.obj"\nunit = "m"\nup = "z"\nsupport_below = -0.1\ntolerance = 0.05\n'
    + 'bent_faces = "fans"\noverlap = 0.001\nname = "w"\ngroup = "g"\norigin = [0.0, 0.0, 0.0]\n'
    + "rotation = [0.0, 0.0, 10.0]\nsupport = []\n"
    + PUSH_IN_SPACE,
}

#: Models of the examples that lay hundreds of blocks: these are read, and small ones run.
EXAMPLES = (
    *sorted(
        set((ROOT / "examples").glob("*.toml")) - set((ROOT / "examples").glob("*_study.toml"))
    ),
    *sorted((ROOT / "examples" / "builders").glob("*.toml")),
)

TABLES = {
    "spectrum.csv": "T,Se\n0.0,0.2\n0.1,0.5\n0.4,0.5\n1.0,0.2\n2.0,0.1\n4.0,0.025\n",
    "record.csv": "t,a\n" + "".join(f"{0.05 * k:.2f},{0.3 * (-1) ** k:.2f}\n" for k in range(40)),
    "history.txt": "# m\n0.001\n-0.001  # back\n\n0.002\n-0.002\n0\n",
}

#: Study files, of a model beside them.
STUDIES = (
    """
title = "Friction"
model = "model.toml"
design = "lhs"
samples = 8
seed = 3
outputs = ["curve", "limit"]
timeout = 5.0
[[parameter]]
path = "joint.friction_coefficient"
name = "friction"
distribution = "norm"
mean = 0.6
std = 0.05
bounds = [0.3, 0.9]
[[parameter]]
path = "material.stone.unit_weight"
apply = "multiply"
range = [0.9, 1.1]
[[correlation]]
between = ["friction", "material.stone.unit_weight"]
value = 0.5
[imperfection]
vertices = 0.001
loose = 0.1
loose_gap = 0.002
blocks = ["b*"]
[[fragility]]
method = "capacity"
capacity = "peak_multiplier"
""",
    """
model = "model.toml"
design = "grid"
[[parameter]]
path = "joint.friction_coefficient"
values = [0.4, 0.5, 0.6]
[[parameter]]
path = ["joint.normal_stiffness", "joint.shear_stiffness"]
name = "stiffness"
apply = "multiply"
range = [0.5, 2.0]
steps = 3
""",
    """
model = "model.toml"
design = "saltelli"
samples = 4
second_order = true
[[parameter]]
path = "load.direction"
values = [[1.0, 0.0], [-1.0, 0.0]]
[[parameter]]
path = "joint.friction_coefficient"
distribution = "uniform"
mean = 0.6
std = 0.05
""",
    """
model = "model.toml"
[target]
output = "peak_multiplier"
value = 0.3
tolerance = 0.01
most_runs = 8
[[target.parameter]]
path = "joint.friction_coefficient"
range = [0.2, 0.8]
""",
)


@cache
def models() -> tuple[dict[str, Any], ...]:
    """All of them, as nested tables."""
    own = [tomllib.loads(text) for text in MODELS.values()]
    return (*own, *own, *(tomllib.loads(path.read_text(encoding="utf-8")) for path in EXAMPLES))


@cache
def texts() -> tuple[str, ...]:
    """All of them, as TOML."""
    own = tuple(MODELS.values())
    return (*own, *own, *(path.read_text(encoding="utf-8") for path in EXAMPLES))


@cache
def shapes() -> tuple[Shape, ...]:
    """Three bricks, of which the lowest two lie below the ground."""
    blocks = brick_wall(np.random.default_rng(5), noise=4e-4, decimals=3)[:3]
    blocks = [(n, np.round(v - [0.0, 0.0, 0.2], 3), f) for n, v, f in blocks]
    return tuple(
        Shape(name=n, vertices=v, faces=tuple(f), layer="stone", support=k == 0)
        for k, (n, v, f) in enumerate(blocks)
    )


def _stl_binary() -> bytes:
    rows = []
    for shape in shapes():
        for face in shape.faces:
            for k in range(1, len(face) - 1):
                corners = shape.vertices[[face[0], face[k], face[k + 1]]]
                rows.append(struct.pack("<12fH", 0, 0, 0, *corners.ravel().tolist(), 0))
    return b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def _ply_binary() -> bytes:
    low, faces = box((-1, -1, -0.2), (1, 1, 0))
    vertices = np.vstack((low, box((-0.2, -0.2, 0), (0.2, 0.2, 0.9))[0]))
    faces = (*faces, *(tuple(8 + i for i in face) for face in faces))
    head = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 16\nproperty float x\n"
        "property float y\nproperty float z\nelement face 12\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack("<3f", *row) for row in vertices.tolist())
    return head.encode() + body + b"".join(struct.pack("<B4i", 4, *face) for face in faces)


def _dxf_of_the_plane() -> list[str]:
    """Polylines, arcs, a control point, and blocks that are inserted, once and in rows."""
    import ezdxf

    document = ezdxf.new("R2000", units=6)
    space = document.modelspace()
    low = [(-1.0, -0.2), (1.0, -0.2), (1.0, 0.0), (-1.0, 0.0)]
    space.add_lwpolyline(low, close=True, dxfattribs={"layer": "support"})
    stone = document.blocks.new("STONE")
    outline = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.0, 0.2)]
    stone.add_lwpolyline(outline, close=True, dxfattribs={"layer": "stone"})
    pair = document.blocks.new("PAIR")
    pair.add_blockref("STONE", (0.0, 0.0))
    pair.add_blockref("STONE", (0.4, 0.0))
    space.add_blockref("PAIR", (-0.8, 0.0))
    rows = {"column_count": 2, "row_count": 1, "column_spacing": 0.4}
    space.add_blockref("STONE", (0.0, 0.0), dxfattribs=rows)
    space.add_polyline2d([(-0.8, 0.2), (0.0, 0.2), (0.0, 0.4), (-0.8, 0.4)], close=True)
    coping = [(-0.8, 0.4, 0.0), (0.0, 0.4, 0.0), (0.0, 0.5, 0.3), (-0.8, 0.5, 0.0)]
    space.add_lwpolyline(coping, format="xyb", close=True)
    space.add_point((-0.8, 0.4), dxfattribs={"layer": "control"})
    space.add_text("a title")
    stream = io.StringIO()
    document.write(stream)
    return [_short(stream.getvalue())]


def _short(text: str) -> str:
    """A DXF file without its objects, of which nothing is read: they are most of it."""
    head, mark, tail = text.partition("  0\nSECTION\n  2\nOBJECTS\n")
    return head + "  0\nEOF\n" if mark and tail else text


_IFC = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
#1=IFCPROJECT('0$WU4A9R19$vKWO$AdOnKA',$,'p',$,$,$,$,(#10),#5);
#5=IFCUNITASSIGNMENT((#6));
#6=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);
#10=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,#11,$);
#11=IFCAXIS2PLACEMENT3D(#12,$,$);
#12=IFCCARTESIANPOINT((0.,0.,0.));
#20=IFCLOCALPLACEMENT($,#11);
#30=IFCRECTANGLEPROFILEDEF(.AREA.,$,#31,2.,1.);
#31=IFCAXIS2PLACEMENT2D(#32,$);
#32=IFCCARTESIANPOINT((0.,0.));
#33=IFCDIRECTION((0.,0.,1.));
#34=IFCEXTRUDEDAREASOLID(#30,#35,#33,0.2);
#35=IFCAXIS2PLACEMENT3D(#36,$,$);
#36=IFCCARTESIANPOINT((0.,0.,-0.2));
#37=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#34));
#38=IFCPRODUCTDEFINITIONSHAPE($,$,(#37));
#39=IFCFOOTING('1$WU4A9R19$vKWO$AdOnKB',$,'base',$,$,#20,#38,$,$);
#40=IFCRECTANGLEPROFILEDEF(.AREA.,$,#31,0.4,0.4);
#44=IFCEXTRUDEDAREASOLID(#40,#11,#33,0.9);
#47=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#44));
#48=IFCPRODUCTDEFINITIONSHAPE($,$,(#47));
#49=IFCWALL('2$WU4A9R19$vKWO$AdOnKC',$,'b1',$,$,#20,#48,$,$);
ENDSEC;
END-ISO-10303-21;
"""


@cache
def bodies() -> tuple[str, ...]:
    """LMGC90's files of the plane and of space."""
    plane = []
    for k, (low, high) in enumerate((((-1.0, -0.2), (1.0, 0.0)), ((-0.2, 0.0), (0.2, 0.9))), 1):
        (x0, y0), (x1, y1) = low, high
        plane += ["$bdyty", f" RBDY2  {k}", "$blmty"]
        plane += [" PLAIN  1  behav  STONE  avrd= 0.1D+00  gyrd= 0.0D+00", "$nodty"]
        plane += [" NO3xx  1  coo1= 0.0D+00  coo2= 0.0D+00  coo3= 0.0D+00", "$tacty"]
        plane += [" POLYG  1  color  BLEUx  nb_vertex=  4"]
        plane += [f"   coo1={x:.4f}D+00 coo2={y:.4f}D+00" for x, y in
                  ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]  # fmt: skip
        plane += ["$$$$$$"]
    space = []
    for k, (low, high) in enumerate(
        (((-1, -1, -0.2), (1, 1, 0)), ((-0.2, -0.2, 0), (0.2, 0.2, 0.9))), 1
    ):
        vertices, faces = box(low, high)
        cut = [(f[0], f[i], f[i + 1]) for f in faces for i in (1, 2)]
        space += ["$bdyty", f" RBDY3  {k}", "$blmty", " PLAIN  1  behav  STONE  avrd= 0.0D+00"]
        space += ["$nodty", " NO6xx  1  coo1= 0.0  coo2= 0.0  coo3= 0.0", "$tacty"]
        space += [f" POLYR  1  color  REDxx  nb_vertex={len(vertices)}  nb_faces={len(cut)}"]
        space += ["".join(f"  coo{i}={x}" for i, x in enumerate(v, 1)) for v in vertices.tolist()]
        space += ["".join(f"  ver{i}={j + 1}" for i, j in enumerate(f, 1)) for f in cut]
        space += ["$$$$$$"]
    return "\n".join(plane) + "\n", "\n".join(space) + "\n"


#: What stands beside BODIES.DAT.
BESIDE_BODIES = {
    "DRV_DOF.DAT": "".join(
        f"$bdyty\n {kind}  1\n$dofty\n"
        + "".join(f" vlocy {n} CT= 0.0\n" for n in range(1, most + 1))
        + "$$$$$$\n"
        for kind, most in (("RBDY2", 3), ("RBDY3", 6))
    ),
    "DOF.INI": "! DOF\n$bdyty\n RBDY2  2\n$nodty\n NO3xx  1  X(1)= 0.0  X(2)= 0.0  X(3)= 0.0\n"
    "$$$$$$\n$bdyty\n RBDY3  2\n$nodty\n NO6xx  1  X(1)= 0.0  X(3)= 0.0\n"
    " a(1)= 1.0  a(2)= 0.0  a(3)= 0.0\n b(1)= 0.0  b(2)= 1.0  b(3)= 0.0\n"
    " g(1)= 0.0  g(2)= 0.0  g(3)= 1.0\n$$$$$$\n",
}


@cache
def drawings(ending: str) -> tuple[bytes, ...]:
    """Drawings of a format by its ending; none where its library is missing."""
    if ending == "obj":
        blocks = [(s.name, s.vertices, s.faces) for s in shapes()]
        bent = [(n, v - [0.0, 0.0, 1.0], f) for n, v, f in bent_dome(rings=2)[0:7:6]]
        return tuple(obj_text(b, decimals=3, twice=True).encode() for b in (blocks, bent))
    if ending == "ply":
        return ply.write(shapes(), "a wall").encode(), _ply_binary()
    if ending == "stl":
        return stl.write(shapes(), "a wall").encode(), _stl_binary()
    if ending == "json":
        return (compas.write(shapes(), "a wall").encode(),)
    if ending == "dat":
        return tuple(text.encode() for text in bodies())
    if ending == "dxf" and importlib.util.find_spec("ezdxf"):
        control = shapes()[2].vertices.mean(axis=0).tolist()
        solids = _short(dxf.write(shapes(), "a wall", control))
        return (solids.encode(), *(text.encode() for text in _dxf_of_the_plane()))
    if ending == "ifc" and importlib.util.find_spec("ifcopenshell"):
        return (_IFC.encode(),)
    return ()


@cache
def scripts(ending: str) -> tuple[bytes, ...]:
    """Files of UDEC, 3DEC and LMGC90 as we write them."""
    from drystone.io.convert import target_of
    from drystone.io.modelfile.read import model_from_text

    found = []
    names = ("wall",) if ending == "dat" else ("space",) if ending == "3ddat" else ("wall", "space")
    for name in names:
        model = model_from_text(MODELS[name], source=None, sha256="")
        found.append(target_of(f"a.{ending}").write(model, f"a.{ending}").text.encode())
    return tuple(found)


def of_history(name: str) -> str:
    """A model whose control point goes where a file says."""
    return MODELS["plane"] + f'[control]\nhistory = "{name}"\n'


def importing(name: str, dimension: int) -> str:
    """A model that imports a file."""
    up = 'up = "z"\n' if dimension == 3 else ""
    data = f'[[import]]\nfile = {json.dumps(name)}\nunit = "m"\nsupport_below = -0.1\n{up}'
    thickness = "" if dimension == 3 else "thickness = 1.0\n"
    push = PUSH_IN_SPACE if dimension == 3 else PUSH
    return f"dimension = {dimension}\n{thickness}" + LAW + data + push


def copied(data: Any) -> Any:
    """A table of one's own."""
    return copy.deepcopy(data)
