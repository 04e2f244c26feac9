"""The register of numbers: every tolerance and threshold of the rooms that compute, by subject.

``tests/unit/test_numbers.py`` holds every float literal of these rooms to this file or to a short
list of exact numbers.  Kernels take the constants here as constants of theirs, at no cost.

**Scales.** Engines work in a frame of their own (`engines.frame`): the smallest block is 0.175 m,
the heaviest material weighs 10 kN/m3, gravity is one.  A number in metres or seconds means these;
all others are over what the comment names.

**Where a number is from.** Each comment says one of these:

- *Derived*: it follows from something, which is named.
- *Range*: halved and doubled, by itself or with those beside it, on even seeds of random structures
  (12 plane structures and 6 solids, ``benchmarks/robustness.py --seeds 0:24:2`` and ``0:12:2``):
  what that changes.  *Calm* means peaks by less than 1e-4 and steps by less than 1 %, *the same*
  no bit of any curve.
- *Convention*: what a word means; another number would mean something else.
- *Not measured*: nobody knows more than that it works.

Run one otherwise with ``python benchmarks/robustness.py --set tolerances.NAME=VALUE``; what follows
from it follows.
"""

import math

# Roundings ---------------------------------------------------------------------------------------

#: Relative change of an iterate under which it changes no more.
#: Derived: four and a half roundings of 2.2e-16.
LAST_DIGIT = 1e-15

#: What sums leave, over their largest term.
#: Derived: 4,500 roundings of 2.2e-16, of terms as many as a block has corners, edges or contacts.
SUMS = 1e-12

#: What places and shapes are off by, over their size.  Far above what is left of sums with places
#: a hundred blocks away (1e-12 to 1e-11), far below what anyone draws or builds.
#: Derived: of a drawing in a national grid, 5e5 m off with corners in double precision, 1e-10 m.
ROUNDING = 1e-9

#: Of what is drawn, over its size: files hold places to about this.
#: Derived: six digits, as most formats write them; a micrometre in a metre.
DRAWN = 1e-6

#: Least divisor where a size may be zero.  Derived: its square can still be held.
TINY = 1e-30

#: Angle [rad] under which the rotation's series stands for its sine.
#: Derived: the next term of the series, angle^4 / 3840, is then below any rounding; the root of it.
SMALL_ANGLE = 1e-8

# Geometry: shapes as drawn -----------------------------------------------------------------------

#: Lengths, areas, volumes and turns that are none, over those of the block.  Derived: a rounding.
DEGENERATE = ROUNDING

#: Of volumes of parts of a block that are joined again, over the whole.  Derived: a hundredth of
#: what is none, as a block may have a hundred parts.
PART_DEGENERATE = 0.01 * DEGENERATE

#: Gap, over the size of the smaller of two blocks, up to which they touch: the one tolerance of
#: joints as designed.  In a dry wall it is of the order of what joints close by under the weight
#: above them.  What a drawing leaves open beyond it is closed before, see `model.construction.fit`.
#: Convention.
TOUCHING = 1e-4

#: Distance, over the smallest extent of a block, within which faces lie near each other without a
#: joint, and a check says so.  Convention.
MISSED_GAP = 0.05

#: Share of the smaller face that must lie near the other one, so that it is no mere edge.
#: Convention.
MISSED_SHARE = 0.05

#: Distance, over the size of a solid, up to which a vertex lies in the plane of a face.  Drawings
#: are rounded; a face that is flat to a micrometre per metre is flat for masonry.
#: Derived: `DRAWN`.
FLAT = DRAWN

#: Share of `FLAT` to which mended faces must be flat.  Derived: ten times as good as is asked for.
MENDED_FLAT = 0.1 * FLAT

#: Distance, over the tolerance of flat faces, up to which a vertex lies on a plane that cuts.
#: Not measured.
SNAP = 0.1

#: Distance, over the size of a block, up to which its parts lie on each other.  Derived: `DRAWN`.
SEAM = DRAWN

#: Share of an edge, from either end, within which no point is put on it: it is the end then.
#: Derived: `DRAWN`.
EDGE_END = DRAWN

#: Distance, over the size of what is drawn as one, up to which points are written twice.
#: Derived: `DRAWN`.
SAME_POINT = DRAWN

