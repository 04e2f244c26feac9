"""Names of the flow rules of joints in limit analysis."""

#: Joints dilate by their friction angle; or by their own dilatancy angle.
ASSOCIATIVE, NON_ASSOCIATIVE = "associative", "non-associative"
FLOWS = (ASSOCIATIVE, NON_ASSOCIATIVE)
