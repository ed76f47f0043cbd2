// Draws one frame of a mechanism: bodies with their designs, joints, ground, springs and names.

/** Converts the frames of a motion from integers to metres and radians. */
function readAnimation(data) {
  const metres = (values) => values?.map((v) => v * data.unit);
  const poses = (values) =>
    values.map((v, k) => v * (k % 3 === 2 ? data.angle_unit : data.unit));
  return {
    time: data.time,
    factor: data.factor,
    box: data.box,
    bodies: data.bodies.map((body) => ({
      ...body,
      poses: poses(body.poses),
      shape: metres(body.shape),
      anchors: metres(body.anchors),
      roots: metres(body.roots),
      points: body.points?.map(metres),
      rigid: body.rigid?.map(metres),
    })),
    marks: (data.marks ?? []).map((mark) => ({ ...mark, at: poses(mark.at) })),
    springs: (data.springs ?? []).map((spring) => ({ ...spring, ends: metres(spring.ends) })),
  };
}

/** Returns the frame whose time is nearest. */
function frameAt(times, time) {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] + times[middle + 1] < 2 * time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Returns points [x0, y0, ...] of the axes of a body in the plane. */
function placed(points, pose) {
  const [x, y, angle] = pose;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const out = [];
  for (let k = 0; k + 1 < points.length; k += 2)
    out.push(x + c * points[k] - s * points[k + 1], y + s * points[k] + c * points[k + 1]);
  return out;
}

/** Returns the undeformed points of a grid, in the axes of its root. */
function undeformedGrid(body, frame) {
  if (body.shape) return body.shape;
  const length = body.largest - body.roots[frame];
  const out = [];
  for (let i = 0; i <= body.along; ++i)
    for (let j = 0; j <= body.across; ++j)
      out.push((length * i) / body.along,
        body.across ? body.width * (j / body.across - 0.5) : 0);
  return out;
}

/** Returns the points of a grid with displacements from the rigid motion times `factor`. */
function deformedGrid(body, frame, factor) {
  const points = body.points[frame];
  if (factor === 1) return points;
  const rigid = body.rigid?.[frame] ??
    placed(undeformedGrid(body, frame), body.poses.slice(3 * frame, 3 * frame + 3));
  return points.map((p, k) => rigid[k] + factor * (p - rigid[k]));
}

/** Returns the place of material coordinates (X, Y) in a grid of points. */
function placeInGrid(body, frame, points, X, Y) {
  const root = body.roots[frame];
  const clamp = (v, most) => Math.min(Math.max(v, 0), most);
  const s = clamp(((X - root) / (body.largest - root)) * body.along, body.along);
  const t = body.across ? clamp((Y / body.width + 0.5) * body.across, body.across) : 0;
  const i = Math.min(Math.floor(s), body.along - 1);
  const j = Math.min(Math.floor(t), Math.max(body.across - 1, 0));
  const [f, g] = [s - i, t - j];
  const rows = body.across + 1;
  const at = (a, b, c) => points[2 * (a * rows + Math.min(b, body.across)) + c];
  return [0, 1].map((c) =>
    (1 - f) * ((1 - g) * at(i, j, c) + g * at(i, j + 1, c)) +
    f * ((1 - g) * at(i + 1, j, c) + g * at(i + 1, j + 1, c)));
}

/** Returns the rings of a design on a deformed grid; long sides are divided, so that they bend. */
function deformedRings(design, body, frame, points) {
  const longest = (body.largest - body.roots[frame]) / body.along;
  return design.rings.map((ring) => {
    const out = [];
    for (let k = 0; k + 1 < ring.length; k += 2) {
      const [x0, y0] = [ring[k] * design.unit, ring[k + 1] * design.unit];
      const n = (k + 2) % ring.length;
      const [x1, y1] = [ring[n] * design.unit, ring[n + 1] * design.unit];
      const parts = Math.max(1, Math.ceil(Math.hypot(x1 - x0, y1 - y0) / longest));
      for (let p = 0; p < parts; ++p) {
        const f = p / parts;
        out.push(...placeInGrid(body, frame, points, x0 + f * (x1 - x0), y0 + f * (y1 - y0)));
      }
    }
    return out;
  });
}

/** Returns the border of a grid; of a beam its axis. */
function gridBorder(body, points) {
  if (!body.across) return points;
  const rows = body.across + 1;
  const out = [];
  const add = (i, j) => out.push(points[2 * (i * rows + j)], points[2 * (i * rows + j) + 1]);
  for (let i = 0; i <= body.along; ++i) add(i, 0);
  for (let j = 1; j < rows; ++j) add(body.along, j);
  for (let i = body.along - 1; i >= 0; --i) add(i, body.across);
  return out;
}

