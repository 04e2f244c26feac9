"""The register of numbers: every tolerance and threshold of the packages that compute, by subject.

``tests/unit/test_numbers.py`` holds every float literal of these packages to this file or to a
short list of exact numbers.  Kernels take the constants here as constants of theirs, at no cost.

**Scales.** Engines work in a frame of their own (`engines.frame`): the smallest block is 0.175 m,
the heaviest material weighs 10 kN/m3, times are those of blocks of that size.  A number in metres
or seconds means these; all others are over what the comment names.

**Where a number is from.** Each comment says one of these:

- *Derived*: it follows from something, which is named.
- *Range*: what changes where it is halved and doubled, or as the comment says.  Of engines and
  controls on random structures that stand or fall by `equilibrium`: 12 of the plane, and 10 of
  space, 6 solids and 4 arches (``benchmarks/robustness.py``, seeds 0:24:2, 0:12:2, 0:8:2).  A
  number has *no effect* if it changes peaks by less than 1e-4 of themselves, and the sum of steps
  by less than 1 %, in the plane and in space.  Peaks in space are known to some 2e-3 with steps of
  the default length: what changes where points lie changes them by that.
  Measured with the static step before that which plane and space share.  Ranges *by* `distinct` are
  of 3 plane structures, seeds 8, 10 and 12.
- *Convention*: what a word means; another number would mean something else.
- *Not measured*: nobody knows more than that it works.

Run one otherwise with ``python benchmarks/robustness.py --set tolerances.NAME=VALUE``.  Numbers
that are computed from NAME change with it.
"""

import math

# Roundings ---------------------------------------------------------------------------------------

#: Relative change of an iterate under which it changes no more.
#: Derived: four and a half roundings of 2.2e-16.
LAST_DIGIT = 1e-15

#: What sums leave, over their largest term.
#: Derived: 4,500 roundings of 2.2e-16, of terms as many as a block has corners, edges or contacts.
SUMS = 1e-12

#: What places and shapes are off by, over their size.  Far above what is left of sums with places a
#: hundred blocks away (1e-12 to 1e-11), far below what anyone draws or builds.  Derived: of a
#: drawing in a national grid, 5e5 m off with corners in double precision, 1e-10 m.  Range: peaks by
#: 1.2e-6, steps by 0.1 %; but for one solid, which falls in motion in 19 % fewer steps if doubled.
ROUNDING = 1e-9

#: Of what is drawn, over its size: files hold places to about this.
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

#: Angle about an edge [rad] below which two faces lie on each other.  Derived: `DRAWN`; no solid is
#: as thin.
ON_ITSELF = DRAWN

#: Distance below which two vertices are one, over the tolerance times the size of their solid.
#: Not measured.
WELDED = 0.05

#: Share of the tolerance up to which faces that meet are one.  Not measured.
ONE_FACE = 0.5

#: Motion of vertices outside the area that two faces share, over the distance by which these
#: overlap, up to which it is allowed.
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

#: Angle between a cut and an edge [rad] below which the cut makes a needle, and is the last choice.
#: Not measured.
NEEDLE = math.radians(15.0)

#: Cosine between the normals of triangles of a fan below which one lies on the other: 11 degrees.
#: Not measured.
FOLDED = -0.98

#: Cosine between the normals of two adjacent faces above which they have one direction: 45 degrees.
#: Not measured.
SAME_DIRECTION = 0.7

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

#: Distance from a line, over the size of everything, beyond which a point cannot be put onto it.
#: Derived: what sums leave.
OFF_LINE = SUMS

#: Weight of the motion of a fixed vertex, over that of others.  Not measured.
FIXED_VERTEX = 1e-3

#: Error after an iteration, over that before it, above which iterations end.  Not measured.
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
# (`arch` 6: neither `SUCCESSOR` nor `MERGE`, which change peaks by 2e-5; which does is not known).

#: Least tributary length or area of a contact, over that of the shorter edge or smaller face.
#: Range, doubled: plane: no effect; space: a peak by 2.6e-3 and the end by 11 %, of a solid that
#: falls in motion (`solids` 2), all others the same.
LEAST_FACE = 0.01

#: The same where edges or faces overlap by a point or a line alone, as those of blocks do that meet
#: corner on corner.  Such blocks have no joint there: one that slides on to the next block of its
#: course is held by about this share of its weight.  Of the length, in the plane.
#: Range, 1e-2 and 1e-4: the peak of a block that slides over a joint right below its front is
#: 1.009 and 1.0001 times friction (1.0007), peaks of two walls are 1.04 and 1 times as high.  With
#: 1e-4 a tenon jams in its fall, and a block that topples finds no rest.
LEAST_LENGTH = 1e-3

#: Of the area, in space.  Range, 1e-3 and 1e-5: the peak of such a block by 2e-3; with 1e-3 it is
#: 3.5 % too high at 1e12 Pa/m, as faces are as good within 1e-6 of the size of blocks (`TIED`).
LEAST_AREA = 1e-4

#: Margin of the broad phase, over the smallest extent of a block.  A matter of speed only.
#: Not measured.
MARGIN_SHARE = 0.25

