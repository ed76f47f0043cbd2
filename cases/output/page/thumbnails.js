// Small pictures of the deformed design under a load, drawn when the reader asks for them.

/** Returns 1, 2 or 5 times a power of ten, at most `most`. */
function roundFactor(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2].map((step) => step * power).find((factor) => factor <= most) ?? power;
}

/** Returns the largest distance between points [x0, y0, ...] of two lists. */
function largestDistance(a, b) {
  let largest = 0;
  for (let k = 0; k + 1 < a.length; k += 2)
    largest = Math.max(largest, Math.hypot(a[k] - b[k], a[k + 1] - b[k + 1]));
  return largest;
}

/** Returns points in the axes of a body whose pose in the plane is [x, y, angle]. */
function inBodyAxes(points, [x, y, angle]) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const out = [];
  for (let k = 0; k + 1 < points.length; k += 2)
    out.push(c * (points[k] - x) + s * (points[k + 1] - y),
      c * (points[k + 1] - y) - s * (points[k] - x));
  return out;
}

/** Returns the rings of a moving design at the time of a load, in the axes of the body. */
function deformedInMotion(body, time, design, size) {
  const { motion } = page.motionView;
  const grid = motion.bodies.find((b) => b.name === body && b.kind === "grid");
  const frame = frameAt(motion.time, time);
  const largest = largestDistance(grid.points[frame], deformedGrid(grid, frame, 0));
  const factor = roundFactor(largest > 0 ? size / (8 * largest) : 1);
  const pose = grid.poses.slice(3 * frame, 3 * frame + 3);
  const rings = deformedRings(design, grid, frame, deformedGrid(grid, frame, factor));
  const shift = grid.roots[frame];
  return { factor, rings: rings.map((ring) =>
    inBodyAxes(ring, pose).map((v, k) => (k % 2 === 0 ? v + shift : v))) };
}

/** Returns the index of the interval of increasing numbers that contains a value, and its share. */
function intervalOf(lines, value) {
  let k = 0;
  while (k + 2 < lines.length && lines[k + 1] < value) ++k;
  return [k, Math.min(Math.max((value - lines[k]) / (lines[k + 1] - lines[k]), 0), 1)];
}

/** Returns the rings of a plate at rest under one of its loads. */
function deformedAtRest(load, design, size) {
  const { x, y, loads } = page.data.static_loads;
  const found = loads[load];
  const u = found.displacement;
  const at = (i, j, c) => u[2 * (i * y.length + j) + c] * found.unit;
  const largest = largestDistance(u.map((v) => v * found.unit), u.map(() => 0));
  const factor = roundFactor(largest > 0 ? size / (8 * largest) : 1);
  const moved = (ring) => {
    const out = [];
    for (let k = 0; k + 1 < ring.length; k += 2) {
      const point = [ring[k] * design.unit, ring[k + 1] * design.unit];
      const [i, f] = intervalOf(x, point[0]);
      const [j, g] = intervalOf(y, point[1]);
      out.push(...point.map((p, c) => p + factor * (
        (1 - f) * ((1 - g) * at(i, j, c) + g * at(i, j + 1, c)) +
        f * ((1 - g) * at(i + 1, j, c) + g * at(i + 1, j + 1, c)))));
    }
    return out;
  };
  return { factor, rings: design.rings.map(moved) };
}

/** Tells whether the page knows the deformed design under a load. */
function knowsDeformed(body, load) {
  if (!page.data.designs?.[body]) return false;
  return Boolean(page.data.static_loads?.loads?.[load] ||
    page.motionView?.motion.bodies.some((b) => b.name === body && b.kind === "grid" && !b.rigid));
}

/** Returns { factor, rings } of the deformed design under a load. */
function deformedUnderLoad(body, load, time) {
  const design = page.data.designs[body];
  const [x0, y0, x1, y1] = design.box;
  const size = Math.max(x1 - x0, y1 - y0);
  return page.data.static_loads ? deformedAtRest(load, design, size)
    : deformedInMotion(body, time, design, size);
}

/** Draws the undeformed design as lines and the deformed one above it. */
function showThumbnail(button) {
  const { deformed: body, load, at } = button.dataset;
  const design = page.data.designs[body];
  const found = deformedUnderLoad(body, Number(load), Number(at));
  const place = element("div", { class: "deformed" });
  button.replaceWith(place);
  const plain = design.rings.map((ring) => ring.map((v) => v * design.unit));
  const canvas = new PlaneCanvas(place, design.box, (context, plane) => {
    context.fillStyle = cssColor("--material");
    context.beginPath();
    for (const ring of found.rings) plane.addLine(context, ring);
    context.fill("evenodd");
    context.strokeStyle = cssColor("--line-strong");
    context.lineWidth = 0.7;
    context.beginPath();
    for (const ring of plain) plane.addLine(context, ring);
    context.stroke();
  }, 0.14);
  canvas.canvas.setAttribute("aria-label", "deformed design");
  place.append(element("div", { class: "hint" }, `displacements times ${shown(found.factor)}`));
}

function startThumbnails() {
  for (const button of document.querySelectorAll("button[data-deformed]")) {
    if (knowsDeformed(button.dataset.deformed, Number(button.dataset.load)))
      button.addEventListener("click", () => showThumbnail(button));
    else button.remove();
  }
}
