"""The register of numbers: every tolerance and threshold of the packages that compute, by subject.

``tests/unit/test_numbers.py`` checks that every float literal of these packages is in this file, or
in a short list of exact numbers.  Kernels are compiled with these constants, at no cost.

**Scales.** Engines work in a frame of their own (`engines.frame`): the smallest block is 0.175 m,
the heaviest material weighs 10 kN/m3, and times are those of blocks of this size.  Numbers in
metres or seconds are in this frame.  All other numbers are over the quantity that the comment
names.

**Where a number is from.** Each comment says one of these:

- *Derived*: it follows from something, which is named.
- *Range*: what changes if the number is halved and doubled, or changed as the comment says.  For
  engines and controls, random structures were calculated with `equilibrium`: 12 in the plane, and
  10 in space, 6 solids and 4 arches (``benchmarks/robustness.py``, seeds 0:24:2, 0:12:2, 0:8:2).  A
  number has *no effect* if it changes peaks by less than 1e-4 of themselves, and the sum of steps
  by less than 1 %, in the plane and in space.  With steps of the default length, peaks in space are
  known to some 2e-3: a number that changes where points lie changes peaks by that.
  These ranges were measured before plane and space shared one static step.  Later ones name *the
  solids*: 24 structures in space, of 12 kinds, seeds 8 and 10.  No peak moves by 1e-4 in a range of
  the solids, unless the comment says so.  Ranges *by* `distinct` are of 3 plane structures, seeds
  8, 10 and 12.  Ranges *of 27 in the plane* are of all 14 kinds in the plane, seeds 8 and 10, but
  `tied-plane` 10; those *of 33 in space* of 20 kinds, likewise, but domes, `box` 10, `corner` 8,
  `leaves` 10, `mortar` 8 and `tower` 8.  Those *of 16 rounded* are of eight kinds in the plane and
  eight in space, seed 8, with corners rounded to 3 % of their smallest block.  If a structure is
  *the same*, its peak, end, steps and iterations are.
  Ranges *of 7 by* `nscd` are of `plane` 8, 10 and 12, `arches-plane` 10, `plateband-plane` 8,
  `portal-plane` 10 and `solids` 8.  Iterations are those of all of them; peaks are those of the
  first five.  Those of the others move by up to 1.2e-2 and 5.6e-3 with nearly all numbers that
  change their steps at all.  With `EXCESS` 1 % larger, a peak moves by 2.2e-4, iterations by 6.5 %
  and steps by 2.3 %: less says nothing.
  Ranges *of 10 with supports that move* are of `arches-plane` 8 and 10, `portal-plane` 8,
  `plateband-plane` 8, `plane` 8 and 10, `leaning-plane` 10, `arches` 10, `arch` 10 and `solids` 8,
  one support of which moves or, if there is one only, turns.
  Ranges *of 12 with brittle bonds* are of eight kinds in the plane and four in space, seed 8, with
  cohesion and tensile strength of 0.6 and 0.4 of a pressure of 20 kN/m3 times their height; those
  *of 12 with weak tension* of the same, but half of them with 0.03 of it and half with none; those
  *of 11 with mortar* of `bonded` 8 to 14, `bonded-space` 8 to 12, `mortar-plane` 8 to 12, even
  seeds, and `mortar` 10.
  Ranges *of 8 as published* are of the published wall 1, `plane` 8, 10 and 12, `portal-plane` 10,
  `arches-plane` 10, `plateband-plane` 8 and `solids` 8, by `equilibrium` with the published
  strategy.
  Ranges *of 55 meshes* are of drawings by others (a wall, domes, arches, vaults, a shelf), read in
  15 ways; of walls and domes of `tests/drawn.py`, rounded; and of ten kinds in space, seed 8, as
  they are, and off by 0.5 and by 1 mm, in triangles and rounded.  Ranges *of 310 outlines* are of
  ten elevations, drawn by hand, and 300 random ones that are concave.
- *Convention*: the number defines the meaning of a word.
- *Not measured*: it is only known that the number works.

To try another value, run ``python benchmarks/robustness.py --set tolerances.NAME=VALUE``.  Numbers
that are calculated from NAME change with it.
"""

import math

# Roundings ---------------------------------------------------------------------------------------

#: Relative change of an iterate below which it counts as converged.
#: Derived: four and a half roundings of 2.2e-16.
LAST_DIGIT = 1e-15

#: Rounding of sums, over their largest term.
#: Derived: 4,500 roundings of 2.2e-16, of terms as many as a block has corners, edges or contacts.
SUMS = 1e-12

#: Error of places and shapes, over their size.  It is far above the rounding of sums with places a
#: hundred blocks away (1e-12 to 1e-11), and far below the accuracy of drawings.  Derived: of a
#: drawing in a national grid, 5e5 m off with corners in double precision, 1e-10 m.  Range: peaks by
#: 1.2e-6, steps by 0.1 %; but for one solid, which falls in motion in 19 % fewer steps if doubled.
ROUNDING = 1e-9

#: Error of drawn places, over the size of what is drawn: files contain places to about this.
#: Derived: six digits, as most formats write them; a micrometre in a metre.
DRAWN = 1e-6

#: Least divisor where a size may be zero.  Derived: its square is still a number.
TINY = 1e-30

#: Angle [rad] under which the rotation's series stands for its sine.
#: Derived: the next term of the series, angle^4 / 3840, is then below any rounding; the root of it.
SMALL_ANGLE = 1e-8

# Geometry: shapes as drawn -----------------------------------------------------------------------

#: Lengths, areas, volumes and angles that count as zero, over those of the block.
#: Derived: a rounding.
DEGENERATE = ROUNDING

#: Volume of a part of a block that counts as zero, over the block's.  Derived: a hundredth of
#: `DEGENERATE`, because a block may have a hundred parts.
PART_DEGENERATE = 0.01 * DEGENERATE

#: Gap, over the size of the smaller of two blocks, up to which they touch: the only tolerance of
#: joints as designed.  In a dry wall, joints close by about as much under the weight above them.
#: Larger gaps of a drawing are closed before, see `model.construction.fit`.  Convention.
TOUCHING = 1e-4

#: Distance, over the smallest extent of a block, up to which a check reports two faces that are
#: near each other without a joint.  Convention.
MISSED_GAP = 0.05

#: Share of the smaller face that must lie near the other face for such a report.  Convention.
MISSED_SHARE = 0.05

#: Distance, over the size of a solid, up to which a vertex lies in the plane of a face.  Drawings
#: are rounded; a face that is flat to a micrometre per metre is flat for masonry.
#: Derived: `DRAWN`.
FLAT = DRAWN

#: Share of `FLAT` to which mended faces must be flat.  Derived: ten times as flat as required.
MENDED_FLAT = 0.1 * FLAT

#: Distance, over the tolerance of flat faces, up to which a vertex lies on a plane that cuts.
#: Range, ten times more or less: 55 meshes are the same, but one with 0.01 in 48 parts, not 46.
SNAP = 0.1

#: Distance, over the size of a block, up to which its parts lie on each other.  Derived: `DRAWN`.
SEAM = DRAWN

#: Share of an edge, from either end, within which a point counts as the end.  Derived: `DRAWN`.
EDGE_END = DRAWN

#: Distance, over the size of what is drawn as one, up to which two points are the same.
#: Derived: `DRAWN`.
SAME_POINT = DRAWN

#: Overlap over the size of the smaller part that is not cut away.
#: Derived: half of what checks let pass, `DRAWN`.
NO_OVERLAP = 0.5 * DRAWN