#: Where two edges of a block are opposed to a face almost alike, the tributary length passes from
#: that of one edge to that of the other.  This is the share of the rotation, from either edge to
#: the corner on end, over which it passes: 0.2 of a square corner are the angles from 37 to 53
#: degrees. Not measured.
PASSAGE = 0.2

#: Sharp corners nearer than this share of their edges' lengths count as one.  Not measured.
SAME_CORNER = 1e-3

#: Rounded vertices, or rims, nearer than this share of the sum of their radii have no direction
#: from one to the other.  Not measured.
DEEP = 0.1

#: Distance, over the size of the parts, by which edges must separate them more than faces do.
#: Not measured.
EDGES_MARGIN = 1e-2

#: Angle between an edge and a face, or between two rounded edges [rad], below which both ends of
#: what they share are in contact.  Not measured.
EDGE_FLAT = 0.05

#: Cosine between the incident and the reference face below which the former is seen edge on.
#: Not measured.
EDGE_ON = 0.05

#: Faces are kept while others separate the parts by no more than this share of their size more, or
#: are more opposed by no more than this.  Not measured.
KEPT_FACE = 1e-3

#: Faces that separate the parts by this share of their size less do so alike: more than the
#: rounding of places, and less than a gap that a drawing means.  Derived: `DRAWN`.
TIED = DRAWN

#: Where parts meet in an edge or a point alone, another face separates them as soon as it does so
#: by this share of their size more than the present one.  Such parts may come apart along each of
#: these faces' normals.  If the face were kept as flush ones are (`KEPT_FACE`), it would restrain
#: parts that slide past each other: two stones on two, head joints in line, carried a tenth to a
#: half more.  Derived: a rounding.
EDGED = ROUNDING

#: Corners nearer to a vertex than this share of the smaller face's width are the vertex.
#: Not measured.
CLIP = 1e-3

#: Sides of an overlap shorter than this share of its width have one end only.  Not measured.
MERGE = 5e-2

#: Slope of one face over the other along such a side, above which the end stays where they are
#: nearer to each other.  Not measured.
SIDE_SLOPE = 1e-3

#: Share of `MERGE` below which a side goes both ends of which were points before.  Range, halved:
#: peaks of vaults and stairs the same, steps by 2 %; but for a vault that falls in motion, which
#: ends 1e-4 m sooner, in 17 % fewer steps.
MERGED_AGAIN = 0.5

#: Sine of the angle from which on a corner of an overlap adds a kite to what rounding edges takes.
#: Not measured.
TURNS = 1e-3

#: Sine of the angle between two edges below which they are parallel: the side of a face serves.
#: Not measured.
PARALLEL = 1e-3

#: Of the edges' length: nearest points are on the common normal but for this.  Derived: `DRAWN`.
ON_NORMAL = DRAWN

#: Distance within which a contact may inherit a history, over the root of the interface's area.
#: Not measured.
SUCCESSOR = 0.35

# Joint law ---------------------------------------------------------------------------------------

#: Change of an iterate, over it, where it is the difference of two larger numbers.
#: Derived: ten times `LAST_DIGIT`.
LAST_DIGITS = 10.0 * LAST_DIGIT

#: Distance to the friction cone, over the friction, below which a contact slides, where it is
#: judged anew in every sweep or cycle.  Derived: a rounding, of sums of the same terms in another
#: order.
AT_CONE = ROUNDING

#: Share of a contact's reactions by which another branch must be nearer before the contact leaves
#: its branch: a contact that slides starts the next step on its cone to rounding.
#: Range, doubled: peaks by 3e-14, steps the same; halved it is not measured.
BRANCH_TIE = 1e-8

#: Excess over the strength, over it, at which a bond is still intact.
#: Not measured.
BOND_TIE = 1e-6

#: Margins that differ by less, over strengths, belong to bonds that break together, such as those
#: of mirrored blocks.  Derived: what bonds are known to, `BOND_TIE`.
TOGETHER = BOND_TIE

#: Least strength that a margin is measured over, over the other strength of the bond.
#: Not measured.
LEAST_STRENGTH = 0.1

#: Faces that are drawn apart by less are as they were laid but for rounding [m].  Derived: over the
#: smallest block it is six times `ROUNDING`.
GRAZE = ROUNDING

#: Gap of a joint, over the smallest extent of a block, up to which it is built shut: it has a bond.
#: Derived: a rounding.
BUILT_SHUT = ROUNDING

#: Exponent of softening at which a bond is lost, and up to which a crushed joint softens.
#: Derived: two billionths of its strength, e^-20, are less than what solutions are balanced to.
FULLY_SOFTENED = 20.0

#: Least slope of the equation of softening of a bond: it would be less where a joint snaps back.
#: Not measured.
LEAST_SLOPE = 1e-3

#: Largest share of the greatest closure at which a tangent is taken: beyond it the joint is rigid.
#: Derived: nearer to it than by a rounding, its stiffness has no digits.
NEARLY_SHUT = 1.0 - ROUNDING

