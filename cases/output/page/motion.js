// The view of the moving mechanism: play, pause, time, factor of the deformations, uniform material.

class MotionView {
  constructor(parent, data) {
    this.motion = readAnimation(data.motion);
    this.uniform = data.uniform ? readAnimation(data.uniform) : undefined;
    this.drawing = new MechanismDrawing(this.motion, data.designs);
    this.shadow = this.uniform && new MechanismDrawing(this.uniform, {});
    this.end = this.motion.time[this.motion.time.length - 1];
    this.addControls(parent);
    this.canvas = new PlaneCanvas(this.place, this.motion.box, (context) => this.draw(context));
    page.onTime((time, source) => this.moveTo(time, source));
    this.moveTo(0, "start");
  }

  addControls(parent) {
    this.place = element("div", { class: "canvas" });
    this.player = new Player((seconds) => this.advance(seconds));
    this.slider = element("input", { type: "range", min: 0, max: 1000, value: 0,
      "aria-label": "time", oninput: () =>
        page.setTime((this.slider.value / 1000) * this.end, "motion") });
    this.text = element("output", { class: "reading" });
    this.factor = element("input", { type: "range", min: 0, max: 100, value: 0,
      "aria-label": "factor of the deformations", oninput: () => this.change() });
    this.factorText = element("output");
    this.seconds = element("select", { "aria-label": "duration of the animation" },
      ...[2, 5, 10, 30].map((s) => element("option", { value: s, selected: s === 10 }, `${s} s`)));
    this.names = element("input", { type: "checkbox", checked: true, onchange: () => this.change() });
    this.beside = element("input", { type: "checkbox", onchange: () => this.change() });
    const controls = element("div", { class: "controls" }, this.player.button, this.slider,
      this.text);
    const more = element("div", { class: "controls" },
      element("label", {}, "deformations ", this.factor, this.factorText),
      element("label", {}, "plays in ", this.seconds),
      element("label", {}, this.names, " names"));
    if (this.uniform) more.append(element("label", {}, this.beside, " uniform material"));
    parent.append(this.place, controls, more);
  }

  get magnification() {
    return Number((10 ** (this.factor.value / 50)).toPrecision(2));
  }

  advance(seconds) {
    let time = page.time + (seconds * this.end) / Number(this.seconds.value);
    if (time > this.end) time = 0;
    page.setTime(time, "motion");
  }

  moveTo(time, source) {
    if (source !== "motion" || this.player.plays)
      this.slider.value = Math.round((1000 * time) / this.end);
    this.frame = frameAt(this.motion.time, time);
    this.change();
  }

  change() {
    const { time, factor } = this.motion;
    this.text.textContent = factor ? `load factor ${shown(factor[this.frame])}`
      : `t = ${shown(time[this.frame], "s")}`;
    const times = this.magnification;
    this.factorText.textContent = ` ${times} times` +
      (times === 1 ? "" : " (flexible bodies; rigid bodies and joints keep their places)");
    this.canvas?.redraw();
  }

  draw(context) {
    if (!this.canvas) return;
    if (this.shadow && this.beside.checked) {
      const frame = frameAt(this.uniform.time, this.motion.time[this.frame]);
      this.shadow.draw(context, this.canvas, frame, { factor: this.magnification,
        color: cssColor("--shadow"), line: cssColor("--line-strong"), only_grids: true });
    }
    this.drawing.draw(context, this.canvas, this.frame, { factor: this.magnification,
      color: cssColor("--material"), line: cssColor("--line-strong"), names: this.names.checked });
  }
}

function startMotion() {
  const place = document.getElementById("motion-view");
  if (!place || !page.data.motion) return;
  place.classList.add("replaced");
  const view = element("div", { class: "interactive" });
  place.append(view);
  page.motionView = new MotionView(view, page.data);
}