#: Angle about an edge [rad] below which two faces lie on each other.  Derived: `DRAWN`; no solid is
#: as thin.
ON_ITSELF = DRAWN

#: Distance below which two vertices are one, over the tolerance times the size of their solid.
#: Range, from 1e-9 to 0.1: 55 meshes and 310 outlines are the same.
WELDED = 0.05

#: Share of the tolerance up to which faces that meet are one.  Range: volumes of 55 meshes and 310
#: outlines by 1.2e-4, areas of joints by 2e-3, but of rubble off by 0.5 mm by 2.6 % where halved;
#: solids that were off have 64 % more parts at most where halved, 31 % less where doubled.
ONE_FACE = 0.5

#: Motion of vertices outside the area that two faces share, over the distance by which these
#: overlap, up to which it is allowed.
#: Range, from 1 to 100: 55 meshes are the same, but a tower with 1: its joints have 2e-4 less area.
TILTED = 2.0

#: By how much farther than to a point vertices go so that edges run straight through it, over the
#: distance at which points were found: a bed bends only where it was drawn bent by more than the
#: drawing is off.  Range: from 2 on straight beds of `tests/elevations.py` have no bends, whatever
#: the noise; at 1 they have up to 28.
STRAIGHT_EDGE = 2.0

#: Angle between a cut and an edge [rad] below which the cut makes a needle, and is the last choice.
#: Range: of 310 outlines, 41 are cut elsewhere where halved, none in more parts; where doubled, 83,
#: nine of them in other numbers of parts.
NEEDLE = math.radians(15.0)

#: Cosine between the normals of faces of two blocks above which they do not lie on each other: less
#: than 154 degrees between them.  Range, from 120 to 172 degrees: 55 meshes are the same.
OPPOSED = -0.9

#: Cosine between planes up to which a vertex of one is not put into the other: 30 degrees.
#: Range, 15 and 60 degrees: 31 of 55 meshes are the same; volumes by 1.4e-4, areas of joints by
#: 1e-3, but that of a vault with 15 degrees by 4 %, in 27 % more joints.
ALONG_PLANE = 0.87

#: Corners of faces nearer than this share of the tolerance are one.  Range, ten times more or less:
#: areas of joints of 55 meshes by 4e-7.
SAME_CORNER_OF_FACE = 1e-3

#: Of the planes that a vertex is put into: weight of equations that say the same twice, over that
#: of motions.  Derived: it keeps them solvable, and is far below `DRAWN`.
SPARE = ROUNDING

#: Likewise of lines.  Derived: a tenth of it, as lines are met to `LAST_DIGIT`.
SPARE_IN_LINE = 1e-10

#: Distance from a line, over the size of everything, beyond which a point cannot be put onto it.
#: Derived: what sums leave.
OFF_LINE = SUMS

#: Weight of the motion of a fixed vertex, over that of other vertices.  Range, ten times more or
#: less: volumes of 55 meshes by 1e-6, areas of joints by 7e-8, the farthest motion by 1.1e-4 of it.
FIXED_VERTEX = 1e-3

#: Error after an iteration, over that before it, above which iterations end.  Range, 0.8 and 0.95:
#: 53 of 55 meshes are the same, the areas of their joints by 6e-7.
BETTER = 0.9

#: Sine of the angle between two edges below which they have no common normal.  Derived: `DRAWN`.
PARALLEL_EDGES = DRAWN

#: Off-diagonal terms of a tensor of inertia, over its largest, that are rounding.  Derived: of sums
#: over faces, 450 roundings of 2.2e-16.
ALIGNED = 1e-13

#: A direction that is nobody's edge, by which points are sorted.
#: Derived: 1 / 2, the golden section and the root of 3 less one have no ratio that is a fraction.
NOBODYS_EDGE = (0.5, 0.6180339887, 0.7320508076)

# Contact: detection ------------------------------------------------------------------------------
#
# All of these that are not derived, but `LEAST_FACE`, doubled together: peaks of the plane by 4e-11
# and steps by 0.5 %; in space, peaks of solids by 2e-5, those of two arches by 1.3e-4 and by 7e-3
# (`arch` 6).  With the step that plane and space share, the peak of `arch` 6 moves by 1.7e-5.

#: Tributary area of a contact of two edges, over that of the smaller face; and least overlap of two
#: faces, over the same, that counts as more than a line.  In space only.
#: Range, doubled: a peak by 2.6e-3 and the end by 11 %, of a solid that falls in motion (`solids`
#: 2), all others the same.
LEAST_FACE = 0.01

#: Least tributary length of a contact over that of the shorter edge, in the plane: of edges that
#: overlap by a point only, as do those of blocks that meet corner on corner.  Such blocks have no
#: joint there.  A block that slides on to the next block of its course is held back by about this
#: share of its weight.
#: Range, 1e-2 and 1e-4: the peak of a block that slides over a joint right below its front is
#: 1.009 and 1.0001 times friction (1.0007), peaks of two walls are 1.04 and 1 times as high.  With
#: 1e-4 a tenon jams in its fall, and a block that topples finds no rest.
LEAST_LENGTH = 1e-3

#: Least tributary area of the contacts of two faces over that of the smaller face, in space.
#: Range, 1e-3 and 1e-5: the peak of such a block by 2e-3; with 1e-3 it is 3.5 % too high at 1e12
#: Pa/m, because faces are equally good within 1e-6 of the size of blocks (`TIED`).
LEAST_AREA = 1e-4

#: Margin of the broad phase, over the smallest extent of a block.  It affects the speed, and the
#: order of contacts.  Range: iterations of 27 in the plane by 1.1 %, the peak of one by 1.4e-4;
#: those of 33 in space by 1 %, no peak by 1e-7.
MARGIN_SHARE = 0.25

#: If two edges of a block are almost equally opposed to a face, the tributary length passes
#: smoothly from that of one edge to that of the other.  This is the share of the rotation, from
#: either edge to the corner on end, over which it passes: 0.2 of a square corner are the angles
#: from 37 to 53 degrees.  Range: peaks of 27 in the plane by 7.5e-6, iterations by 1.3 %.
PASSAGE = 0.2

#: Sharp corners nearer than this share of their edges' lengths count as one.  Guards joints that
#: end flush, tilted by a little: within the tilt times the gap, neither corner lies within the
#: other's edge, and a bond or a reaction there would be lost.  Range, from 0 to 0.1: 27 in the
#: plane and 16 rounded are the same.
SAME_CORNER = 1e-3

#: Distance of the cores of rounded vertices, or rims, over the sum of their radii, below which the
#: direction from one to the other is not used.  Guards cores that coincide or have passed each
#: other, as those of corners rounded by less than their joint closes by: they have no direction, or
#: the opposite one, and slips would be enlarged without limit.  Range, from 0 to 0.2: 27 in the
#: plane and 16 rounded are the same.
DEEP = 0.1

#: Distance, over the size of the parts, by which edges must separate them more than faces do.
#: Range: 33 in space and 16 rounded are the same.  With 0, the rounded are, too, but the 33 take
#: more than ten times as long.
EDGES_MARGIN = 1e-2

#: Angle between an edge and a face, or between two rounded edges [rad], below which they touch
#: along a line, at both of its ends.  Range: 27 of 33 in space and 13 of 16 rounded are the same,
#: no peak moves; iterations by 37 % where halved, all of one with bonds.  With 0, the peak of a
#: rounded flat arch is less than half.
EDGE_FLAT = 0.05

#: Faces are kept as long as the separation by other faces is larger by no more than this share of
#: the parts' size, or their cosine is better by no more than this.  Range: 32 of 33 in space, peaks
#: by 9e-5, the peak of a vault (`vault` 10) by 4.1e-3; iterations by 1.3 %.
KEPT_FACE = 1e-3