#: Closure over the length of its law from which on a logarithmic one goes straight: by then it is
#: e^20 times as stiff.  Derived: as `FULLY_SOFTENED`; stiffer joints are rigid beside all others.
STRAIGHT_CLOSURE = FULLY_SOFTENED

#: Angles of friction in space are found to this [rad].  Derived: a rounding.
FRICTION_ANGLE = ROUNDING

#: Start of Newton's method for the normal reaction, over the crushing force, at most.
#: Derived: it converges from anywhere between, as steps outside are halved.
BELOW_CRUSHING = 0.75

#: Products of a pair, and of a normal reaction and its slack, over those on the central path, below
#: which they are centred anew.  Not measured.
CENTRAL = 1e-2
CENTRAL_NORMAL = 1e-3

#: Least share of its value that a normal reaction or its slack keeps in an iteration.
#: Not measured.
KEPT = 1e-2

#: Distance to the boundary of its cones that a pair keeps, over their size: with less, a long slip
#: is lost in rounding.  Without a barrier reactions are wrong by no more than that; those of the
#: joint law itself are exact.  Not measured.
LEAST_DISTANCE = 1e-10

#: Friction limit over the slack of the normal reaction, below which a contact counts as open and
#: slides freely.  Not measured.
OPENING = 1e-2

#: Slip over its former value, below which a contact may stick again; and friction over its limit,
#: above which its direction counts.  Not measured.
STICKS_AGAIN = 0.1
TURNING_FRICTION = 0.3

# Control: when a curve ends ----------------------------------------------------------------------

#: Load multiplier under which a curve ends, after its peak.  Convention.
STOP_MULTIPLIER = 0.01

#: Share of the peak under which it ends, where that is less and nothing else is asked for.
#: Convention: a slender wall carries 0.05, and of its branch nothing may be left out that
#: assessment draws on to zero.
STOP_SHARE = 0.1

#: Least load multiplier that inertia is measured over, in controls and engines.
#: Derived: a tenth of `STOP_MULTIPLIER`, below which nothing is followed.
LEAST_LOAD = 0.1 * STOP_MULTIPLIER

#: Share of a peak below the stop value to which the curve is followed: blocks that come loose let
#: a multiplier drop and rise again, though not from next to nothing.  Convention.
NEXT_TO_NOTHING = 0.01

#: Motion of a block while next to nothing holds the structure, over the largest increment, after
#: which it has collapsed.  Convention: an eighth of the smallest block with the increments of
#: `published`, half of it or more with those of `equilibrium`.
#: Range: no peak; plane: the same; space: steps by 1.4 %.
FALL_MOTION = 25.0

#: Of step lengths by which a motion falls short: least motion over the largest increment.
#: Derived: far below the least share of a step.
LEAST_MOTION = 1e-3

#: Penetration of two blocks in motion, over the smallest block, above which one has passed through
#: the other.  Derived: beyond half of it the nearest face is the one on the far side.
PASSED_THROUGH = 0.5

# Control: static steps of a displacement ---------------------------------------------------------

#: What a curve is known to, over its peak.  Convention: points every 2e-4 of the peak tell it.
#: Range: where doubled, peaks by 2.7e-4, as it says, and steps by -2.8 %.
PEAK_SHARE = 2e-4

#: Of the peak, by which a snap that is passed over may move the curve.
#: Derived: what it is known to.
SNAP_SHARE = PEAK_SHARE

#: Least multiplier that shares of the peak are of, over `STOP_MULTIPLIER`.  Range: plane: the same.
#: Space: a peak by 1.3e-3 where doubled, steps by 0.6 %.
LEAST_PEAK = 10.0

#: Least reaction to supports that move, that shares of the greatest are of, over the heaviest
#: weight (times the smallest block where they turn).  Where blocks only ride along, it is rounding.
#: Derived: a hundredth of a weight, of which a bend is known to what curves are.
LEAST_REACTION = 0.01

#: First increment over the largest; of supports too.  Range: no effect.
FIRST_SHARE = 0.02

#: Smallest increment over the largest.  Range: a peak by 1.1e-4; plane, doubled: steps by -4.4 %.
FLOOR_SHARE = 0.01

#: Increment over the smallest one, by which a place without equilibria is crossed, and with which a
#: curve goes on after a jump.  Range: peaks by 1.1e-4, steps by 0.9 %, of arches doubled by 2.7 %;
#: no end is another.  Measured with the step that plane and space share.
CROSSING_LENGTH = 4.0

#: Increment over the largest up to which a step may use the full search.  Range: no effect.
FULL_SEARCH_SHARE = 0.02

#: Increment of the first step of a jump over the largest.  Range: peaks by 8e-5, steps by 1.7 %;
#: where doubled, two curves end by more than 1 % elsewhere.
CREEP_SHARE = 0.001

#: Most by which creeping is longer than at first.  Range: no effect.
MOST_CREEP = 50.0

#: Smallest increment to a peak or a bend, over the largest; how near to the stop value the last
#: point must be, relatively; over what joints close by, where they are stiff.  Range: a peak of the
#: plane by 1.6e-4, one of space by 1.2e-3; steps by 1 and by 4.4 %.
REFINED_SHARE = 0.005

