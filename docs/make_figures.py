"""Draw the figures of the README and of these pages, docs/images/*.png.

python docs/make_figures.py [--built] [--laboratory] [--engine NAME]
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import tempfile
from pathlib import Path

import drystone as ds
from drystone.report import Mechanism, canvas, draw_curve, draw_mechanism
from drystone.report.mechanism_figure import plot_mechanism

HERE = Path(__file__).parent
IMAGES = HERE / "images"
EXAMPLES = HERE.parent / "examples"
AT = 0.2  # m, control displacement of the mechanism, the published one
OVERSHOOTS = (1.005, 1.02, 1.05)
#: Width, and colours, of the pictures of laboratory tests.
MOST_PIXELS, COLOURS = 1400, 128


def example(name: str, engine: str | None) -> None:
    """Curve and mechanism of one of the examples."""
    model = ds.read_model(EXAMPLES / f"{name}.toml")
    curve = ds.pushover(model, engine=engine, keep_poses=True, keep_contacts=True)
    draw_curve(curve, IMAGES / f"{name}_curve.png", title=model.title)
    row = curve.nearest(AT)
    point = curve.points[row]
    mechanism = Mechanism(
        assembly=model.assembly,
        pose=curve.poses[row],
        initial=curve.poses[0],
        contacts=curve.contacts[row],
        load_direction=model.load_along,
        control_point=model.control_point,
    )
    title = f"{model.title} at a control displacement of {point.control_displacement:.3f} m"
    draw_mechanism(mechanism, IMAGES / f"{name}_mechanism.png", title=title)


#: The pictures that the tutorials show, by example.
SHOWN = {
    "first_wall": ("model", "curve", "mechanism"),
    "gate": ("model", "mechanism"),
    "tied_facade": ("mechanism",),
}


def tutorials() -> None:
    """The pictures of the tutorials: what their commands write, under the names that they show."""
    target = IMAGES / "tutorials"
    for name, pictures in SHOWN.items():
        path = EXAMPLES / f"{name}.toml"
        model = ds.read_model(path)
        curve = ds.pushover(model, keep_poses=True, keep_contacts=True)
        with tempfile.TemporaryDirectory() as folder:
            ds.save_results(curve, model, folder)
            if "model" in pictures:
                shown = ["drystone", "show", path, "--out", f"{folder}/model.png"]
                subprocess.run(shown, check=True)
            for picture in pictures:
                shutil.copy(Path(folder) / f"{picture}.png", target / f"{name}_{picture}.png")


def of_the_study() -> None:
    """Curves and effects of the tutorial on studies: its study file, run."""
    page = (HERE / "tutorials" / "study.md").read_text(encoding="utf-8")
    study = page.split("<!-- file: friction.toml -->\n```toml\n")[1].split("```")[0]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "friction.toml"
        file.write_text(study, encoding="utf-8")
        shutil.copy(EXAMPLES / "first_wall.toml", file.with_name("wall.toml"))
        out = file.with_name("out")
        for more in ([], ["--sample", "30"]):
            subprocess.run(["drystone", "study", file, "--out", out, *more], check=True)
        for picture in (out / "bands.png", out / "tornado.png", out / "sample_30/mechanism.png"):
            shutil.copy(picture, IMAGES / "tutorials" / f"study_{picture.name}")


def of_laboratories() -> None:
    """Measured walls beside computed ones, in few colours: what `drystone benchmark laboratory`
    draws."""
    from PIL import Image

    target = IMAGES / "laboratory"
    target.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            ["drystone", "benchmark", "laboratory", "--quiet", "--out", folder], check=True
        )
        for what in ("monotonic", "cyclic", "cracks"):
            picture = Image.open(Path(folder) / f"laboratory_{what}.png").convert("RGB")
            picture.thumbnail((MOST_PIXELS, 2 * MOST_PIXELS), Image.Resampling.LANCZOS)
            picture.quantize(COLOURS).save(target / f"{what}.png", optimize=True)


def bias() -> None:
    """The published strategy with several overshoots beside the static curve, wall 1."""
    model = ds.published_wall(1)
    figure = canvas.new_figure(7.5, 4.6)
    axes = figure.subplots()
    curves = [
        (f"published, overshoot {f:g}: applied", {"strategy": "published", "overshoot": f})
        for f in reversed(OVERSHOOTS)
    ]
    curves.append(("displacement: static", {"strategy": "displacement"}))
    colours = (*canvas.CURVE_COLOURS[1 : len(curves)], canvas.CURVE_COLOURS[0])
    styles = (*canvas.CURVE_STYLES[1 : len(curves)], canvas.CURVE_STYLES[0])
    for (label, options), colour, style in zip(curves, colours, styles, strict=True):
        curve = ds.pushover(model, engine="nscd", **options)
        axes.plot(
            curve.control_displacement,
            curve.load_multiplier,
            color=colour,
            linestyle=style,
            label=label,
            linewidth=1.4,
        )
    canvas.plain_axes(axes)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("control displacement $δ_c$ [m]")
    axes.set_ylabel("load multiplier $λ$ [-]")
    axes.set_title("Wall 1, engine nscd: the overshoot lifts the branch", fontsize=11)
    axes.legend(frameon=False, fontsize=9)
    canvas.save(figure, IMAGES / "bias.png")


def built() -> None:
    """A picture of every example of builders, docs/images/builders/*.png."""
    folder = IMAGES / "builders"
    folder.mkdir(exist_ok=True)
    for path in sorted((EXAMPLES / "builders").glob("*.toml")):
        assembly = ds.read_model(path).assembly
        figure = canvas.new_figure(5.0, 5.0)
        axes = figure.subplots()
        plot_mechanism(axes, Mechanism(assembly=assembly, pose=assembly.design_pose()))
        axes.set_axis_off()
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        ratio = (top - bottom) / (right - left)
        figure.set_size_inches(5.0, min(5.0 * ratio, 6.0))
        canvas.save(figure, folder / f"{path.stem}.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--built", action="store_true", help="those of builders alone")
    parser.add_argument("--laboratory", action="store_true", help="those of walls alone")
    parser.add_argument("--engine", help="of the examples' pictures; default: what the model says")
    arguments = parser.parse_args()
    IMAGES.mkdir(exist_ok=True)
    if arguments.laboratory:
        of_laboratories()
        return
    built()
    if arguments.built:
        return
    for name in ("wall1", "facade"):
        example(name, arguments.engine)
    tutorials()
    of_the_study()
    bias()
    of_laboratories()


if __name__ == "__main__":
    main()