#: Difference of separation, over the parts' size, up to which two faces are equally good: more than
#: the rounding of places, and less than an intended gap of a drawing.  Derived: `DRAWN`.
TIED = DRAWN

#: If parts meet in an edge or a point only, another face is chosen as soon as its separation is
#: larger by this share of their size.  Such parts may come apart along the normals of each of these
#: faces.  If the face were kept as long as flush faces are (`KEPT_FACE`), it would restrain
#: parts that slide past each other: two stones on two, head joints in line, carried a tenth to a
#: half more.  Derived: a rounding.
EDGED = ROUNDING

#: Corners nearer to a vertex than this share of the smaller face's width have its name; and
#: overhang up to which faces without an overlap touch.  Range: peaks of 36 in space are the same to
#: 1e-4, but for those of `vault` 10 where halved, by 1.4e-3, and of `corner` 8 and `loaded` 8 where
#: doubled, by 1e-3 and 3e-4.  Iterations by 5 %, without `corner` 8, which is long in motion.
CLIP = 1e-3

#: Sides of an overlap shorter than this share of its width have one end only.  Range: peaks of 33
#: in space by 5e-5, of a rounded flat arch by 2e-4; iterations by 6 % where doubled.
MERGE = 5e-2

#: Slope of one face over the other along such a side above which the end remains where the faces
#: are nearer to each other.  Range: peaks of 33 in space by 9e-6, iterations by 1.6 %.
SIDE_SLOPE = 1e-3

#: Share of `MERGE` below which a side is removed if both of its ends were points before.  Range,
#: halved:
#: peaks of vaults and stairs the same, steps by 2 %; but for a vault that falls in motion, which
#: ends 1e-4 m sooner, in 17 % fewer steps.
MERGED_AGAIN = 0.5

#: Sine of the angle between two edges below which they are parallel: edges of two blocks then make
#: no contact by themselves, and sides of an overlap do not meet.  Guards edges that are parallel
#: but for rounding, as most of masonry are: they have no common normal, no point where they are
#: nearest, and none where they meet.  Range, from 0 to 0.01: 33 in space and 16 rounded are the
#: same, or their peaks.
PARALLEL = 1e-3

#: Distance of nearest points of two edges from their common normal, over the length of the edge, up
#: to which they lie on it.  Derived: `DRAWN`.
ON_NORMAL = DRAWN

#: Distance within which a contact may inherit a history, over the root of the interface's area.
#: Range: 32 of 33 in space are the same, iterations of the other by less than 1 % of all.
SUCCESSOR = 0.35

# Joint law ---------------------------------------------------------------------------------------

#: Change of an iterate, over it, where it is the difference of two larger numbers.
#: Derived: ten times `LAST_DIGIT`.
LAST_DIGITS = 10.0 * LAST_DIGIT

#: Distance to the friction cone, over the friction, below which a contact slides, if this is
#: decided anew in every sweep or cycle.  Derived: a rounding, of sums of the same terms in another
#: order.
AT_CONE = ROUNDING

#: Share of a contact's reactions by which another branch must fit better before the contact leaves
#: its branch.  It is needed because a contact that slides starts the next step on its friction
#: cone, but for rounding.
#: Range, ten times more or less: iterations of the solids by 1 %, and of 22 structures of the plane
#: by 0.6 %, no capacity by 1e-4.  In one of these a part falls at a third of the peak, or does not.
BRANCH_TIE = 1e-8

#: Excess over the strength, over it, at which a bond is still intact.
#: Derived: a rounding, because margins already contain the accuracy of reactions.  The excess is
#: left unbalanced: with 1e-6, 20 points of 28 with brittle bonds leave more than 1e-8 of the
#: heaviest weight, with this number none, and the peaks are the same.
BOND_TIE = ROUNDING

#: Difference of margins, over strengths, up to which bonds break together, such as those of
#: mirrored blocks.  Range, ten times more or less, with `BOND_TIE` as large, of 12 with brittle
#: bonds: peaks by 4e-5, iterations by 0.7 %.
TOGETHER = 1e-6

#: Least strength that a margin is measured over, over the other strength of the bond.
#: Range: 12 with brittle bonds are the same, as both of their strengths are near each other; of 12
#: with weak tension, peaks by 1.4e-6, an end by 56 % and iterations by 9 % where halved.
LEAST_STRENGTH = 0.1

#: Gap [m] up to which faces are closed but for rounding.  Derived: over the smallest block it is
#: six times `ROUNDING`.
GRAZE = ROUNDING

#: Gap of a joint, over the smallest extent of a block, up to which it is built shut: it has a bond.
#: Derived: a rounding.
BUILT_SHUT = ROUNDING

#: Exponent of softening at which a bond is lost, and up to which a crushed joint softens.
#: Derived: the remaining strength, e^-20 or two billionths, is less than the tolerance of balance.
FULLY_SOFTENED = 20.0

#: Least slope of the equation of softening of a bond, and of falling friction.  Guards joints that
#: snap back: under a high pressure, friction falls by more than the shear that the slip releases,
#: and the slope would be zero or less.  Range, from 0 to 0.01: 11 with mortar are the same.
LEAST_SLOPE = 1e-3

#: Largest closure, over the greatest one, at which a tangent is taken; beyond it the joint counts
#: as rigid.  Derived: nearer to the greatest closure, rounding leaves no digits of the stiffness.
NEARLY_SHUT = 1.0 - ROUNDING

#: Closure, over the length of its law, above which a logarithmic closure is continued linearly: the
#: joint is then e^20 times as stiff.  Derived: as `FULLY_SOFTENED`; stiffer joints are rigid beside
#: all others.
STRAIGHT_CLOSURE = FULLY_SOFTENED

#: Angles of friction in space are found to this [rad].  Derived: a rounding.
FRICTION_ANGLE = ROUNDING

#: Largest start of Newton's method for the normal reaction, over the crushing force.
#: Derived: it converges from anywhere in the interval, because steps that leave it are halved.
BELOW_CRUSHING = 0.75

#: Products of a pair, and of a normal reaction and its slack, over the same on the central path,
#: below which the contact is centred anew.  Range: halved and doubled, iterations of the solids by
#: 2.4 %.
CENTRAL = 1e-2
CENTRAL_NORMAL = 1e-3

#: Least share of its value that a normal reaction or its slack keeps in an iteration.  Range:
#: halved and doubled, iterations of the solids by 4 %.
KEPT = 1e-2

#: Least distance of a pair to the boundary of its cones, over their size.  With a smaller distance,
#: a long slip would be lost in rounding.  Without a barrier, reactions are wrong by no more than
#: this; those of the joint law itself are exact.  Range: ten times more or less, iterations of the
#: solids by 0.2 %.
LEAST_DISTANCE = 1e-10

#: Friction limit over the slack of the normal reaction, below which a contact counts as open and
#: slides freely.  Range: halved and doubled, iterations of the solids by 4 %.
OPENING = 1e-2

#: Slip over its former value, below which a contact may stick again; and friction over its limit,
#: above which its direction counts.  Range: halved and doubled, iterations of the solids by 1.1 %.
STICKS_AGAIN = 0.1
TURNING_FRICTION = 0.3

# Control: when a curve ends ----------------------------------------------------------------------

#: Load multiplier under which a curve ends, after its peak.  Convention.
STOP_MULTIPLIER = 0.01