#: Overlap over the size of the smaller part that is not cut away.
#: Derived: half of what checks let pass, `DRAWN`.
NO_OVERLAP = 0.5 * DRAWN

#: Angle [rad] by which a face seen from an edge may lie behind another and still be the last to be
#: turned to.  Derived: `DRAWN`; no solid is as thin.
ON_ITSELF = DRAWN

#: Vertices nearer than this share of the tolerance times the size of their solid are one.
#: Not measured.
WELDED = 0.05

#: Share of the tolerance up to which faces that meet are one.  Not measured.
ONE_FACE = 0.5

#: By how much farther than two faces stand in each other vertices beside what they share may move.
#: Not measured.
TILTED = 2.0

#: Width of what two faces share, over the distance by which they may be apart, from which on they
#: were meant to lie on each other: less is where two planes of one neighbour meet.  Not measured.
WIDE = 4.0

#: By how much farther than to a point vertices go so that edges run straight through it, over the
#: distance at which points were found: a bed bends only where it was drawn bent by more than the
#: drawing is off.  Range: from 2 on straight beds of `tests/elevations.py` have no bends, whatever
#: the noise; at 1 they have up to 28.
STRAIGHT_EDGE = 2.0

#: A cut that meets an edge under less than this angle [rad] makes a needle, and is the last choice.
#: Not measured.
NEEDLE = math.radians(15.0)

#: Cosine between the normals of triangles of a fan below which one lies on the other: 11 degrees.
#: Not measured.
FOLDED = -0.98

#: Cosine between normals from which on faces that meet look the same way: 45 degrees.
#: Not measured.
SAME_WAY = 0.7

#: Cosine between the normals of faces of two blocks above which they do not lie on each other: less
#: than 154 degrees between them.  Not measured.
OPPOSED = -0.9

#: Cosine between planes up to which a vertex of one is not put into the other: 30 degrees.
#: Not measured.
ALONG_PLANE = 0.87

#: Corners of faces nearer than this share of the tolerance are one.  Not measured.
SAME_CORNER_OF_FACE = 1e-3

#: Of the planes that a vertex is put into: weight of equations that say the same twice, over that
#: of motions.  Derived: it keeps them solvable, and is far below `DRAWN`.
SPARE = ROUNDING

#: Likewise of lines.  Derived: a tenth of it, as lines are met to `LAST_DIGIT`.
SPARE_IN_LINE = 1e-10

#: Distance from a line, over the size of everything, beyond which it cannot be had.
#: Derived: what sums leave.
OFF_LINE = SUMS

#: Weight of the motion of a vertex that is held, over that of others.  Not measured.
HELD_VERTEX = 1e-3

#: Share of what was missed that a further iteration must be better than.  Not measured.
BETTER = 0.9

#: Sine of the angle under which two edges have no axis of their own.  Derived: `DRAWN`.
PARALLEL_EDGES = DRAWN

#: Off-diagonal terms of a tensor of inertia, over its largest, that are rounding.  Derived: of sums
#: over faces, 450 roundings of 2.2e-16.
ALIGNED = 1e-13

#: A direction that is nobody's edge, by which points are sorted.
#: Derived: 1 / 2, the golden section and the root of 3 less one have no ratio that is a fraction.
NOBODYS_EDGE = (0.5, 0.6180339887, 0.7320508076)

# Contact: detection ------------------------------------------------------------------------------

#: Least tributary length or area of a contact, over that of the shorter edge or smaller face.
#: Not measured.
LEAST_FACE = 0.01

#: Margin of the broad phase, over the smallest extent of a block.  A matter of speed only.
#: Not measured.
MARGIN_SHARE = 0.25

#: Where two edges of a block are opposed to a face almost alike, the tributary length passes from
#: that of the one to that of the other, over this share of the turn from either to the corner on
#: end: 0.2 of a square corner are the angles from 37 to 53 degrees.  Not measured.
PASSAGE = 0.2

#: Sharp corners nearer than this share of their edges' lengths count as one.  Not measured.
SAME_CORNER = 1e-3

#: Rounded vertices, or rims, nearer than this share of the sum of their radii have no direction
#: from one to the other.  Not measured.
DEEP = 0.1

#: Edges count where they separate the parts by this share of their size more than faces do.
#: Not measured.
EDGES_MARGIN = 1e-2

#: An edge that lies on a face but for less than this angle [rad] rests on it at both of its ends.
#: Not measured.
EDGE_FLAT = 0.05

