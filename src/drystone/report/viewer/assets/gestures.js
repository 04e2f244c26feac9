// Mouse and fingers on the picture: orbit, pan, zoom, click.

const CLICK = 5; // pixels that a finger may tremble

export class Gestures {
  constructor(element, camera, { changed, clicked }) {
    Object.assign(this, { element, camera, changed, clicked, pointers: new Map(), moved: 0 });
    element.addEventListener("pointerdown", (event) => this._down(event));
    element.addEventListener("pointermove", (event) => this._move(event));
    for (const name of ["pointerup", "pointercancel"]) {
      element.addEventListener(name, (event) => this._up(event));
    }
    element.addEventListener("wheel", (event) => this._wheel(event), { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  _place(event) {
    const box = this.element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  _down(event) {
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this._place(event));
    if (this.pointers.size === 1) this.moved = 0;
    else this.moved = Infinity; // two fingers are no click
  }

  _move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this._place(event);
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    this.moved += Math.hypot(dx, dy);
    if (this.pointers.size === 1) {
      const aside = event.shiftKey || event.ctrlKey || event.buttons > 1;
      if (this.moved > CLICK) aside ? this.camera.pan(dx, dy) : this.camera.orbit(dx, dy);
    } else {
      this._pinch(event.pointerId, before, now);
    }
    this.pointers.set(event.pointerId, now);
    this.changed();
  }

  /** Two fingers: what lies between them moves and grows with them. */
  _pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const apart = (p) => Math.hypot(p.x - other.x, p.y - other.y);
    const [x, y] = [0.5 * (now.x + other.x), 0.5 * (now.y + other.y)];
    this.camera.pan(0.5 * (now.x - before.x), 0.5 * (now.y - before.y));
    if (apart(before) > 1) this.camera.zoomAt(apart(now) / apart(before), x, y);
  }

  _up(event) {
    const last = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    if (last && event.type === "pointerup" && this.moved <= CLICK && !this.pointers.size) {
      this.clicked(last.x, last.y, event.pointerType === "touch");
    }
  }

  _wheel(event) {
    event.preventDefault();
    const { x, y } = this._place(event);
    this.camera.zoomAt(Math.exp(-0.0015 * event.deltaY), x, y);
    this.changed();
  }
}