#: Share of the peak under which a curve ends, if this is less and the model gives no stop value.
#: Convention: a slender wall carries 0.05, and assessment needs its whole branch down to zero.
STOP_SHARE = 0.1

#: Least load multiplier by which inertia is divided, in controls and engines.
#: Derived: a tenth of `STOP_MULTIPLIER`, below which no curve is followed.
LEAST_LOAD = 0.1 * STOP_MULTIPLIER

#: Multiplier of a load that turns the ground, above which the ground stands upright.  Convention:
#: it is that of 89.94 degrees.
UPRIGHT = 1e3

#: Share of a peak below the stop value to which the curve is followed: blocks that come loose let
#: a multiplier drop and rise again, though not from next to nothing.  Convention.
NEXT_TO_NOTHING = 0.01

#: Motion of a block under next to no load, over the displacement step that suits the structure
#: (`control.ends.StepSettings.motion_length`), after which the structure has collapsed.
#: Convention: an eighth of the smallest block by `published`, half of it or more by `equilibrium`.
#: Range: no peak; plane: the same; space: steps by 1.4 %.
FALL_MOTION = 25.0

#: Least motion of a step, over the largest increment, by which step lengths are divided.
#: Derived: far below the least share of a step.
LEAST_MOTION = 1e-3

#: Penetration of two blocks in motion, over the smallest block, above which one has passed through
#: the other.  Derived: beyond half of the block, the nearest face is the one on the far side.
PASSED_THROUGH = 0.5

# Control: static steps of a displacement ---------------------------------------------------------

#: Accuracy of a curve, over its peak.  Convention: points every 2e-4 of the peak describe it.
#: Range, doubled: peaks by 2.7e-4, as expected, and steps by -2.8 %.
PEAK_SHARE = 2e-4

#: Change of the multiplier at a snap, over the peak, up to which a step may pass over it.
#: Derived: the accuracy of a curve.
SNAP_SHARE = PEAK_SHARE

#: Least multiplier to which shares of the peak refer: not of the stop value that is asked for, so
#: that a curve does not depend on where it is to end.  Range: plane: the same.  Space: a peak by
#: 1.3e-3 where doubled, steps by 0.6 %.
LEAST_PEAK = 10.0 * STOP_MULTIPLIER

#: Least reaction of moving supports to which shares of the largest reaction refer, over the
#: heaviest weight (times the smallest block if supports rotate).  If blocks only ride along, the
#: reaction is rounding.  Derived: a hundredth of a weight, of which a bend is known as well as
#: curves are.
LEAST_REACTION = 0.01

#: First increment over the largest; of supports too.  Range: no effect.
FIRST_SHARE = 0.02

#: Smallest increment over the largest.  Range: a peak by 1.1e-4; plane, doubled: steps by -4.4 %.
FLOOR_SHARE = 0.01

#: Increment, over the smallest one, with which a place without equilibria is crossed, and with
#: which a curve goes on after a jump.  Range: peaks by 1.1e-4, steps by 0.9 %, of arches doubled by
#: 2.7 %; all curves end alike.  Measured with the step that plane and space share.
CROSSING_LENGTH = 4.0

#: Increment over the largest up to which a step may use the full search.  Range: no effect.
FULL_SEARCH_SHARE = 0.02

#: Increment of the first step of a jump over the largest.  Range: peaks by 8e-5, steps by 1.7 %;
#: where doubled, two curves end by more than 1 % elsewhere.
CREEP_SHARE = 0.001

#: Largest increment of creeping, over the first.  Range: no effect.
MOST_CREEP = 50.0

#: Smallest increment to a peak or a bend, over the largest increment or, with stiff joints, over
#: their closure; and the largest relative distance of the last point from the stop value.  Range: a
#: peak of the plane by 1.6e-4, one of space by 1.2e-3; steps by 1 and by 4.4 %.
REFINED_SHARE = 0.005

#: Smallest step to the stop value, over that of `REFINED_SHARE`.  Range: without it the same; it
#: ends the search for a stop value over which the curve jumps.
LEAST_CHORD = 1e-3

#: Smallest increment, over the closure of joints under the dead load.  Range: no effect; without
#: it, peaks by 7e-6.
CLOSING_SHARE = 0.1

#: Largest overshoot within a step, over the peak, if the step exceeds the peak; and the largest
#: excess of a step that passes the peak.  Range, by `distinct`: one peak (`plane` 8) by 4.4e-4, the
#: others the same; steps by -8 %, nearly all of that one.
OVERSHOOT_SHARE = 5e-3

#: Largest overshoot within any other step, over the peak.  Range, by `distinct`: no peak, steps by
#: 108 % where halved, by -10 % where doubled.
DRIVE_SHARE = 2e-2

#: Overshoot over `OVERSHOOT_SHARE` under which a step hides no peak; and under which steps grow as
#: fast as they may.  Range, by `distinct`: no peak; of the first, steps by -5 % where halved; of
#: the second, by 11 % where doubled.
NO_OVERSHOOT = 0.2
SMALL_OVERSHOOT = 0.05

#: Largest bend of the curve within a step, over the peak.  Range: plane: no effect.  Space, of 84
#: solids, doubled: a peak by 5.4e-3, and by 1.7e-2 one of a leaf that has many equilibria;
#: iterations up to the peak by -5 %.
BEND_SHARE = 2e-3

#: Bend at which the next step aims, over the largest bend.  Range, space: peaks by 1.9e-3, steps by
#: 1.4 %.
BEND_AIM = 0.6

#: Rise of the curve in a step, over that with its last slope, below which the step may hide the
#: peak.  It counts for engines that do not report excess and bend, as `distinct`.  Range, by
#: `distinct`: one peak (`plane` 8) by 3.2e-4, the others by 7e-5; steps by -5 %.
KINK = 0.1

#: Missing rise of a step, over `PEAK_SHARE`, below which the step hides nothing; and the factor by
#: which it is shortened otherwise.  For the same engines.  Range, by `distinct`: of the first, the
#: same; of the second, one peak (`plane` 8) by 1.1e-4, the others by 8e-6; steps by -6 %.
HIDES_NOTHING = 0.1
NEARER_TO_KINK = 0.4

#: Share of a step above which it is not worth repeating the step up to there; and share of the way
#: to a fold at which the repeated step ends.  Range, with the two numbers of a fold below, 0.96 and
#: 0.99: peaks by 3e-5; plane: steps by -4.6 %.
ALL_BUT = 0.98

#: Share of a step up to which a fold sets the length of the next trial; factor by which the step is
#: shortened otherwise; and share above which the slope to a fold is known.  Range: the first two
#: with
#: `ALL_BUT` (see there); the third the same.
FOLD_WITHIN = 0.9
SHORTER = 0.6
FOLD_KNOWN = 0.05

#: Largest deviation of a block from the predictor, over the farthest motion; bend of the curve,
#: over the peak, above which it counts; and length of a step, over the largest, above which it
#: counts. Range: plane: the same.  Space: the first doubled, a peak by 3.6e-4, steps by 3.1 %;
#: the second, no peak, steps by 3 %; the third, a peak by 1.1e-4, steps by -4.6 %.
DEVIATION_SHARE = 0.1
DEVIATION_BEND = 1e-4
DEVIATION_STEP = 0.06

#: Factor by which a step is shortened that has come to another branch: by a jump below the stop
#: value, to an unstable equilibrium, or away from the predictor.  Range, eleven
#: random structures: ten peaks by 3e-6 at most, that of a vault by 3.1e-4; points by 12 %.
LOOKED_AT_SHARE = 0.25

#: First time step of a jump [s].  Range: peaks by 4e-5; plane: steps by 2.2 %; space: by 11 % where
#: halved, by -5 % where doubled.
JUMP_TIME_STEP = 0.1