#: Of `REFINED_SHARE`, what steps to the stop value are no shorter than.  Range: without it the
#: same; it ends a search for what a curve jumps over.
LEAST_CHORD = 1e-3

#: Share of what joints close by that steps are shortened to.  Range: no effect; without it, peaks
#: by 7e-6.
CLOSING_SHARE = 0.1

#: Overshoot within a step, over the peak, where the step exceeds the peak.  Range, by `distinct`:
#: one peak (`plane` 8) by 4.4e-4, the others the same; steps by -8 %, nearly all of that one.
OVERSHOOT_SHARE = 5e-3

#: Overshoot within any other step, over the peak.  Not measured.
DRIVE_SHARE = 2e-2

#: Overshoot over `OVERSHOOT_SHARE` under which a step hides no peak; and under which steps grow as
#: fast as they may.  Not measured.
NO_OVERSHOOT = 0.2
SMALL_OVERSHOOT = 0.05

#: Of the peak, that the curve may bend within a step.  Range: plane: no effect.  Space, of 84
#: solids, doubled: a peak by 5.4e-3, and by 1.7e-2 one of a leaf that has many equilibria;
#: iterations up to the peak by -5 %.
BEND_SHARE = 2e-3

#: Part of the bend that may be which the next step aims at.  Range, space: peaks by 1.9e-3, steps
#: by 1.4 %.
BEND_AIM = 0.6

#: A step in which the curve rises by less than this share of what it did may hide its peak.
#: Not measured.
KINK = 0.1

#: Of `PEAK_SHARE`, under which a step hides nothing, and by how much it is shortened where it does.
#: Not measured.
HIDES_NOTHING = 0.1
NEARER_TO_KINK = 0.4

#: Share of a step from which on it is not worth repeating up to there; and share of the way to a
#: fold at which the repeated step ends.  Range, with the two numbers of a fold below, 0.96 and
#: 0.99: peaks by 3e-5; plane: steps by -4.6 %.
ALL_BUT = 0.98

#: Share of a step up to which a fold sets the length of the next try; factor by which it is
#: shortened else; and share from which on the slope to a fold is known.  Range: the first two with
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

#: Share of its length with which a step is tried again that has come to another branch: by a jump
#: below the stop value, to an unstable equilibrium, or away from the predictor.  Range, eleven
#: random structures: ten peaks by 3e-6 at most, that of a vault by 3.1e-4; points by 12 %.
LOOKED_AT_SHARE = 0.25

#: First time step of a jump [s].  Range: peaks by 4e-5; plane: steps by 2.2 %; space: by 11 % where
#: halved, by -5 % where doubled.
JUMP_TIME_STEP = 0.1

#: Of the highest multiplier so far, by which the load grows at most in a step where the control
#: point turns back before the peak.  Range: no effect.
LOAD_SHARE = 0.05

#: Least time step of a jump over the first.  Range: no peak.
LEAST_JUMP = 1e-4

#: Growth of the time step of a jump.  Range, 1.25 and 2: peaks by 7e-5, steps by 2.8 %.
JUMP_GROWTH = 1.5

#: Acceleration of what moves farthest in a step of a jump, over that in the last step, above which
#: the jump is not over.  Range, 1.005 and 1.02, plane: peaks of three of 112 curves by up to 5e-3,
#: as their jumps lead now to one branch, now to another, all others the same; steps by 1.4 %.
NO_FASTER = 1.01

#: Time of a jump after which it may be over, over that after which it seemed to be and was not.
#: Derived: of a jump of time t in steps of h at least, no more than log2 (t / h) are followed by a
#: static step in vain, and no more than half of its time passes unasked.
LATER = 2.0

#: Time step with the supports held over the first, from which on the structure can be at rest.
#: Range, from 2.5 to 10: every closed form and every drawn arch within its bound; with 0.25 a
#: portal is called at rest where it begins to leave an unstable equilibrium.
LONG_ENOUGH = 5.0

#: Motion of a block, over the increment, above which a step is a jump.  Convention.  Range: no
#: peak; plane: the same; space: steps by 1.6 %.
SNAP_MOTION = 10.0

#: Motion of a block in a step of a jump, over the largest increment, up to which its time step
#: grows.  Range: no peak; plane: steps by 0.2 %; space: by 20 % where halved, by -3.5 % where
#: doubled.
JUMP_MOTION = 1.0

#: Motion of a block in a step of a jump, over what it would be with the acceleration of the last
#: step, above which the step is tried again with half of the time step, if it is also farther than
#: `JUMP_MOTION`.  Range, 2 and 10, with two lengths of steps: no peak of an arch; with 10 its end
#: by 4 %.
FARTHER = 4.0

#: Inertia of a step that is static again, over the applied force and, of the fastest block, over
#: its weight; of supports that move, over the weight.  Convention.  Range: no effect.
STATIC_INERTIA = 1e-3

# Control: cyclic analysis ------------------------------------------------------------------------

#: Displacement steps within which a displacement of a history is reached by engines that prescribe
#: it, and by those that step under a multiplier.  Derived: roundings; of the latter, what a step is
#: solved to (`NSCD_RESIDUAL`) over what an excess moves blocks by.
AT_TARGET = ROUNDING
AT_TARGET_OF_EXCESS = 1e-6

