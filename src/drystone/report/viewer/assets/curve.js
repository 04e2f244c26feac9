// The curve beside the structure: multiplier against control displacement, as SVG.  Dragging on it
// moves along the points.

import { digits } from "./format.js";

const NS = "http://www.w3.org/2000/svg";
const FORCES = 68; // instead of the left margin, where the ordinate is a force
const MARGIN = { left: 52, right: 14, top: 14, bottom: 40 };

/** Round values from low to high, about `count` of them. */
export function ticks(low, high, count) {
  const span = high - low || 1;
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= rough) || 10 * power;
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * span; n++) {
    found.push(Number((n * step).toPrecision(12)));
  }
  return found;
}

/** Maps values to pixels. */
export class Axis {
  constructor(low, high, from, to) {
    Object.assign(this, { low, high: high > low ? high : low + 1, from, to });
  }

  at(value) {
    return this.from + ((value - this.low) / (this.high - this.low)) * (this.to - this.from);
  }
}

/** Index of the point nearest to a pixel; what is near along the curve goes before. */
export function nearestPoint(x, y, xs, ys, current, plain = false) {
  let [best, least] = [current, Infinity];
  for (let k = 0; k < xs.length; k++) {
    const across = plain ? 1 : 0.35; // what one drags along is mostly the displacement
    const gap = Math.hypot(x - xs[k], across * (y - ys[k]));
    const far = 0.02 * Math.min(Math.abs(k - current), 200);
    if (gap + far < least) [best, least] = [k, gap + far];
  }
  return best;
}

/** Runs of points without a dynamic one in them, as SVG paths. */
export function paths(xs, ys, dynamic) {
  const [still, jumps] = [[], []];
  let down = false;
  for (let k = 0; k < xs.length; k++) {
    const at = `${xs[k].toFixed(1)} ${ys[k].toFixed(1)}`;
    if (dynamic[k]) {
      down = false;
      continue;
    }
    still.push(`${down ? "L" : "M"}${at}`);
    down = true;
  }
  for (let k = 1; k < xs.length; k++) {
    if (!dynamic[k] && !dynamic[k - 1]) continue;
    const from = `M${xs[k - 1].toFixed(1)} ${ys[k - 1].toFixed(1)}`;
    jumps.push(`${from}L${xs[k].toFixed(1)} ${ys[k].toFixed(1)}`);
  }
  return { still: still.join(""), jumps: jumps.join("") };
}

export class CurvePlot {
  constructor(svg, record, choose) {
    Object.assign(this, { svg, record, choose, point: 0, zoomed: false });
    svg.addEventListener("pointerdown", (event) => {
      svg.setPointerCapture(event.pointerId);
      this._drag(event);
    });
    svg.addEventListener("pointermove", (event) => event.buttons && this._drag(event));
  }

  /** Whether the ascending branch is so short that it deserves a picture of its own. */
  get steep() {
    const peak = this.record.marks.find((mark) => mark.kind === "peak");
    return Boolean(peak && peak.displacement < 0.1 * Math.max(...this.record.curve.displacement));
  }

  draw() {
    const { curve, marks } = this.record;
    const box = this.svg.getBoundingClientRect();
    const [width, height] = [Math.max(box.width, 120), Math.max(box.height, 90)];
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.replaceChildren();
    this.left = curve.axes && curve.axes.force_unit ? FORCES : MARGIN.left;
    const peak = marks.find((mark) => mark.kind === "peak");
    let [low, high] = [Math.min(0, ...curve.displacement), Math.max(...curve.displacement)];
    if (this.zoomed && peak) [low, high] = [0, 4 * peak.displacement];
    const most = Math.max(0, ...curve.multiplier);
    const least = Math.min(0, ...curve.multiplier.filter((value, k) => !curve.dynamic[k]));
    this.x = new Axis(low, high, this.left, width - MARGIN.right);
    this.y = new Axis(least, 1.1 * most || 1, height - MARGIN.bottom, MARGIN.top);
    this.xs = curve.displacement.map((value) => this.x.at(value));
    this.ys = curve.multiplier.map((value) => this.y.at(value));
    this._axes(width, height);
    const clip = this._add("g", { "clip-path": "url(#plot-area)" });
    const { still, jumps } = paths(this.xs, this.ys, curve.dynamic);
    this._add("path", { d: jumps, class: "jump" }, clip);
    this._add("path", { d: still, class: "curve" }, clip);
    for (const mark of marks) this._mark(mark, clip);
    this.cursor = this._add("g", { class: "cursor" }, clip);
    this._add("line", { class: "thread", y1: MARGIN.top, y2: height - MARGIN.bottom }, this.cursor);
    this._add("circle", { r: 6.5 }, this.cursor);
    this.move(this.point);
  }