#: Largest load increment, over the highest multiplier so far, if the control point turns back
#: before the peak.  Range: no effect.
LOAD_SHARE = 0.05

#: Least time step of a jump over the first.  Range: no peak.
LEAST_JUMP = 1e-4

#: Growth of the time step of a jump.  Range, 1.25 and 2: peaks by 7e-5, steps by 2.8 %.
JUMP_GROWTH = 1.5

#: Acceleration of the fastest block in a step of a jump, over that in the last step, above which
#: the jump is not over.  Range, 1.005 and 1.02, plane: peaks of three of 112 curves by up to 5e-3,
#: because their jumps lead to different branches, all others the same; steps by 1.4 %.
NO_FASTER = 1.01

#: Time of a jump at which it may be over, over the time at which it last seemed to be over and was
#: not.  Derived: in a jump of time t, in steps of h at least, no more than log2 (t / h) static
#: steps are tried in vain, and rest is noticed after no more than twice its time.
LATER = 2.0

#: Time step with the supports held over the first, from which on the structure can be at rest.
#: Range, from 2.5 to 10: every closed form and every drawn arch within its bound; with 0.25 a
#: portal is called at rest where it begins to leave an unstable equilibrium.
LONG_ENOUGH = 5.0

#: Motion of a block, over the increment, above which a step is a jump.  Convention.  Range: no
#: peak; plane: the same; space: steps by 1.6 %.
SNAP_MOTION = 10.0

#: Motion of a block in a step of a jump, over the displacement step that suits the structure, up to
#: which its time step grows; and over the largest increment, up to which a step may go in which no
#: motion is expected.  Range: no peak; plane: steps by 0.2 %; space: by 20 % where halved, by
#: -3.5 % where doubled.
JUMP_MOTION = 1.0

#: Motion of a block in a step of a jump, over that with the acceleration of the last step, above
#: which the step is tried again with half of the time step, if it is also larger than
#: `JUMP_MOTION`.  Range, 2 and 10, with two lengths of steps: no peak of an arch; with 10 its end
#: by 4 %.
FARTHER = 4.0

#: Inertia below which a step is static again: over the applied force (if supports move, over the
#: weight), and, of the fastest block, over its weight.  Convention.  Range: no effect.
STATIC_INERTIA = 1e-3

# Control: cyclic analysis ------------------------------------------------------------------------

#: Distance from a target at which it counts as reached, over the displacement step: for engines
#: that prescribe displacements, and for those that step under a multiplier.  Derived: roundings;
#: for the latter, the residual of a step (`NSCD_RESIDUAL`) over the motion by an excess.
AT_TARGET = ROUNDING
AT_TARGET_OF_EXCESS = 1e-6

#: Least motion of the control point in a step, over that demanded, with which the step to a target
#: is asked for; its inverse is the most.  Range, half as much more or less: no effect, as a driven
#: step comes to 2 % of what is asked.
LEAST_GAIN = 0.5

#: Share of the way to a target by which a driven step aims short of it, so that it does not go
#: beyond.  Range, ten times more or less, of blocks that rock by `distinct`: energies are the same,
#: points by 3 %; with 1e-4 a target was passed by 5e-8 m.
SHORT_OF_TARGET = 1e-3

#: Displacement steps up to which a corner of a loop may be rounded off.  Range, ten times more or
#: less, by `nscd`: the energy of a block that slides to and fro is the same; the greatest
#: multiplier of a block that rocks, and of a stack of two, by 1e-5, points by 6 %.
CORNER = 1e-3

#: Least rise of the multiplier in a step with a corner, over the excess; and the share by which the
#: repeated step exceeds the rise.  This share moves the structure past its corner, which the chord
#: of the step then cuts off.
#: Range, by `nscd`: the energy of a block that slides to and fro by 0.01 m is 1.6e-6 too little
#: with 1e-3, 1.5e-7 with 1e-4, 4e-9 too much with 3e-5; 1e-5 takes a third more steps.
LEAST_RISE = 3e-5

#: Least distance of the next trial from two trial excesses, over their difference.  Range, ten
#: times more or less, by `nscd`, of the same: energies and multipliers by 1e-9.
LEAST_SHARE_TRIED = 0.01

# Control: excess over the static multiplier ------------------------------------------------------

#: Time step [s].  Range, of 7 by `nscd`: peaks by 7e-5, steps by 59 % where halved, by 13 % where
#: doubled, iterations by 26 %; the end of one arch by 59 %.
EXCESS_TIME_STEP = 0.1

#: Largest excess of the multiplier, over it where it is above one.  Range, of 7 by `nscd`: a peak
#: by 1.8e-4, steps by 12 % where halved, iterations by 18 % where doubled.
EXCESS = 0.01

#: First and least excess over the largest.  Range of the first, of 7 by `nscd`: a peak by 1.5e-4,
#: iterations by 8 %.  Of the second, 1e-4 and 0: no peak, iterations by 0.1 %.  It guards against
#: steps without end that apply next to nothing after a fall: with 0, a wall (`wall105` of
#: tests/cases) and a stack go on for 100,000 of them.
FIRST_EXCESS = 0.1
LEAST_EXCESS = 1e-5

#: Motion of the control point, over the displacement step that suits the structure, after which the
#: structure has collapsed: in motion with less than the stop value carried; and, by default,
#: whatever is carried.  Convention; derived: twice the smallest block.
EXCESS_FALL = 20.0
EXCESS_JUMP = 400.0

#: Difference of applied and static multiplier that is allowed beside the excess and the slope.
#: Range, of 7 by `nscd`: no peak, an end by 1.3 %, iterations by 0.1 %.
LOOSE = 5e-4

#: Motion of the control point over the fastest block's, above which the whole structure moves.
#: Range, of 7 by `nscd`: no peak; where doubled, two ends by 6 and 59 %; iterations by 6 %.
WITH_THE_REST = 0.25

#: Change of the static multiplier, over the difference of applied and static multiplier, below
#: which it counts as the same.
#: Range, of 7 by `nscd`: no peak; where halved, an end by 59 %; iterations by 3 %.
SAME_MULTIPLIER = 0.2

#: Share of the highest multiplier so far above which an excess may hide a peak or a bend.  If a
#: step passes the peak, the excess is `OVERSHOOT_SHARE` of it at most.
#: Range, of 7 by `nscd`: a peak by 2.5e-4 and iterations by 13 % where halved, by -5 % where
#: doubled.
HIDES = 1.0 / 30.0

#: Share of the highest multiplier so far by which the multiplier may fall in a step, at the mean
#: rate since the peak; and the least step on a steep branch, over the displacement step.
#: Range, of 7 by `nscd`: peaks by 7e-5, an end by 1.9 %; steps by 15 and by 1.8 % where halved, by
#: -23 and -18 % where doubled.
STEEP = 0.005
LEAST_STEEP = 0.2

#: Shortening of the time step of a step that failed, its least over the first, and its growth.
#: Range of the first, 0.3 and 0.8, of 7 by `nscd`: no peak; ends by up to 2.7 %, of the solid by 60
#: %; steps by 19 %, iterations by 21 %.  Of the second, ten times more or less: the same.  Of the
#: third, 1.2 and 2: no peak, iterations by 4 %.
FAILED_TIME_STEP = 0.6
LEAST_EXCESS_TIME_STEP = 1e-3
EXCESS_TIME_GROWTH = 1.4