#: Displacement steps up to which a corner of a loop may be rounded off.  Not measured.
CORNER = 1e-3

#: Over the excess, by how much the multiplier rises in a step to a corner, and is exceeded beyond
#: it.  What is exceeded moves the structure past its corner, and the chord over that cuts it off.
#: Range, by `nscd`: the energy of a block that slides to and fro by 0.01 m is 1.6e-6 too little
#: with 1e-3, 1.5e-7 with 1e-4, 4e-9 too much with 3e-5; 1e-5 takes a third more steps.
LEAST_RISE = 3e-5

#: Share of the way between two trial excesses that the next is away from both.  Not measured.
LEAST_SHARE_TRIED = 0.01

# Control: excess over the static multiplier ------------------------------------------------------

#: Time step [s].  Not measured.
EXCESS_TIME_STEP = 0.1

#: Largest excess of the multiplier, over it where it is above one.  Not measured.
EXCESS = 0.01

#: First and least excess over the largest.  Not measured.
FIRST_EXCESS = 0.1
LEAST_EXCESS = 1e-5

#: Displacement steps by which the control point goes on in motion, with less than the stop value
#: carried, when a structure has collapsed; and, whatever is carried, by default.
#: Convention; derived: twice the smallest block, with the default increment.
EXCESS_FALL = 20.0
EXCESS_JUMP = 400.0

#: Difference of applied and static multiplier that is allowed beside the excess and the slope.
#: Not measured.
LOOSE = 5e-4

#: Motion of the control point over the fastest block's, above which the whole structure moves.
#: Not measured.
WITH_THE_REST = 0.25

#: Change of the static multiplier, over the difference of applied and static multiplier, below
#: which it counts as the same.
#: Not measured.
SAME_MULTIPLIER = 0.2

#: Share of the highest multiplier so far above which an excess may hide a peak or a bend.
#: Not measured.
HIDES = 1.0 / 30.0

#: Likewise by which the multiplier may fall in a step, on the mean since its peak; and the share of
#: the displacement step that a step on a steep branch is at least.  Not measured.
STEEP = 0.005
LEAST_STEEP = 0.2

#: Shortening of the time step of a step that failed, its least over the first, and its growth.
#: Not measured.
FAILED_TIME_STEP = 0.6
LEAST_EXCESS_TIME_STEP = 1e-3
EXCESS_TIME_GROWTH = 1.4

#: Most by which an excess grows in a step.  Not measured.
EXCESS_GROWTH = 1.5

#: Motion of a step over what the step before had for as much of the multiplier, from which on the
#: step may have passed the peak.  Range: peaks of the published walls by `nscd` are 7e-5, 3e-4 and
#: 5e-4 above those of `equilibrium` with 1.25; 2e-3, 7e-4 and 1e-3 with 2.0, in fewer steps.
SOFTER = 1.25

# Control: the published strategy -----------------------------------------------------------------

#: Increment of the multiplier, ascending.  Not measured.
PUBLISHED_INCREMENT = 0.005

#: Applied over carried multiplier, descending.  Convention: the paper's.
OVERSHOOT = 1.05

#: Difference of multipliers that counts as equal.  Not measured.
BALANCE_TOLERANCE = 1e-3

#: Time step [s], ascending, and at first descending; and the least over it.  Not measured.
PUBLISHED_TIME_STEP = 0.05
LEAST_PUBLISHED_TIME_STEP = 1e-6

#: Share by which what is missing must shrink for the carried multiplier to count as rising, and
#: share by which it falls from its highest when the structure does.  Not measured.
SHRUNK = 0.1
FALLEN_BY = 0.1

#: Share of the displacement step that what stands moves less than: its joints close by far less.
#: Not measured.
GOES_ON = 0.1

#: Share of the peak by which a branch may fall in a step.  Not measured.
LAG = 0.01

#: Least and most change of the time step, descending.  Not measured.
LEAST_CHANGE = 0.7
MOST_CHANGE = 1.2

# Control: supports that move ---------------------------------------------------------------------

#: Smallest step over the largest.  Not measured.
SUPPORT_FLOOR = 1e-4

#: Motion of a block over that of the supports, or over as much as it was in the last step, above
#: which it jumps.  Not measured.
JUMP_RATIO = 5.0

#: Motion of a block over the smallest extent while supports are held, after which the structure has
#: fallen.  Convention: a block that has moved so far has left what it rested on.
SUPPORT_FALL = 1.0

#: Longest time step while supports are held, over the first.  Derived: that of a static step.
LONGEST_HELD = 300.0

#: How far from an unstable equilibrium a stable one is looked for, over the smallest extent, at
#: least and at most.  Range: portals with stiffness from 1e8 to 1e10 Pa/m: the same.
LEAST_DEPARTURE = 1e-4
MOST_DEPARTURE = 0.1

#: Of the largest reaction, by which it may leave its course in a step.  Not measured.
SUPPORT_BEND = 0.02

