"""Names of the files of a folder of results."""

SUMMARY, CURVE, RESULTS, TIES = "summary.json", "curve.csv", "results.h5", "ties.csv"
CURVE_FIGURE, MECHANISM_FIGURE, PARAVIEW = "curve.png", "mechanism.png", "paraview"
#: Of pictures.
FORMATS = ("png", "svg", "pdf")