#: Elongation of a tie beyond that at which it breaks, over the latter, above which a step is tried
#: again with less, by engines that do not solve for where ties break.  Derived: the force of an
#: elastic tie is too large by as much at most.
LATE = 1e-3

#: Most by which an excess grows in a step.  Range, 1.25 and 2, of 7 by `nscd`: a peak by 2.4e-4, an
#: end by 1.5 %, iterations by 7 %.
EXCESS_GROWTH = 1.5

#: Motion per multiplier in a step, over that in the step before, above which the step may have
#: passed the peak.  Range: peaks of the published walls by `nscd` are 1e-5 above, 4e-4 below and
#: 7e-6 above those of `equilibrium` with 1.25; with 2.0 they are 1.5e-3, 7e-4 and 1e-3 above, in
#: fewer steps.
SOFTER = 1.25

# Control: the published strategy -----------------------------------------------------------------

#: Increment of the multiplier, ascending.  Range, of 8 as published: peaks, which are multiples of
#: it, by 4 % at most; steps by 8 %.
PUBLISHED_INCREMENT = 0.005

#: Applied over carried multiplier, descending.  Convention: the paper's.
OVERSHOOT = 1.05

#: Difference of multipliers that counts as equal.  Range, of 8 as published: five peaks by one
#: increment, or 4 % at most; steps by 10 %.
BALANCE_TOLERANCE = 1e-3

#: Time step [s], ascending, and at first descending; and the least over it.  Range of the first, of
#: 8 as published: no peak where halved; one (`plateband-plane` 8) twice as high where doubled;
#: steps by 16 %.  Of the second, ten times more or less: the same.
PUBLISHED_TIME_STEP = 0.05
LEAST_PUBLISHED_TIME_STEP = 1e-6

#: Share by which the difference of applied and carried multiplier must shrink to count as progress.
#: Range, 0 and 0.5: of 8 as published, no peak, steps by 0.1 %.
SHRUNK = 0.1

#: Share by which the carried multiplier falls from its highest if the structure falls.  Guards long
#: patience: without it, a structure falls on until the patience is over.  Range, up to 1, with
#: which it counts never: 8 as published, whose patience ends before, are the same.
FALLEN_BY = 0.1

#: Motion of a step, over the displacement step, below which a structure stands still.  Guards
#: structures that stand under less than the stop value: with 0, the first closure of their joints,
#: as they are loaded again, ends the curve.  Range: 8 as published are the same, with 0, too.
GOES_ON = 0.1

#: Share of the peak by which a branch may fall in a step.  Range: 6 of 8 as published are the same,
#: no peak moves; steps by 9 %.
LAG = 0.01

#: Least and most change of the time step, descending.  Range, 0.5 and 0.85, and 1.1 and 1.5, of 8
#: as published: no peak, steps by 0.5 %, iterations by 4 %.
LEAST_CHANGE = 0.7
MOST_CHANGE = 1.2

# Control: supports that move ---------------------------------------------------------------------

#: Smallest step over the largest.  Range, ten times more or less, of 10 with supports that move:
#: two highest reactions by up to 9e-4 where larger, by 2.3e-4 where smaller, the others by 1e-5;
#: ends by 0.1 %; iterations by 21 %.
SUPPORT_FLOOR = 1e-4

#: Factor by which a block must move farther than the supports, and than in proportion to the last
#: step, in a jump.  Range: 9 of 10 with supports that move are the same, the highest reaction of
#: the other by 2.2e-4; iterations by 0.8 %.
JUMP_RATIO = 5.0

#: Motion of a block over the smallest extent while supports are held, after which the structure has
#: fallen.  Convention: a block that has moved so far has left what it rested on.
SUPPORT_FALL = 1.0

#: Longest time step while supports are held, over the first.  Derived: that of a static step.
LONGEST_HELD = 300.0

#: Smallest and largest distance from an unstable equilibrium at which a stable one is looked for,
#: over the smallest extent.  Range: portals with stiffness from 1e8 to 1e10 Pa/m: the same.
LEAST_DEPARTURE = 1e-4
MOST_DEPARTURE = 0.1

#: Largest deviation of the reaction from its last slope in a step, over the largest reaction.
#: Range, of 10 with supports that move: highest reactions by 4e-7, iterations by 2.4 %.
SUPPORT_BEND = 0.02

#: Factor by which a step is shortened.  Range, of 10 with supports that move: a highest reaction by
#: 1.7e-4, the others by 3e-5, iterations by -7 % where halved, by 34 % where doubled.
SUPPORT_SHORTER = 0.3

#: Share of the supports' displacement that counts as all of it.  Derived: a rounding.
ALL_MOVED = 1.0 - ROUNDING
# Engines: frames, measures, bonds ----------------------------------------------------------------

#: Smallest side of a block of the published walls [m], and their unit weight [N/m3]: the size and
#: weight of the frame that engines work in.  Convention.
FRAME_SIZE = 0.175
FRAME_UNIT_WEIGHT = 10e3

#: Distance [m, own units] up to which places are the same in the order of blocks: above the
#: rounding of a thousand metres (1e-13 each), and far below any real distance.
#: Derived: a rounding.
SAME_PLACE = ROUNDING

#: Acceleration of a block, over gravity, above which a point counts as passed dynamically.
#: Convention.
ACCELERATION_LIMIT = 0.3

#: Work of the load on the motion of a step, over the sum of the sizes of its terms, below which the
#: motion is across the load, so that virtual work does not give the multiplier.  Range: 27 in the
#: plane and 7 by `nscd` are the same; the former with 0, too.
ACROSS_THE_LOAD = 1e-2

#: Motion of a block, over that of the fastest, from which on a message names it.  Convention.
NAMED_MOTION = 0.1

#: Release of a bond, over the weight of the lighter of its blocks, that is too small to count.
#: Range, ten times more or less: 11 of 12 with brittle bonds are the same, peaks by 4e-12; of 12
#: with weak tension, peaks by 1.4e-7, an end by 30 % and iterations by 21 % where larger.
SLIGHT = 1e-3

#: Share of an increment so small that the first bond breaks where the step starts.
#: Derived: a rounding.
LEAST_INCREMENT = ROUNDING

#: Difference of margins up to which bonds break together, over the margin at which a step ends for
#: a bond (`AT_STRENGTH`).  Range, ten times more or less: 11 of 12 with brittle bonds are the same,
#: by `equilibrium`, and 11 of 12 with weak tension; peaks by 1e-9, iterations by 5 %.
DUE_TOGETHER = 1e-3

# Dynamics: the distinct element method -----------------------------------------------------------

#: Time step over the critical one.
#: Derived: a stack of three blocks keeps the energy of its highest waves at 0.95, and explodes at
#: 1.02.
SAFETY = 0.9

#: Share of the unbalanced force that Cundall's local damping takes.  Range, 0.25 and 0.8, by
#: `distinct`: one peak (`plane` 8) by 2.9e-4, the others by 1e-5; cycles by 33 and by 15 %.
LOCAL_DAMPING = 0.5

#: Unbalanced force of a block at rest over its weight.  Convention: the accuracy of a point.
DISTINCT_TOLERANCE = 1e-5

#: Largest residual in a certificate, over the heaviest weight.  Derived: the forces at rest are
#: those of a cycle, the poses those at its end; ten times the tolerance of rest.
DISTINCT_RESIDUAL = 1e-4

#: Motion between two searches over the smallest extent of a block.  Range, by `distinct`: one peak
#: (`plane` 8) by 3.3e-4, the others the same; steps by -9 %, nearly all of that one.
SEARCH_TOLERANCE = 2e-3