#: Steps that are looked at for a bend, over the smallest and over the first; and by how much a step
#: is shortened.  Not measured.
WORTH_BENDING = 20.0
WORTH_OF_FIRST = 0.05
SUPPORT_SHORTER = 0.3

#: Share of the supports' displacement that counts as all of it.  Derived: a rounding.
ALL_MOVED = 1.0 - ROUNDING
# Engines: frames, measures, bonds ----------------------------------------------------------------

#: Smallest side of a block of the published walls [m], and their unit weight [N/m3]: the size and
#: weight of the frame that engines work in.  Convention.
FRAME_SIZE = 0.175
FRAME_UNIT_WEIGHT = 10e3

#: Places that differ by no more [m, own units] are the same in the order of blocks: above what
#: roundings make of a thousand metres (1e-13 each), far below what anyone builds.
#: Derived: a rounding.
SAME_PLACE = ROUNDING

#: Acceleration of a block, over gravity, above which a point counts as passed dynamically.
#: Convention.
ACCELERATION_LIMIT = 0.3

#: Work of the load on the motion of a step, over the sum of its terms' sizes, under which motion is
#: across the load and virtual work says nothing of its multiplier.  Not measured.
ACROSS_THE_LOAD = 1e-2

#: Motion of a block, over that of the fastest, from which on a message names it.  Convention.
NAMED_MOTION = 0.1

#: Release of a bond, over the weight of the lighter of its blocks, that is too small to count.
#: Not measured.
SLIGHT = 1e-3

#: Share of an increment so small that the first bond breaks where the step starts.
#: Derived: a rounding.
LEAST_INCREMENT = ROUNDING

#: Of the margin at which a step ends for a bond (`AT_STRENGTH`): bonds that are nearer to each
#: other than this break together.  Not measured.
DUE_TOGETHER = 1e-3

# Dynamics: the distinct element method -----------------------------------------------------------

#: Time step over the critical one.
#: Derived: a stack of three blocks keeps the energy of its highest waves at 0.95, and explodes at
#: 1.02.
SAFETY = 0.9

#: Share of the unbalanced force that Cundall's local damping takes.  Not measured.
LOCAL_DAMPING = 0.5

#: Unbalanced force of a block at rest over its weight.  Convention: how well a point is known.
DISTINCT_TOLERANCE = 1e-5

#: Residual that a certificate may show, over the heaviest weight.  Derived: rest is looked for with
#: the forces of a cycle, its poses are those at the end of it; ten times what rest is.
DISTINCT_RESIDUAL = 1e-4

#: Motion between two searches over the smallest extent of a block.  Range, by `distinct`: one peak
#: (`plane` 8) by 3.3e-4, the others the same; steps by -9 %, nearly all of that one.
SEARCH_TOLERANCE = 2e-3

#: Open joints count for the time step of quasi-static cycles up to three times this share of the
#: smallest extent of a block, or of what blocks may move between two searches.
#: Not measured: it counts where every cycle searches, as `SEARCH_TOLERANCE` is greater.
WATCHED = 1e-3

#: How far away joints are watched, over what blocks may move between two searches.  Derived: two
#: blocks may move against each other, and both have moved on when it is seen.
WATCHED_REACH = 3.0

#: Displacement of a step over the smallest extent of a block.  Not measured.
DISTINCT_STEP = 0.01

#: How well a reaction is known at rest, over the unbalanced force of the lighter block: blocks in
#: a row lean on each other with what is left of several.  Not measured.
NOISE = 5.0

#: Margin of a bond at which a step ends for it: each try is a relaxation.  Not measured.
AT_STRENGTH = 1e-3

#: How many times nearer to its strength a step ends for a tie, whose force rest tells better.
#: Not measured.
TIES_NEARER = 20.0

#: Motion of any point of a block, over that of the control point which a step asks for, from which
#: on the increment does not measure it: the block moves by itself.  Range, doubled, by `distinct`:
#: one peak (`plane` 8) by 1.4e-4.
BY_ITSELF = 3.0

#: What a block moves by itself between two points, over its smallest extent.  Derived: steps of the
#: default length are jumps from there on (`SNAP_MOTION` times `DISTINCT_STEP`), and a block that
#: collapses, by half of its extent, is seen to within a fifth of that.
BETWEEN_POINTS = SNAP_MOTION * DISTINCT_STEP

#: Motion of a block, over its smallest extent, from which on it is asked whether it has left.
#: Convention.
MAY_HAVE_LEFT = 0.5

#: Rate of each stage in which a driven increment ends, over that of the one before.  Range, halved,
#: by `distinct`: one peak (`plane` 8) by 4e-4.
SLOWER = 0.25

#: Control displacement of the last step, over the motion of the fastest block, under which it is
#: rounding and no step to go on with.  Derived: a rounding.
ONWARDS = ROUNDING

#: Stiffness that a degree of freedom counts with at least, over the stiffest block's of its kind.
#: Range, by `distinct`: the same.
LEAST_STIFFNESS = 1e-3

#: Time step [s] of blocks that nothing is near to.  Convention: they fall freely, whatever it is.
FREE_TIME_STEP = 1e-3

