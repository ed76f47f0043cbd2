// The components of every design iteration, with a slider.

/** Half-thickness of a component at x of its axis, as in geometry/components/component.h. */
function halfThickness(c, x, least) {
  const [, , L, , c1, c2, c3] = c;
  const g = ((c1 + c2 - 2 * c3) / (2 * L * L)) * x * x + ((c2 - c1) / (2 * L)) * x + c3;
  const d = 0.1 * least;
  if (g < least - d) return least;
  if (g >= least + d) return g;
  const t = (g - least + d) / (2 * d);
  return least + 2 * d * (t ** 3 - 0.5 * t ** 4);
}

/** Points [x0, y0, ...] of the outline of a component, a superellipse of order 6. */
function componentOutline(c, least, segments = 40) {
  const [X, Y, L, angle] = c;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  const out = [];
  for (let k = 0; k < segments; ++k) {
    const t = (2 * Math.PI * k) / segments;
    const polar = t + 0.125 * Math.sin(4 * t);
    const [u, v] = [Math.cos(polar), Math.sin(polar)];
    const r = (u ** 6 + v ** 6) ** (-1 / 6);
    const x = L * r * u;
    const y = halfThickness(c, x, least) * r * v;
    out.push(X + cos * x - sin * y, Y + sin * x + cos * y);
  }
  return out;
}

/** Adds up the differences of the components of all iterations: lists of integers. */
function allComponents(entries) {
  const out = [];
  for (const entry of entries) {
    const values = entry.slice(1);
    const before = out[out.length - 1];
    out.push(entry[0] === 0 ? values.map((v, k) => v + before[k]) : values);
  }
  return out;
}

/** The view of the iterations of one body. */
class IterationsView {
  constructor(parent, history) {
    this.history = history;
    this.components = allComponents(history.components);
    const last = this.components.length - 1;
    const place = element("div", { class: "canvas" });
    this.text = element("output", { class: "reading" });
    const first = history.design ?? last;
    this.slider = element("input", { type: "range", min: 0, max: last, value: first,
      "aria-label": "iteration", oninput: () => this.show() });
    this.at = first;
    this.player = new Player((seconds) => this.advance(seconds));
    parent.append(place, element("div", { class: "controls" }, this.player.button, this.slider),
      this.text);
    this.canvas = new PlaneCanvas(place, history.box, (context) => this.draw(context), 0.02);
    this.show();
  }

  /** The whole history plays in ten seconds. */
  advance(seconds) {
    const last = this.components.length - 1;
    this.at += (seconds * (last + 1)) / 10;
    if (this.at > last) this.at = 0;
    this.slider.value = Math.floor(this.at);
    this.show(true);
  }

  show(playing = false) {
    if (!playing) this.at = Number(this.slider.value);
    const k = Number(this.slider.value);
    const h = this.history;
    this.text.textContent = `iteration ${k + 1} of ${this.components.length}: compliance ` +
      `${shown(h.compliance[k], "J")}, volume fraction ${shown(h.volume[k])}, KKT residual ` +
      shown(h.kkt[k]) + (k === h.design ? "; the design is this iteration" : "");
    this.canvas.redraw();
  }

  /** Fills polygons that are given as multiples of the unit. */
  fill(context, polygons, color) {
    context.fillStyle = color;
    context.beginPath();
    for (const polygon of polygons) this.canvas.addLine(context, polygon);
    context.fill("nonzero");
  }

  draw(context) {
    const canvas = this.canvas;
    if (!canvas) return;
    const { box, unit, angle_unit: turn, min_half_thickness: least, solid = [], empty = [] } =
      this.history;
    const values = this.components[Number(this.slider.value)];
    const frame = [box[0], box[1], box[2], box[1], box[2], box[3], box[0], box[3]];
    context.save();
    context.beginPath();
    canvas.addLine(context, frame);
    context.fillStyle = cssColor("--paper");
    context.fill();
    context.clip();
    const outlines = [];
    for (let k = 0; k + 6 < values.length; k += 7) {
      const c = values.slice(k, k + 7).map((v, i) => v * (i === 3 ? turn : unit));
      outlines.push(componentOutline(c, least));
    }
    // Components overlap: each is filled alone, so that their senses of rotation do not matter.
    for (const outline of outlines) this.fill(context, [outline], cssColor("--material"));
    const scaled = (polygon) => polygon.map((v) => v * unit);
    this.fill(context, empty.map(scaled), cssColor("--paper"));
    this.fill(context, solid.map(scaled), cssColor("--material"));
    context.restore();
    context.strokeStyle = cssColor("--line");
    context.beginPath();
    canvas.addLine(context, frame);
    context.stroke();
    if (values.length === 0) {
      context.fillStyle = cssColor("--text");
      context.fillText("The outline of this iteration is not stored.", canvas.left + 8, 20);
    }
  }
}

function startIterations() {
  const place = document.getElementById("iterations-view");
  if (!place) return;
  for (const history of page.data.iterations ?? []) {
    if (!history.components || history.components.length < 2) continue;
    if (page.data.iterations.length > 1) place.append(element("h3", {}, history.body));
    page.iterationsViews = [...(page.iterationsViews ?? []), new IterationsView(place, history)];
  }
}
