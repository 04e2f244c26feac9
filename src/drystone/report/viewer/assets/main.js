// Puts the parts together: what is shown, and what changes it.

import { Camera } from "./camera.js";
import { decode, inflate } from "./codec.js";
import { CurvePlot } from "./curve.js";
import { Record } from "./data.js";
import { FlatScene } from "./flat.js";
import { Gestures } from "./gestures.js";
import { KEYS, action, takesKey } from "./keyboard.js";
import { overlay } from "./overlays.js";
import { PAINTINGS, paint, paintJoints } from "./painting.js";
import {
  carriedLegend, jointsOf, legend, list, ofBlock, ofJoint, ofLoads, ofPoint, ofTies,
} from "./panel.js"; // prettier-ignore
import { Picker } from "./picking.js";
import { Ribbons } from "./ribbons.js";
import { WebScene, context } from "./scene.js";
import { Section } from "./section.js";
import { Timeline } from "./timeline.js";

const $ = (id) => document.getElementById(id);
/** Displacements are enlarged to this share of the structure's size where "readable" is chosen. */
const READABLE = 0.05;

export class Viewer {
  constructor(record) {
    this.record = record;
    this.canvas = $("picture");
    this.camera = new Camera(record.extent, record.dimension, record.header.load_direction);
    this.section = new Section(record.box);
    this.picker = new Picker(record);
    this.ribbons = new Ribbons();
    this.show = { joints: false, forces: false, thrust: false, marks: true, through: false, ties: true, loads: true };
    this.by = "displacement";
    this.factor = 1;
    this.selected = null; // { block } or { joint }
    this.truePoses = record.posesAt(0, 1);
    this.poses = record.posesAt(0, 1);
    this.displacement = new Float32Array(record.owner.length);
    this.colours = new Uint8Array(4 * record.owner.length);
    this.jointColours = new Uint8Array((4 * record.joints.corners.length) / 3);
    this.labels = Object.values(record.header.macro_blocks)[0] || null;
    this.timeline = new Timeline(record.nPoints, () => this.changed());
    this.frames = 0; // drawn so far
    this.ready = false; // whether it is known by what the structure is drawn
    this._scene();
    this._controls();
    this._resize();
    new ResizeObserver(() => this._resize()).observe(this.canvas);
    this.draw();
  }

  /** Painted at once; WebGL takes over as soon as it is ready, where there is any. */
  _scene() {
    this.scene = this.flat = new FlatScene(this.canvas, this.record);
    this.webgl = false;
    const later = () => setTimeout(() => this._startWebgl(), 0); // the first picture goes before
    requestAnimationFrame(() => requestAnimationFrame(later));
  }

  _startWebgl() {
    const layer = $("web");
    const gl = context(layer);
    if (!gl) {
      this._without("This browser has no WebGL");
      return;
    }
    layer.addEventListener("webglcontextlost", () => this._without("WebGL was lost"));
    this.scene = new WebScene(layer, gl, this.record);
    this.webgl = true;
    this._resize();
    this.draw();
    layer.hidden = false;
    this.ready = true;
    performance.mark("webgl");
  }

  _without(why) {
    $("web").hidden = true;
    $("note").hidden = false;
    $("note").textContent = `${why}: the structure is drawn in a simpler way, and nothing is seen through.`;
    this.scene = this.flat;
    this.webgl = false;
    this.ready = true;
    this._resize();
  }

  get point() {
    return this.timeline.point;
  }

  /** Show a point of the curve. */
  go(point) {
    this.timeline.pause();
    this.timeline.go(point);
  }