/** Draws one motion on a PlaneCanvas. */
class MechanismDrawing {
  constructor(animation, designs) {
    this.animation = animation;
    this.designs = designs;
  }

  /** Draws a frame. `look` has the factor of displacements, colours, and whether there are names. */
  draw(context, canvas, frame, look) {
    this.context = context;
    this.canvas = canvas;
    this.written = [];
    this.size = Math.max(3, Math.min(8, 0.012 * canvas.canvas.clientWidth));
    const order = { hub: 0, grid: 1, rigid: 2, mass: 3 };
    const bodies = [...this.animation.bodies].sort((a, b) => order[a.kind] - order[b.kind]);
    for (const body of bodies) {
      if (body.kind === "grid") this.grid(body, frame, look);
      else if (!look.only_grids) this.rigid(body, frame, look);
    }
    if (look.only_grids) return;
    for (const spring of this.animation.springs) this.spring(spring, frame);
    for (const mark of this.animation.marks) this.mark(mark, frame, look);
    if (look.names) for (const body of bodies) this.nameOfBody(body, frame);
  }

  path(points, closed = true) {
    this.context.beginPath();
    this.canvas.addLine(this.context, points, closed);
  }

  grid(body, frame, look) {
    const context = this.context;
    const points = deformedGrid(body, frame, look.factor);
    const design = look.only_grids ? undefined : this.designs?.[body.name];
    const border = gridBorder(body, points);
    context.lineWidth = body.across ? 1 : Math.max(2.5, body.width * this.canvas.scale);
    context.strokeStyle = body.across ? look.line : look.color;
    context.lineCap = "butt";
    if (design && design.rings.length) {
      context.beginPath();
      for (const ring of deformedRings(design, body, frame, points))
        this.canvas.addLine(context, ring);
      context.fillStyle = look.color;
      context.fill("evenodd");
      this.path(border);
      context.lineWidth = 0.7;
      context.stroke();
      return;
    }
    this.path(border, Boolean(body.across));
    if (body.across) {
      context.fillStyle = look.color;
      context.fill();
    }
    context.stroke();
  }

  rigid(body, frame, look) {
    const context = this.context;
    const pose = body.poses.slice(3 * frame, 3 * frame + 3);
    context.fillStyle = cssColor("--rigid");
    context.strokeStyle = cssColor("--line-strong");
    context.lineWidth = 1;
    if (body.kind !== "rigid") {
      const [x, y] = this.canvas.pixel(pose[0], pose[1]);
      const r = Math.max(this.size, body.width * this.canvas.scale);
      context.beginPath();
      // The missing sector of a hub shows how it turns.
      const notch = body.kind === "hub" ? 0.5 : 0;
      const begin = Math.PI - pose[2];
      if (notch) context.moveTo(x, y);
      context.arc(x, y, r, begin + notch, begin - notch + 2 * Math.PI);
      context.closePath();
      context.fill();
      context.stroke();
      return;
    }
    if (body.shape) {
      this.path(placed(body.shape, pose));
      context.fill();
      context.stroke();
    } else if (body.anchors) {
      // A body without a size is a star of thick lines to the places where joints act.
      const ends = placed(body.anchors, pose);
      const n = ends.length / 2;
      let [cx, cy] = [0, 0];
      for (let k = 0; k < n; ++k) {
        cx += ends[2 * k] / n;
        cy += ends[2 * k + 1] / n;
      }
      context.strokeStyle = cssColor("--rigid-line");
      context.lineWidth = 1.4 * this.size;
      context.lineCap = "round";
      context.beginPath();
      for (let k = 0; k < n; ++k)
        this.canvas.addLine(context, [cx, cy, ends[2 * k], ends[2 * k + 1]], false);
      context.stroke();
    }
  }

  spring(spring, frame) {
    const context = this.context;
    const [ax, ay, bx, by] = spring.ends.slice(4 * frame, 4 * frame + 4);
    const [x0, y0] = this.canvas.pixel(ax, ay);
    const [x1, y1] = this.canvas.pixel(bx, by);
    const length = Math.hypot(x1 - x0, y1 - y0);
    context.strokeStyle = cssColor(spring.type.includes("stop") ? "--warning" : "--spring");
    context.lineWidth = 1.6;
    context.beginPath();
    if (length < 2 * this.size) {
      // A torsion spring is a spiral around its point.
      for (let k = 0; k <= 60; ++k) {
        const [angle, r] = [(k / 60) * 5 * Math.PI, (0.4 + k / 40) * this.size];
        context.lineTo(x0 + r * Math.cos(angle), y0 + r * Math.sin(angle));
      }
    } else {
      const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
      const turns = 8;
      context.moveTo(x0, y0);
      for (let k = 0; k <= 2 * turns; ++k) {
        const along = length * (0.15 + (0.7 * k) / (2 * turns));
        const across = k === 0 || k === 2 * turns ? 0 : (k % 2 ? 1 : -1) * this.size;
        context.lineTo(x0 + ux * along - uy * across, y0 + uy * along + ux * across);
      }
      context.lineTo(x1, y1);
    }
    context.stroke();
  }

