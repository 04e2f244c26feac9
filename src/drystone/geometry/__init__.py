"""What shapes are and where they touch: outlines, solids, joints as designed; and how they move."""


class GeometryError(ValueError):
    """A shape that cannot be a block; the message says what is wrong and how to mend it."""