#: Fewest cycles of a step under a given multiplier.  Derived: two, rounded: its two halves.
FEWEST_CYCLES = 1.5

# Dynamics: non-smooth contact dynamics -----------------------------------------------------------

#: True residual of a step over the heaviest weight.  Convention: how well a step is known.
NSCD_TOLERANCE = 5e-7

#: Residual that a certificate may show.  Derived: what a step is solved to, and as much for the
#: rounding of its poses.
NSCD_RESIDUAL = 2.0 * NSCD_TOLERANCE

#: Momentum defect at which the branches count as fixed, over the tolerance.  Derived: a tenth of
#: what is asked for.
BRANCHES_FIXED = 0.1

#: First time step under the dead load [s], and the least share of it.  Not measured.
DEAD_LOAD_TIME_STEP = 0.05
LEAST_TIME_STEP = 1e-4

#: Motion of a step from rest over what joints close by, under which it is at rest; and the least
#: closure that is reckoned with [m].  Derived: far below the joints' own closing; a rounding.
AT_REST_MOTION = 1e-3
LEAST_CLOSURE = ROUNDING

#: Penalty stiffness of sticking contacts, over the stiffest joint or, in short steps, the largest
#: mass at a contact.  The soft one is tried where Newton's method does not converge: it forgives
#: wrong branches.  Stiffer ones fix forces that a very small slip decides.  Derived: each 30 times
#: the one before, and the last two again.  Not measured.
SOFT_PENALTY = 30.0
STIFF_PENALTY = 1e3
STIFFER_PENALTY = SOFT_PENALTY * STIFF_PENALTY
STIFFEST_PENALTY = 1e6

#: Least share of a Newton step that is worth trying.  Not measured.
LEAST_NEWTON = 0.05

#: Barrier to begin with, over what an impulse of usual size stores in its joint.  Range: ten times
#: more, 3 % fewer iterations of eight solids, peaks by up to 1.3e-3.
FIRST_BARRIER_OF_IMPULSES = 1e-3

#: The least part of an iteration that is worth going on with.  Not measured.
LEAST_ITERATION = 1e-4

#: The products of the changes count where the step without a barrier gets so far.  Not measured.
FAR_ENOUGH = 0.5

#: Barrier over the first at which the branches can be told apart.  Not measured.
NEAR_BARRIER = 1e-5

#: Barrier over the first after `interior.PATIENCE` iterations, or there is nothing to be found.
#: Not measured.
LOW_BARRIER = 1e-3

#: Barrier that an iteration aims at, over the present one: at least, and at most.  Not measured.
LEAST_AIM = 1e-3
MOST_AIM = 0.8

#: Share by which an iteration is shortened where a contact turns too far.  Not measured.
SHORTENED = 0.8

# Statics: what a step is solved to ---------------------------------------------------------------

#: Largest unbalanced force that is promised, over the heaviest weight.
#: Derived: a thousand times the rounding of the sums that make it up, 4,500 of 2.2e-16.
BALANCE = 1e3 * SUMS

#: That which stiff joints may leave.  Derived: a thousand times what steps are solved to, so that
#: joints which rounding does not let be solved as well are told from those that only seem to be.
COARSEST = 1e3 * BALANCE

#: What may be missing of a control displacement [m].  Derived: `SUMS` of a metre.
MISSING = SUMS

#: Share of `BALANCE`, over the stiffest joint, that two contacts must differ by in their gaps.
#: Derived: a thousandth of what may be unbalanced.
TOLD_APART = 1e-3

#: Time step of a static step [s].  Derived: the inertia of a step of 1 mm is then 1e-7 of a weight.
STATIC_TIME_STEP = 30.0

#: Farthest motion of a block in one step, over the smallest block.  Convention: two blocks may
#: then close by twice as much, and the broad phase reaches `MARGIN_SHARE`.  Where some overlap that
#: were no pair, the step fails.
MOST_MOTION = 0.2

#: Pseudo-transient steps under the dead load: the first and the least time step [s], and growth.
#: Not measured.
DEAD_LOAD_STEP = 0.1
LEAST_DEAD_LOAD_STEP = 1e-5
LONGER_DEAD_LOAD_STEP = 100.0

#: Step of a control displacement over the height of the structure, and over the smallest block, at
#: least and at most.  Derived: a mechanism turns by 1 in 500 in it.  The shares: not measured.
STEP_OF_HEIGHT = 1.0 / 500.0
LEAST_STEP = 0.02
MOST_STEP = 0.1

#: Cosine of the angle to the vertical under which a joint lies, and is pressed by weight alone.
#: Derived: of 45 degrees, rounded.
LIES = 0.7

#: Force over the heaviest weight above which a contact that was not followed is added.
#: Range, 1e-5 and 1e-3: no peak of 36 random solids by 1e-4, iterations by 0.7 %.  With 1e-2 a
#: block that slides over a flush joint carries up to 1.5 % more than its friction.
PRESSED = 1e-4

#: Margin of a bond at which a step ends for it; and force over the heaviest weight by which the
#: strengths of joints may still change where a step ends.  Not measured.
ENDS_FOR_BOND = 1e-5
STRENGTHS_FIXED = 1e-6