#: Open joints count for the time step of quasi-static cycles up to three times this share of the
#: smallest extent of a block, or up to three times the motion of blocks between two searches.
#: Likewise, the motion of blocks after which masses are calculated anew.  The first matters only if
#: every cycle searches, because `SEARCH_TOLERANCE` is larger.  Range, by `distinct`: no peak;
#: cycles by -20 % where halved, by 19 % where doubled.
WATCHED = 1e-3

#: Gap up to which open joints count, over the motion of blocks between two searches.  Derived: two
#: blocks may move against each other, and move on until the next search.
WATCHED_REACH = 3.0

#: Displacement of a step over the smallest extent of a block.  Range, by `distinct`: no peak;
#: cycles by 29 % where halved, by -27 % where doubled.
DISTINCT_STEP = 0.01

#: Accuracy of a reaction at rest, over the unbalanced force of the lighter block: in a row of
#: blocks, the unbalanced forces of several add up.  Not measured.
NOISE = 5.0

#: Margin of a bond at which a step ends for it; it is large because each trial is a relaxation.
#: Not measured.
AT_STRENGTH = 1e-3

#: Factor by which margins of ties are enlarged: a step ends so much nearer to the strength of a
#: tie, whose force is more accurate at rest.  Not measured.
TIES_NEARER = 20.0

#: Motion of any point of a block, over the demanded motion of the control point, above which the
#: block moves by itself.  Range, doubled, by `distinct`: one peak (`plane` 8) by 1.4e-4.
BY_ITSELF = 3.0

#: Motion of a block by itself between two points, over its smallest extent.  Derived: above it,
#: steps of the default length are jumps (`SNAP_MOTION` times `DISTINCT_STEP`), and the collapse of
#: a block, by half of its extent, is resolved to a fifth.
BETWEEN_POINTS = SNAP_MOTION * DISTINCT_STEP

#: Motion of a block, over its smallest extent, above which it is checked whether it has left the
#: structure.  Convention.
MAY_HAVE_LEFT = 0.5

#: Rate of each stage in which a driven increment ends, over that of the one before.  Range, halved,
#: by `distinct`: one peak (`plane` 8) by 4e-4.
SLOWER = 0.25

#: Control displacement of the last step, over the motion of the fastest block, below which it is
#: rounding, so that the next step does not continue the motion.  Derived: a rounding.
ONWARDS = ROUNDING

#: Least stiffness of a degree of freedom, over the largest stiffness of the same degree of freedom
#: of all blocks.  Range, by `distinct`: the same.
LEAST_STIFFNESS = 1e-3

#: Time step [s] if no block has stiffness.  Convention: the blocks fall freely at any time step.
FREE_TIME_STEP = 1e-3

#: Fewest cycles of a step under a given multiplier.  Derived: two, rounded: its two halves.
FEWEST_CYCLES = 1.5

# Dynamics: non-smooth contact dynamics -----------------------------------------------------------

#: Residual of a step over the heaviest weight.  Convention: the accuracy of a step.
NSCD_TOLERANCE = 5e-7

#: Largest residual in a certificate.  Derived: the tolerance of a step, and as much for the
#: rounding of its poses.
NSCD_RESIDUAL = 2.0 * NSCD_TOLERANCE

#: Momentum defect at which the branches count as fixed, over the tolerance.  Derived: a tenth of
#: the tolerance.
BRANCHES_FIXED = 0.1

#: First time step under the dead load [s], and the least share of it.  Range of the first, of 7 by
#: `nscd`: peaks by 3e-5, iterations by 6 %.  Of the second, ten times more or less: the same.
DEAD_LOAD_TIME_STEP = 0.05
LEAST_TIME_STEP = 1e-4

#: Motion of a step from rest, over the closure of joints, below which the structure is at rest; and
#: the least closure used for this [m].  Derived: far below the closure of joints; a rounding.
AT_REST_MOTION = 1e-3
LEAST_CLOSURE = ROUNDING

#: Penalty stiffness of sticking contacts, over the stiffest joint or, in short steps, the largest
#: mass at a contact.  The soft one is tried if Newton's method does not converge, because it
#: tolerates wrong branches.  Stiffer ones are needed for forces that depend on a very small slip.
#: Derived: each 30 times the one before, and the last two again.  Range, of 7 by `nscd`: the soft
#: one, iterations of the solid by 11 %, the others the same; the second, 300: peaks by 3e-5,
#: iterations of one (`plateband-plane` 8) four times as many; with 30, one in space (`portal` 8)
#: does not end where it did, and has a peak 1.5 times as high.  The stiffest, ten times less: peaks
#: by 6e-6, iterations by 1.4 %; ten times more: a peak by 1e-3, iterations by 32 %.
SOFT_PENALTY = 30.0
STIFF_PENALTY = 1e3
STIFFER_PENALTY = SOFT_PENALTY * STIFF_PENALTY
STIFFEST_PENALTY = 1e6

#: Least share of a Newton step that is worth trying.  Range, of 7 by `nscd`: peaks by 3e-5,
#: iterations by 5 %.
LEAST_NEWTON = 0.05

#: First barrier, over the energy that an impulse of usual size stores in its joint.  Range: ten
#: times more, 3 % fewer iterations of eight solids, peaks by up to 1.3e-3.
FIRST_BARRIER_OF_IMPULSES = 1e-3

#: Barrier over the first at which the branches can be told apart.  Range, ten times more or less,
#: of a solid by `nscd` (`solids` 8): iterations by 9 %, its peak by 6e-3.
NEAR_BARRIER = 1e-5

# Statics: what a step is solved to ---------------------------------------------------------------

#: Largest unbalanced force, over the heaviest weight.
#: Derived: a thousand times the rounding of the sums from which it is calculated, 4,500 of 2.2e-16.
BALANCE = 1e3 * SUMS

#: Largest unbalanced force that stiff joints may leave by rounding.  Derived: a thousand times
#: `BALANCE`, so that such joints can be told from a step that is not solved.
COARSEST = 1e3 * BALANCE

#: Part of a control displacement that may be missing [m].  Derived: `SUMS` of a metre.
MISSING = SUMS

#: Least difference of the gaps of two contacts that are told apart, over `BALANCE` over the
#: stiffest joint.  Derived: a thousandth of the unbalanced force.
TOLD_APART = 1e-3

#: Time step of a static step [s].  Derived: the inertia of a step of 1 mm is then 1e-7 of a weight.
STATIC_TIME_STEP = 30.0

#: Farthest motion of a block in one step, over the smallest block.  Convention: two blocks may
#: then approach each other by twice as much, and the broad phase reaches `MARGIN_SHARE`.  If blocks
#: overlap that were no pair, the step fails.
MOST_MOTION = 0.2

#: Pseudo-transient steps under the dead load: the first and the least time step [s], and growth.
#: Range of the first, halved and doubled, and of the growth, from 10 to 1000: iterations of the
#: solids by up to 5 %.  Of the least, 1e-6 and 1e-2: 27 in the plane are the same.
DEAD_LOAD_STEP = 0.1
LEAST_DEAD_LOAD_STEP = 1e-5
LONGER_DEAD_LOAD_STEP = 100.0

#: Step of a control displacement over the height of the structure, and over the smallest block, at
#: least and at most.  Derived: a mechanism turns by 1 in 500 in it.  Range, of 27 in the plane: of
#: the first, peaks by 1.4e-4, steps by 6 %.  Of the least, halved: peaks by 8e-5, steps by 23 %;
#: doubled: 25 peaks by 2.2e-4, but two curves (`tied-plane` 8, `plateband-plane` 10) do not end
#: where they did, go on, and have peaks 2.6 and 1.7 times as high.  With either doubled, `bonded` 8
#: goes on to 0.06 m, from 0.003.  Of the most: the same.
STEP_OF_HEIGHT = 1.0 / 500.0
LEAST_STEP = 0.02
MOST_STEP = 0.1

