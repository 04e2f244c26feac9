"""What shapes are and where they touch: outlines, joints as designed; of the plane so far."""


class GeometryError(ValueError):
    """A shape that cannot be a block; the message says what is wrong and how to mend it."""