#: An incident face with a cosine below this to the reference face is seen edge on.  Not measured.
EDGE_ON = 0.05

#: Faces are kept while others separate the parts by no more than this share of their size more, or
#: are more opposed by no more than this.  Not measured.
HELD_FACE = 1e-3

#: Faces that separate the parts by this share of their size less do so alike: more than the
#: rounding of places, and less than a gap that a drawing means.  Derived: `DRAWN`.
TIED = DRAWN

#: Where parts meet in an edge or a point alone, another face separates them as soon as it does so
#: by this share of their size more than the present one.  Such parts may come apart along each of
#: these faces' normals.  If the face were kept as flush ones are (`HELD_FACE`), it would hold parts
#: that slide past each other: two stones on two, head joints in line, carried a tenth to a half
#: more.  Derived: a rounding.
EDGED = ROUNDING

#: Corners nearer to a vertex than this share of the smaller face's width are the vertex.
#: Not measured.
CLIP = 1e-3

#: Sides of an overlap shorter than this share of its width have one end only.  Not measured.
MERGE = 5e-2

#: Sine of the angle from which on a corner of an overlap adds a kite to what rounding edges takes.
#: Not measured.
TURNS = 1e-3

#: Edges with a smaller sine between them are parallel: they meet along a face's side.
#: Not measured.
PARALLEL = 1e-3

#: Of the edges' length: nearest points are on the common normal but for this.  Derived: `DRAWN`.
ON_NORMAL = DRAWN

#: A history goes on at a point no farther than this share of the root of the interface's area.
#: Not measured.
SUCCESSOR = 0.35

# Joint law ---------------------------------------------------------------------------------------

#: Change of an iterate, over it, where it is the difference of two larger numbers.
#: Derived: ten times `LAST_DIGIT`.
LAST_DIGITS = 10.0 * LAST_DIGIT

#: A contact this near to its cone slides, where it is asked anew in every sweep or cycle: over its
#: friction.  Derived: a rounding, of sums of the same terms in another order.
AT_CONE = ROUNDING

#: A contact stays in the branch it came from when another is nearer by this share of its reactions
#: only: one that slides starts the next step on its cone to rounding.
#: Not measured.
BRANCH_TIE = 1e-8

#: A bond holds beyond its strength by this share of it: what is at its limit has not broken.
#: Not measured.
BOND_TIE = 1e-6

#: Margins that differ by less, over strengths, belong to bonds that break together, such as those
#: of mirrored blocks.  Derived: what bonds are known to, `BOND_TIE`.
TOGETHER = BOND_TIE

#: Strength by which a margin is measured at least, over the other strength of the bond.
#: Not measured.
LEAST_STRENGTH = 0.1

#: Faces that are drawn apart by less are as they were laid but for rounding [m].  Derived: over the
#: smallest block it is six times `ROUNDING`.
GRAZE = ROUNDING

#: Gap of a joint, over the smallest extent of a block, up to which it is built shut: it has a bond.
#: Derived: a rounding.
BUILT_SHUT = ROUNDING

#: How far a bond has softened when it is lost, as a power of e; as far a crushed joint may soften.
#: Derived: two billionths of its strength, e^-20, are less than what solutions are balanced to.
LOST = 20.0

#: Least slope of the equation for how far a bond has softened: where a joint would snap by itself
#: it is steeper.  Not measured.
LEAST_SLOPE = 1e-3

#: Share of the greatest closure that a tangent is made at, at most: beyond it the joint is rigid.
#: Derived: nearer to it than by a rounding, its stiffness has no digits.
NEARLY_SHUT = 1.0 - ROUNDING

#: Closure over the length of its law from which on a logarithmic one goes straight: by then it is
#: e^20 times as stiff.  Derived: as `LOST`; stiffer joints are rigid beside all others.
STRAIGHT_CLOSURE = LOST

#: Angles of friction in space are found to this [rad].  Derived: a rounding.
FRICTION_ANGLE = ROUNDING

#: Share of the crushing force that Newton's method for the normal reaction begins below.
#: Derived: it converges from anywhere between, as steps outside are halved.
BELOW_CRUSHING = 0.75

#: A central slide is found to this, over the most that it can be.  Derived: what sums leave.
CENTRAL_SLIDE = SUMS