#: Cosine of the angle of a joint's normal to the vertical above which the joint lies, so that
#: weight presses on it.  Derived: of 45 degrees, rounded.
LIES = 0.7

#: Force over the heaviest weight above which a contact that was not followed is added.
#: Range, 1e-5 and 1e-3: no peak of 36 random solids by 1e-4, iterations by 0.7 %.  With 1e-2 a
#: block that slides over a flush joint carries up to 1.5 % more than its friction.
PRESSED = 1e-4

#: Margin of a bond at which a step ends for it; and force over the heaviest weight by which the
#: strengths of joints may still change where a step ends.  Range, ten times more or less: of the
#: first, of 12 with brittle bonds, peaks by 2e-5, iterations by 1.5 %; of the second, of 11 with
#: mortar, peaks by 1e-4, but two by 1.8e-4 and one by 1.5e-3, an end by 12 %, steps by 20 %.
ENDS_FOR_BOND = 1e-5
STRENGTHS_FIXED = 1e-6

# Statics: linear pieces, and matrices ------------------------------------------------------------

#: Smallest pivot of a block, over its largest entry, with which a direction is worth trying.
#: Derived: 450 roundings.
LEAST_PIVOT = 1e-13

#: Sliding back by less than this share of the blocks' motion does not end sliding.  Range, ten
#: times more or less: iterations of 22 structures of the plane by 2 %, the peak of one by 1.4e-4.
SLOW = 1e-6

#: Least progress of a path, as a share of the step, that counts as progress.  Derived: the rounding
#: of the share in some hundred changes.
NOTHING_FARTHER = 1e-12

#: Share of the step by which a path may go back behind its start before it counts as folded.
#: Range: halved and doubled, iterations of 22 structures of the plane by 0.6 %, no peak by 1e-4.
BELOW_START = 1e-3

#: Largest damping by which a pivot is raised, over the least.  Derived: a guard.
MOST_RAISED = 1e12

#: Time of a factorisation [ns] above which threads are faster.  Not measured.
WORTH_SHARING = 1e6

#: Time of a front's call [ns], and of a multiplication.  Derived: from one machine; only the choice
#: of fronts depends on them.
CALL_TIME = 100.0
MULTIPLICATION_TIME = 0.04

# Statics: the interior-point method --------------------------------------------------------------
# Energies are those of one contact over the energy that the weight of a mean block stores in one,
# forces over that weight, damping in 1/s2 of the frame, in which gravity over the smallest block is
# 56.

#: First barrier; and the least first barrier over the square of the unbalanced force.  Range: ten
#: times more or less, iterations of 18 curves in space by 11 to 12 %, peaks as they were.
FIRST_BARRIER = 1e-3
BY_UNBALANCED = 3e-3

#: Largest barrier because of an unbalanced force.  Range: halved and doubled, iterations of the
#: solids by 0.8 %.
MOST_BARRIER = 3.0

#: Length of an iteration below which it is no progress; and the least barrier with which contacts
#: are centred anew.  Range: without, iterations by 12 % and failed steps by 80 %.
NO_PROGRESS = 0.2
RECENTRED_BARRIER = 1e-3

#: Radius of the neighbourhood of the central path, over the barrier: of the predictor; and of the
#: corrector, for the direction of slip.
#: Range: without either, iterations of 18 curves in space by less than 1 %.
PREDICTOR_RADIUS = 0.1
SLIP_RADIUS = 10.0

#: Length of the predictor above which its second-order terms are used; also in implicit steps.
#: Range there, 0.25 and 0.9, of a solid by `nscd` (`solids` 8): iterations by 9 %, its peak by
#: 4e-3.
FAR_ENOUGH = 0.5

#: Least and largest barrier aimed at, over the present one; also in implicit steps.  Convention of
#: Mehrotra's method.  Range in implicit steps of the first, ten times more or less, and of the
#: second, 0.6 and 0.9, of a solid by `nscd` (`solids` 8): iterations by 12 %, its peak by 4e-3.
LEAST_REDUCTION = 1e-3
MOST_REDUCTION = 0.8

#: Energy below which branches can be told.  Range: from 1e-12 to 1e-8, iterations of 36 random
#: solids by 2 to 5 %, no peak by 1e-4.
TELLS = 1e-10

#: Unbalanced force below which Newton's method is tried between iterations; and factor by which it
#: must reduce the unbalanced force there.  Range: halved and doubled, iterations of the solids by
#: 1.4 %.
NEWTON_RESIDUAL = 0.05
NEWTON_GAIN = 10.0

#: Factor by which Newton's method must reduce the unbalanced force in the first iterations of a
#: step.  Range: a factor of 2 in one or two iterations changes those of 36 random solids by 0.7 %,
#: and no peak.
WARM_GAIN = 30.0

#: Largest rotation in an iteration [rad]; the linearised motion does not hold beyond it.
#: Range: curves of six bonded walls are the same to the last bit with 0.02 to 1.
FARTHEST_ROTATION = 0.2

#: First damping of an unstable matrix; damping above which a part counts as unsupported; largest
#: damping.
#: Range: four times more or less of the first, iterations in space by 5 %, peaks as they were.
DAMPING = 10.0
LOST_SUPPORT = 3e3
MOST_DAMPING = 1e9

#: Factors by which damping grows and falls; and damping that is set to zero below this.  Range:
#: halved and doubled, iterations of the solids by up to 4 %.
MORE_DAMPING = 4.0
LESS_DAMPING = 0.25
LEAST_DAMPING = 3.0

#: Growth [1/s2] of a mode below which it is neutral, such as that of a joint that slides as a
#: whole.  Derived: a hundredth of gravity over the smallest block, below which a block needs ten
#: times as long to leave as to fall over.
NEUTRAL = 0.5

#: Length of an iteration above which damping is reduced; and factor by which an iteration is
#: shortened in which a slip changes its direction too far.  Range of the first, from 0.8 to 0.95:
#: iterations of the solids by 0.2 %.  Of the second, from 0.6 to 0.9: by 2 %, but one peak, of
#: several equilibria, by 1.4e-3; with 0.5 iterations by 50 %.  Of the second in implicit steps, 0.6
#: and 0.9, of a solid by `nscd` (`solids` 8): iterations by 8 %, its peak by 4e-3.
GOOD_LENGTH = 0.9
LENGTH_SHORTER = 0.8

#: First and last share of a step at which its shape is evaluated.  Range: with 9 or 39 shares,
#: peaks of bonded walls move by up to 8e-4, because points lie elsewhere.
FIRST_SHARE_SEEN = 0.05
LAST_SHARE_SEEN = 0.95

# Statics: joints that yield ----------------------------------------------------------------------

#: Unbalanced force that Newton's method may leave, over the force by which strengths may still
#: change.  Range, ten times more or less, of 11 with mortar: peaks by 1e-4, but one by 1e-3 where
#: larger; iterations by 12 %.
LEFT = 5e-4

#: Share of a step up to which it is repeated, at most.  Range: peaks are the same with 0.95, and
#: move by up to 8e-4 with 0.35.
FARTHEST_AGAIN = 0.7

#: Bend over the drop, below which the path with the strengths at the start is straight.
#: Range: 10 of 11 with mortar are the same, the peak of the other (`mortar-plane` 12) by 2.1e-4;
#: iterations by 1.4 %.
STRAIGHT = 0.1