  _axes(width, height) {
    const [bottom, left] = [height - MARGIN.bottom, this.left];
    const defs = this._add("defs", {});
    const area = this._add("clipPath", { id: "plot-area" }, defs);
    this._add("rect", { x: left - 8, y: 0, width: width - left, height: bottom + 8 }, area);
    const axes = this.record.curve.axes || { motion: "control displacement", motion_unit: "m" };
    const small = axes.motion_unit === "m" && this.x.high < 0.1;
    for (const value of ticks(this.x.low, this.x.high, Math.max(2, width / 90))) {
      const x = this.x.at(value);
      this._add("line", { x1: x, x2: x, y1: MARGIN.top, y2: bottom, class: "grid" });
      this._text(digits(small ? 1e3 * value : value, 4), x, bottom + 14, "middle");
    }
    for (const value of ticks(this.y.low, this.y.high, Math.max(2, height / 45))) {
      const y = this.y.at(value);
      this._add("line", { x1: left, x2: width - MARGIN.right, y1: y, y2: y, class: "grid" });
      this._text(digits(value, 3), left - 6, y + 4, "end");
    }
    const middle = 0.5 * (left + width - MARGIN.right);
    const unit = small ? "mm" : axes.motion_unit;
    this._text(`${axes.motion} [${unit}]`, middle, height - 8, "middle");
    const force = axes.force_unit ? `${axes.force} [${axes.force_unit}]` : "load multiplier λ";
    const label = this._text(force, 0, 0, "middle");
    label.setAttribute("transform", `translate(13 ${0.5 * (MARGIN.top + bottom)}) rotate(-90)`);
  }

  _mark(mark, parent) {
    const [x, y] = [this.x.at(mark.displacement), this.y.at(mark.multiplier)];
    const group = this._add("g", { class: `mark ${mark.kind}` }, parent);
    const title = this._add("title", {}, group);
    title.textContent = mark.name;
    if (mark.kind === "peak" || mark.kind === "rest") this._add("circle", { cx: x, cy: y, r: 4 }, group);
    else this._add("path", { d: `M${x - 5} ${y}L${x} ${y - 5}L${x + 5} ${y}L${x} ${y + 5}Z` }, group);
    const right = x > 0.75 * this.x.to;
    // What happens is told by the title and by the mark's button: it would leave the axes.
    const words = mark.kind === "event" ? "a part collapses" : mark.name;
    const text = this._text(words, x + (right ? -8 : 8), y - 7, right ? "end" : "start", group);
    text.setAttribute("class", "name");
  }

  _text(words, x, y, anchor, parent) {
    const text = this._add("text", { x, y, "text-anchor": anchor }, parent);
    text.textContent = words;
    return text;
  }

  _add(name, attributes, parent = this.svg) {
    const element = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    parent.append(element);
    return element;
  }

  /** Put the cursor on point k. */
  move(k) {
    this.point = k;
    if (!this.cursor) return;
    const [thread, circle] = this.cursor.children;
    thread.setAttribute("x1", this.xs[k]);
    thread.setAttribute("x2", this.xs[k]);
    circle.setAttribute("cx", this.xs[k]);
    circle.setAttribute("cy", this.ys[k]);
  }

  _drag(event) {
    const box = this.svg.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const first = event.type === "pointerdown";
    this.choose(nearestPoint(x, y, this.xs, this.ys, this.point, first));
  }
}