  /** Draws the ground below a joint: a triangle on a hatched line. */
  ground(x, y) {
    const context = this.context;
    const s = 1.8 * this.size;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - s, y + 1.4 * s);
    context.lineTo(x + s, y + 1.4 * s);
    context.closePath();
    context.stroke();
    context.beginPath();
    context.moveTo(x - 1.5 * s, y + 1.4 * s);
    context.lineTo(x + 1.5 * s, y + 1.4 * s);
    for (let k = -2; k <= 2; ++k) {
      context.moveTo(x + 0.6 * k * s, y + 1.4 * s);
      context.lineTo(x + 0.6 * k * s - 0.45 * s, y + 1.9 * s);
    }
    context.stroke();
  }

  mark(mark, frame, look) {
    const context = this.context;
    const [px, py, angle] = mark.at.slice(3 * frame, 3 * frame + 3);
    const [x, y] = this.canvas.pixel(px, py);
    const s = this.size;
    context.strokeStyle = cssColor("--text");
    context.fillStyle = cssColor("--paper");
    context.lineWidth = 1.2;
    if (mark.type === "observe") {
      context.beginPath();
      context.moveTo(x - s, y);
      context.lineTo(x + s, y);
      context.moveTo(x, y - s);
      context.lineTo(x, y + s);
      context.strokeStyle = cssColor("--accent");
      context.stroke();
    } else if (mark.driven) {
      if (mark.ground && !mark.type.startsWith("angle")) this.ground(x, y);
      // A drive is a circular arrow.
      context.strokeStyle = cssColor("--accent");
      context.beginPath();
      context.arc(x, y, 2.4 * s, -2.4, 0.9);
      const [ex, ey] = [x + 2.4 * s * Math.cos(0.9), y + 2.4 * s * Math.sin(0.9)];
      context.moveTo(ex + 0.9 * s, ey - 0.6 * s);
      context.lineTo(ex, ey);
      context.lineTo(ex - 0.2 * s, ey - 1.1 * s);
      context.stroke();
    } else if (["slider", "sleeve", "cylindrical", "path"].includes(mark.type)) {
      if (mark.ground) this.ground(x, y);
      context.save();
      context.translate(x, y);
      context.rotate(-angle);
      context.fillRect(-1.6 * s, -0.9 * s, 3.2 * s, 1.8 * s);
      context.strokeRect(-1.6 * s, -0.9 * s, 3.2 * s, 1.8 * s);
      context.restore();
    } else {
      if (mark.ground) this.ground(x, y);
      context.beginPath();
      if (mark.type === "weld") context.rect(x - 0.7 * s, y - 0.7 * s, 1.4 * s, 1.4 * s);
      else context.arc(x, y, 0.8 * s, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
    }
    if (look.names && mark.name) this.write(mark.name, x + 1.4 * s, y - 1.4 * s, "--faint");
  }

  nameOfBody(body, frame) {
    let [x, y] = [0, 0];
    if (body.kind === "grid") {
      const points = body.points[frame];
      const middle = 2 * (Math.floor(body.along / 2) * (body.across + 1));
      [x, y] = this.canvas.pixel(points[middle], points[middle + 1]);
    } else {
      const pose = body.poses.slice(3 * frame, 3 * frame + 3);
      const ends = placed(body.shape ?? body.anchors ?? [0, 0], pose);
      const mean = (c) => ends.filter((v, k) => k % 2 === c).reduce((a, b) => a + b) /
        (ends.length / 2);
      [x, y] = this.canvas.pixel(mean(0), mean(1));
    }
    this.write(body.name, x + 1.5 * this.size, y + 2 * this.size, "--text");
  }

  write(text, x, y, color) {
    const context = this.context;
    context.font = "12px system-ui, sans-serif";
    // A name that would cover another one moves down.
    const width = context.measureText(text).width;
    const covers = ([a, b, w]) => Math.abs(y - b) < 13 && x < a + w && a < x + width;
    while (this.written.some(covers)) y += 13;
    this.written.push([x, y, width]);
    context.lineWidth = 3;
    context.strokeStyle = cssColor("--paper");
    context.strokeText(text, x, y);
    context.fillStyle = cssColor(color);
    context.fillText(text, x, y);
  }
}