  /** Draw again with the next picture of the screen. */
  changed() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => this._frame(now));
  }

  _frame(now) {
    this.waiting = false;
    if (this.timeline.playing) {
      this.timeline.tick(this.last === undefined ? 0 : (now - this.last) / 1e3);
      this.last = now;
      this.changed();
    } else {
      this.last = undefined;
    }
    this.draw();
  }

  draw() {
    const { record, point, show } = this;
    const states = this.by === "joint states";
    record.posesAt(point, 1, this.truePoses);
    record.posesAt(point, this._factor(), this.poses);
    const options = {
      by: this.by,
      truePoses: this.truePoses,
      displacement: this.displacement,
      labels: this.labels,
      selected: this.selected,
    };
    const shown = paint(record, options, this.colours);
    const faces = record.dimension === 3 && (states || show.joints);
    if (faces) paintJoints(record, point, this.jointColours);
    const wanted = { ...show, joints: show.joints || states };
    overlay(this.ribbons, record, this.poses, point, wanted, this.selected, this.section);
    const through = show.through || (record.dimension === 3 && wanted.joints);
    this.scene.draw({
      poses: this.poses,
      colours: this.colours,
      jointColours: faces ? this.jointColours : null,
      ribbons: this.ribbons,
      camera: this.camera,
      section: this.section,
      opacity: through ? 0.35 : 1,
    });
    this._tell(shown, wanted.joints);
    this.frames++;
  }

  /** How many times displacements are taken. */
  _factor() {
    if (this.factor > 0) return this.factor;
    const most = this.record.displacements(this.truePoses, this.displacement);
    const wanted = (READABLE * this.record.size) / (most || Infinity);
    if (!(wanted > 2.5)) return 1;
    const power = 10 ** Math.floor(Math.log10(wanted));
    return Math.min(Math.max(...[1, 2, 5].map((s) => s * power).filter((s) => s <= wanted)), 1e5);
  }

  _tell(shown, joints) {
    const { record, point } = this;
    legend($("legend"), shown, joints, carriedLegend(record, point, this.show));
    list($("ties"), ofTies(record, point));
    const rows = ofPoint(record, point);
    const factor = this._factor();
    if (factor !== 1) rows.push(["displacements", `× ${factor}`]);
    list($("state"), rows);
    if (record.curve) {
      this.plot.move(point);
      $("slider").value = point;
      $("slider").setAttribute("aria-valuetext", rows.slice(0, 3).map((r) => r.join(" ")).join(", "));
      $("play").setAttribute("aria-pressed", String(this.timeline.playing));
      $("play").textContent = this.timeline.playing ? "❚❚" : "▶";
      if (!this.timeline.playing) $("live").textContent = rows.slice(0, 3).map((r) => r.join(" ")).join(", ");
    }
    this._tellSelected();
  }

  _tellSelected() {
    const { record, point, selected } = this;
    if (!selected) {
      list($("details"), []);
      if ($("joints").children.length) $("joints").replaceChildren();
      this.listed = null;
      return;
    }
    if (selected.joint !== undefined) list($("details"), ofJoint(record, point, selected.joint));
    else list($("details"), ofBlock(record, point, this.truePoses, selected.block));
    const key = JSON.stringify(selected);
    if (this.listed === key) return; // buttons keep the focus while the structure moves
    this.listed = key;
    const { joints, names } = record;
    const buttons =
      selected.joint !== undefined
        ? [joints.a[selected.joint], joints.b[selected.joint]].map((block) =>
            this._button(names[block], { block }),
          )
        : jointsOf(record, selected.block).map((joint) => {
            const other = joints.a[joint] === selected.block ? joints.b[joint] : joints.a[joint];
            return this._button(`joint with ${names[other]}`, { joint });
          });
    $("joints").replaceChildren(...buttons);
  }

  _button(words, selected) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: words });
    button.addEventListener("click", () => this.select(selected));
    return button;
  }

  select(selected) {
    this.selected = selected;
    if (selected && selected.block !== undefined) $("name").value = this.record.names[selected.block];
    this.changed();
  }

  /** What is under a pixel of the picture: { block }, { joint } or null. */
  under(x, y, touch = false) {
    const { camera, section, picker, poses, show } = this;
    const through = show.joints || show.thrust || this.by === "joint states" || show.through;
    const hit = picker.block(poses, camera.ray(x, y), section);
    const reach = (touch ? 14 : 5) * (this.record.dimension === 3 && !through ? 0.6 : 1);
    const joint = picker.joint(poses, camera, x, y, reach, { section, hit, throughBlocks: through });
    if (joint) return { joint: joint.joint };
    return hit ? { block: hit.block } : null;
  }

  _resize() {
    const box = this.canvas.getBoundingClientRect();
    if (!box.width || !box.height) return;
    this.camera.resize(box.width, box.height);
    this.scene.resize(box.width, box.height, Math.min(window.devicePixelRatio || 1, 2));
    if (this.plot) this.plot.draw();
    this.changed();
  }

  _controls() {
    const { record } = this;
    new Gestures(this.canvas, this.camera, {
      changed: () => this.changed(),
      clicked: (x, y, touch) => this.select(this.under(x, y, touch)),
    });
    document.addEventListener("keydown", (event) => this._key(event));
    this._curveControls();
    this._lists();
    for (const box of document.querySelectorAll("[data-show]")) {
      box.addEventListener("change", () => {
        this.show[box.dataset.show] = box.checked;
        this.changed();
      });
    }
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => this._view(button.dataset.view));
    }
    for (const button of document.querySelectorAll("[data-zoom]")) {
      button.addEventListener("click", () => this._zoom(Number(button.dataset.zoom)));
    }
    $("find").addEventListener("submit", (event) => event.preventDefault());
    $("name").addEventListener("change", () => {
      const block = record.names.indexOf($("name").value.trim());
      this.select(block >= 0 ? { block } : null);
    });
    for (const [box, count] of [["ties", record.ties.n], ["loads", record.arrows.length]]) {
      for (const part of document.querySelectorAll(`[data-of="${box}"]`)) part.hidden = !count;
    }
    list($("loads"), ofLoads(record));
    list($("keys"), KEYS.map(({ shown, does }) => [shown, does]));
  }

  _curveControls() {
    const { record } = this;
    if (!record.curve) return;
    this.plot = new CurvePlot($("curve"), record, (k) => this.go(k));
    $("steep").hidden = !this.plot.steep;
    $("steep").addEventListener("click", () => {
      this.plot.zoomed = !this.plot.zoomed;
      $("steep").setAttribute("aria-pressed", String(this.plot.zoomed));
      this.plot.draw();
    });
    $("slider").max = record.nPoints - 1;
    $("slider").addEventListener("input", () => this.go(Number($("slider").value)));
    $("play").addEventListener("click", () => this.timeline.toggle());
    $("speed").addEventListener("change", () => (this.timeline.rate = Number($("speed").value)));
    for (const mark of record.marks) {
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: mark.name });
      button.addEventListener("click", () => this.go(mark.point));
      $("marks").append(button);
    }
  }

  _lists() {
    const { record } = this;
    const states = Object.keys(record.header.macro_blocks);
    const known = { "macro-blocks": states.length > 0, plain: true };
    const ways = PAINTINGS.filter((way) => known[way] ?? record.nPoints > 1);
    for (const way of ways) $("colour").append(new Option(way, way));
    this.by = record.nPoints > 1 ? "displacement" : "plain";
    $("colour").value = this.by;
    $("colour").addEventListener("change", () => this.colourBy($("colour").value));
    for (const state of states) $("bodies").append(new Option(state, state));
    $("bodies").addEventListener("change", () => {
      this.labels = record.header.macro_blocks[$("bodies").value];
      this.changed();
    });
    $("factor").addEventListener("change", () => {
      this.factor = Number($("factor").value);
      this.changed();
    });
    $("axis").addEventListener("change", () => {
      this.section.axis = $("axis").value === "" ? null : Number($("axis").value);
      $("cut-label").hidden = $("flip-label").hidden = this.section.axis === null;
      this.changed();
    });
    $("cut").addEventListener("input", () => {
      this.section.share = Number($("cut").value) / 100;
      this.changed();
    });
    $("flip").addEventListener("change", () => {
      this.section.flipped = $("flip").checked;
      this.changed();
    });
    $("names").append(...record.names.slice(0, 2000).map((name) => new Option(name, name)));
  }

  colourBy(way) {
    this.by = way;
    $("colour").value = way;
    $("bodies-label").hidden = way !== "macro-blocks" || $("bodies").options.length < 2;
    this.changed();
  }

  _view(name) {
    if (name === "home") this.camera.reset();
    else this.camera.look(name);
    this.changed();
  }

  _zoom(factor) {
    this.camera.zoomAt(factor);
    this.changed();
  }

  _key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (takesKey(document.activeElement, event.key)) return;
    const wanted = action(event.key, event.shiftKey);
    if (!wanted) return;
    event.preventDefault();
    this.act(wanted);
  }

  /** Do what a key means. */
  act({ name, value }) {
    const does = {
      step: () => this.timeline.step(value),
      go: () => this.go(value),
      play: () => this.timeline.toggle(),
      mark: () => this._nextMark(),
      orbit: () => this.camera.orbit(...value),
      zoom: () => this.camera.zoomAt(value),
      home: () => this.camera.reset(),
      colour: () => {
        const ways = [...$("colour").options].map((option) => option.value);
        this.colourBy(ways[(ways.indexOf(this.by) + 1) % ways.length]);
      },
      toggle: () => document.querySelector(`[data-show="${value}"]`).click(),
      clear: () => this.select(null),
      help: () => ($("help").open = !$("help").open),
    };
    does[name]();
    this.changed();
  }

  _nextMark() {
    const points = this.record.marks.map((mark) => mark.point);
    if (!points.length) return;
    this.go(points[(points.indexOf(this.point) + 1) % points.length]);
  }
}

/** Read what the page holds and show it; the viewer stays in reach of scripts as `drystone`. */
export async function start() {
  performance.mark("begun");
  const header = JSON.parse($("header").textContent);
  const bytes = await inflate($("streams").textContent.trim());
  performance.mark("inflated");
  const viewer = new Viewer(new Record(header, decode(bytes, header.streams)));
  window.drystone = viewer;
  document.body.classList.add("drawn");
  performance.mark("drawn");
  return viewer;
}

start().catch((error) => {
  $("loading").textContent = `The results cannot be shown: ${error.message}`;
  throw error;
});
