// The state that the parts of the page share: the data of the run, and the time of the common cursor.

const page = {
  data: {},
  time: 0,
  listeners: [],

  /** Calls `listener(time, source)` whenever the cursor moves. */
  onTime(listener) {
    this.listeners.push(listener);
  },

  /** Moves the cursor to a time [s]; `source` names the part of the page that moved it. */
  setTime(time, source) {
    this.time = time;
    for (const listener of this.listeners) listener(time, source);
  },
};

/** Inflates the data of the page, which are JSON in the format zlib in base64. */
async function readData() {
  const bytes = Uint8Array.from(atob(document.getElementById("data").textContent), (c) =>
    c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).json();
}

/** Returns the value of a CSS variable of the page, such as "--text". */
function cssColor(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Creates an element with attributes and children. */
function element(tag, attributes = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) out.addEventListener(name.slice(2), value);
    else if (value !== false) out.setAttribute(name, value === true ? "" : value);
  }
  out.append(...children);
  return out;
}

/** Returns a number with four significant digits and its unit. */
function shown(value, unit = "") {
  if (value === null || value === undefined) return "-";
  const size = Math.abs(value);
  const plain = size === 0 || (size >= 1e-3 && size < 1e5);
  const text = plain ? String(Number(value.toPrecision(4))) : value.toExponential(3);
  return text.replace(/\.?0+e/, "e") + (unit ? " " + unit : "");
}

/**
 * A canvas that shows the plane. It is as wide as its parent and keeps the shape of the shown box;
 * the y axis points upwards.
 */
class PlaneCanvas {
  constructor(parent, box, draw, margin = 0.06) {
    const size = Math.max(box[2] - box[0], box[3] - box[1]);
    const m = margin * size;
    this.box = [box[0] - m, box[1] - m, box[2] + m, box[3] + m];
    this.draw = draw;
    this.canvas = element("canvas", { role: "img" });
    parent.append(this.canvas);
    new ResizeObserver(() => this.resize()).observe(parent);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    this.resize();
  }

  resize() {
    const width = this.canvas.parentElement.clientWidth;
    if (width === 0) return;
    const [w, h] = [this.box[2] - this.box[0], this.box[3] - this.box[1]];
    this.scale = Math.min(width / w, (0.75 * innerHeight) / h);
    const height = Math.max(60, this.scale * h);
    this.left = 0.5 * (width - this.scale * w);
    const ratio = devicePixelRatio || 1;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.height = height + "px";
    this.redraw();
  }

  redraw() {
    if (!this.scale) return;
    const context = this.canvas.getContext("2d");
    const ratio = devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.draw(context, this);
  }

  /** Returns the pixel of a point of the plane. */
  pixel(x, y) {
    return [this.left + this.scale * (x - this.box[0]), this.scale * (this.box[3] - y)];
  }

  /** Adds a closed or open line through points [x0, y0, x1, y1, ...] to the path of a context. */
  addLine(context, points, closed = true) {
    for (let k = 0; k + 1 < points.length; k += 2) {
      const [x, y] = this.pixel(points[k], points[k + 1]);
      if (k === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    }
    if (closed) context.closePath();
  }
}

/** Calls `step(seconds)` for every picture of the screen while it plays. */
class Player {
  constructor(step) {
    this.step = step;
    this.button = element("button", { type: "button", onclick: () => this.toggle() });
    this.label();
  }

  get plays() {
    return this.last !== undefined;
  }

  label() {
    this.button.textContent = this.plays ? "Pause" : "Play";
  }

  toggle() {
    if (this.plays) {
      this.last = undefined;
    } else {
      this.last = performance.now();
      requestAnimationFrame((now) => this.advance(now));
    }
    this.label();
  }

  advance(now) {
    if (!this.plays) return;
    this.step(Math.max(0, now - this.last) / 1000);
    this.last = now;
    requestAnimationFrame((next) => this.advance(next));
  }
}