# Statics: linear pieces, and matrices ------------------------------------------------------------

#: Smallest pivot of a block, over its largest entry, with which a direction is worth trying.
#: Derived: 450 roundings.
LEAST_PIVOT = 1e-13

#: Sliding back by less than this share of the blocks' motion does not end sliding.  Not measured.
SLOW = 1e-6

#: Share of a step by which a path comes farther at least, if it does.  Derived: the rounding of the
#: share in some hundred changes.
NOTHING_FARTHER = 1e-12

#: By how much a path may fall below its start before it has turned back.  Not measured.
BELOW_START = 1e-3

#: Most damping that a pivot is raised by, over the least.  Derived: a guard.
MOST_RAISED = 1e12

#: Time of a factorisation [ns] from which on threads gain.  Not measured.
WORTH_SHARING = 1e6

#: Time of a front's call [ns], and of a multiplication.  Derived: of one machine; only the order of
#: fronts hangs on them.
CALL_TIME = 100.0
MULTIPLICATION_TIME = 0.04

# Statics: the interior-point method --------------------------------------------------------------
# Energies are those of one contact over the energy that the weight of a mean block stores in one,
# forces over that weight, damping in 1/s2 of the frame, in which gravity over the smallest block is
# 56.

#: First barrier, and the more of it over the square of what is unbalanced.  Range: ten times more
#: or less, iterations of 18 curves in space by 11 to 12 %, peaks as they were.
FIRST_BARRIER = 1e-3
BY_UNBALANCED = 3e-3

#: Barrier of the last attempt, at which contacts begin as if each carried a block; and most barrier
#: for what is unbalanced.  Derived: the energy of one weight; three times that: not measured.
HIGH_BARRIER = 1.0
MOST_BARRIER = 3.0

#: More of the barrier of the last attempt, over the work of a weight along the increment.
#: Not measured.
BY_REACH = 0.05

#: Length of an iteration below which it is no progress; and the least barrier with which contacts
#: are centred anew.  Range: without, iterations by 12 % and failed steps by 80 %.
NO_PROGRESS = 0.2
RECENTRED_BARRIER = 1e-3

#: Radius of the neighbourhood of the central path, over the barrier: of the predictor; and of the
#: corrector, for the direction of slip.
#: Range: without either, iterations of 18 curves in space by less than 1 %.
PREDICTOR_RADIUS = 0.1
SLIP_RADIUS = 10.0

#: Barrier over the present one, at least and at most.  Convention of Mehrotra's method.
LEAST_REDUCTION = 1e-3
MOST_REDUCTION = 0.8

#: Energy at which branches may be told.
#: Not measured.
TELLS = 1e-10

#: Unbalanced force below which Newton's method is tried between iterations; factor by which it must
#: reduce that there.  Not measured.
NEWTON_RESIDUAL = 0.05
NEWTON_GAIN = 10.0

#: Factor by which Newton's method must reduce the unbalanced force in the first iterations of a
#: step.  Range: a factor of 2 in one or two iterations changes those of 36 random solids by 0.7 %,
#: and no peak.
WARM_GAIN = 30.0

#: Farthest rotation in an iteration [rad]: beyond, a direction is not of the linearised motion.
#: Range: curves of six bonded walls are the same to the last bit with 0.02 to 1.
FARTHEST_ROTATION = 0.2

#: Damping of an unstable matrix; damping above which a part counts as unsupported; most damping.
#: Range: four times more or less of the first, iterations in space by 5 %, peaks as they were.
DAMPING = 10.0
LOST_SUPPORT = 3e3
MOST_DAMPING = 1e9

#: Factors by which damping grows and falls, and that below which there is none.  Not measured.
MORE_DAMPING = 4.0
LESS_DAMPING = 0.25
LEAST_DAMPING = 3.0

#: Growth [1/s2] of a mode below which it is neutral, such as that of a joint that slides as a
#: whole.  Derived: a hundredth of gravity over the smallest block, below which a block needs ten
#: times as long to leave as to fall over.
NEUTRAL = 0.5

#: Length of an iteration above which damping is reduced; and factor by which an iteration is
#: shortened in which a slip changes its direction too far.  Not measured.
GOOD_LENGTH = 0.9
LENGTH_SHORTER = 0.8

#: Shares of a step at which its shape is looked at.  Range: with 9 or 39 of them peaks of bonded
#: walls move by up to 8e-4, by where points lie.
FIRST_SHARE_SEEN = 0.05
LAST_SHARE_SEEN = 0.95

# Statics: joints that yield ----------------------------------------------------------------------

#: Least and greatest relaxation factor of the state of softening.  Not measured.
LEAST_RELAXATION = 0.3
MOST_RELAXATION = 10.0

#: Force that Newton's method may leave, over the force by which strengths may still change.
#: Not measured.
LEFT = 5e-4

#: Share of a step up to which it is repeated, at most.  Range: peaks are the same with 0.95, and
#: move by up to 8e-4 with 0.35.
FARTHEST_AGAIN = 0.7

#: Bend over the drop, under which the path with the strengths at the start is straight.  Not
#: measured.
STRAIGHT = 0.1
