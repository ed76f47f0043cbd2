// Plots that the reader can zoom; the cursor of all plots over time is common. Without the library
// dygraphs the pictures stay as they are.

// Colours of Okabe and Ito, which colour-blind people can distinguish; lighter ones on dark pages.
const lightColors = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#888888"];
const darkColors = ["#56b4e9", "#ff8f4d", "#2fc79a", "#e2a0c6", "#d8b13c", "#9ad1f2", "#b0b0b0"];

function colorsOf(panel) {
  const all = matchMedia("(prefers-color-scheme: dark)").matches ? darkColors : lightColors;
  return panel.curves.map((curve, c) => all[(curve.color ?? c) % all.length]);
}

/** Merges the curves of a panel into rows [x, y of every curve], with null where a curve has no x. */
function mergedRows(curves) {
  const rows = new Map();
  curves.forEach((curve, c) => {
    curve.x.forEach((x, k) => {
      if (x === null) return;
      if (!rows.has(x)) rows.set(x, [x, ...curves.map(() => null)]);
      rows.get(x)[c + 1] = curve.y[k];
    });
  });
  return [...rows.values()].sort((a, b) => a[0] - b[0]);
}

/** Returns true if x never decreases along a curve, which dygraphs needs. */
function increases(curve) {
  return curve.x.every((x, k) => k === 0 || x >= curve.x[k - 1]);
}

function isOverTime(panel) {
  return panel.x.label.startsWith("time");
}

/** Moves the line of the common cursor, without drawing the plot again. */
function moveCursor(graph) {
  if (graph.cursor === undefined) return;
  const area = graph.getArea();
  const x = graph.toDomXCoord(graph.cursor);
  graph.line.hidden = x < area.x || x > area.x + area.w;
  graph.line.style.transform = `translate(${x}px, ${area.y}px)`;
  graph.line.style.height = `${area.h}px`;
}

function graphOptions(panel, legend) {
  const options = {
    labels: [panel.x.label, ...panel.curves.map((curve, c) => curve.name || panel.y.label + " ".repeat(c))],
    xlabel: panel.x.label,
    ylabel: panel.y.label,
    logscale: Boolean(panel.y.logarithmic),
    connectSeparatedPoints: true,
    colors: colorsOf(panel),
    strokeWidth: 1.6,
    gridLineColor: cssColor("--line"),
    axisLineColor: cssColor("--line"),
    axisLabelFontSize: 12,
    xLabelHeight: 18,
    yLabelWidth: 18,
    highlightCircleSize: 4,
    legend: "always",
    labelsDiv: legend,
    sigFigs: 5,
    yRangePad: 8,
    axes: {
      x: { axisLabelFormatter: (v) => shown(v) },
      y: { axisLabelWidth: 70, axisLabelFormatter: (v) => shown(v) },
    },
    series: {},
  };
  panel.curves.forEach((curve, c) => {
    options.series[options.labels[c + 1]] = {
      strokePattern: curve.dashed ? [6, 4] : null,
      drawPoints: Boolean(curve.markers),
      pointSize: 3,
      strokeWidth: curve.line === false ? 0 : curve.thin ? 0.8 : 1.6,
    };
  });
  if (isOverTime(panel)) {
    options.highlightCallback = (event, x) => page.setTime(x, "plot");
  }
  return options;
}

/** Replaces a picture by a plot for every panel; returns false if a panel has to stay a picture. */
function replacePicture(place, figure) {
  if (!figure.panels.every((panel) => panel.curves.every(increases))) return false;
  const all = element("div", { class: "interactive" });
  place.append(all);
  for (const panel of figure.panels) {
    if (panel.title) all.append(element("h3", {}, panel.title));
    const legend = element("div", { class: "legend" });
    const box = element("div", { class: "graph" });
    const line = element("div", { class: "cursor", hidden: true });
    all.append(legend, element("div", { class: "framed" }, box, line));
    const graph = new Dygraph(box, mergedRows(panel.curves), graphOptions(panel, legend));
    graph.panel = panel;
    graph.line = line;
    page.graphs.push(graph);
    if (isOverTime(panel)) {
      page.onTime((time) => {
        graph.cursor = time;
        moveCursor(graph);
      });
      graph.updateOptions({ drawCallback: () => moveCursor(graph) }, true);
    }
  }
  all.append(element("p", { class: "hint" },
    "Drag to zoom; a double click shows everything again."));
  return true;
}

function startPlots() {
  page.graphs = [];
  if (typeof Dygraph === "undefined") return;
  for (const place of document.querySelectorAll("figure[data-plot]")) {
    const figure = page.data.plots?.[place.dataset.plot];
    if (figure && replacePicture(place, figure)) place.classList.add("replaced");
  }
  const recolor = () => {
    for (const graph of page.graphs)
      graph.updateOptions({ colors: colorsOf(graph.panel), gridLineColor: cssColor("--line"),
        axisLineColor: cssColor("--line") });
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolor);
}
