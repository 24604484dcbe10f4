// SPDX-License-Identifier: BSD-3-Clause
// Top and side view of a trajectory, colored by its error, over the ground truth.
"use strict";
(function (page) {
  const MARGIN = 26;
  const VIEWS = [{ id: "plan", title: "Top view: x to the right, y up [m]", across: "x", up: "y" },
    { id: "side", title: "Side view: x to the right, z up [m]", across: "x", up: "z" }];
  // Monotonic in brightness, so that it can be read without color.
  const RAMP = [[98, 66, 158], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

  page.rampColor = function (fraction) {
    const place = Math.max(0, Math.min(1, fraction)) * (RAMP.length - 1);
    const low = Math.min(Math.floor(place), RAMP.length - 2);
    const mix = RAMP[low].map((value, i) => Math.round(value + (place - low) * (RAMP[low + 1][i] - value)));
    return "rgb(" + mix.join(",") + ")";
  };

  const largestOf = (errors) => errors.reduce((a, b) => Math.max(a, b), 1e-9);

  function extent(lists) {
    let low = Infinity, high = -Infinity;
    for (const list of lists) for (const value of list) if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); }
    return low <= high ? [low, high] : [0, 1];
  }

  // Equal scale on both axes.
  function projection(canvas, across, up) {
    const [lowX, highX] = extent(across), [lowY, highY] = extent(up);
    const width = canvas.clientWidth - 2 * MARGIN, height = canvas.clientHeight - 2 * MARGIN;
    const scale = Math.min(width / Math.max(highX - lowX, 1e-3), height / Math.max(highY - lowY, 1e-3));
    const x0 = canvas.clientWidth / 2 - scale * (lowX + highX) / 2, y0 = canvas.clientHeight / 2 + scale * (lowY + highY) / 2;
    return { x: (value) => x0 + scale * value, y: (value) => y0 - scale * value, scale };
  }

  function strokeLine(context, xs, ys, view) {
    context.beginPath();
    let pen = false;
    xs.forEach((x, i) => {
      if (x === null) { pen = false; return; }
      if (pen) context.lineTo(view.x(x), view.y(ys[i])); else context.moveTo(view.x(x), view.y(ys[i]));
      pen = true;
    });
    context.stroke();
  }

  function sharpContext(canvas) {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "12px system-ui, sans-serif";
    return context;
  }

  function scaleBar(context, canvas, view) {
    const length = Math.pow(10, Math.floor(Math.log10(canvas.clientWidth / 2 / view.scale)));
    const y = canvas.clientHeight - 10;
    context.strokeStyle = context.fillStyle = page.color("faint");
    context.lineWidth = 2;
    context.beginPath(); context.moveTo(12, y); context.lineTo(12 + length * view.scale, y); context.stroke();
    context.fillText(length + " m", 16 + length * view.scale, y + 3);
  }

  // Draws paths {x, y, color, dash, width, at: marked index} on one scale; a gap where a value is null.
  page.drawPaths = function (canvas, lines) {
    const context = sharpContext(canvas);
    const shown = projection(canvas, lines.map((line) => line.x), lines.map((line) => line.y));
    for (const { x, y, color, dash, width, at } of lines) {
      context.strokeStyle = context.fillStyle = color;
      context.lineWidth = width;
      context.setLineDash(dash);
      strokeLine(context, x, y, shown);
      if (at === undefined || x[at] === null) continue;
      context.beginPath(); context.arc(shown.x(x[at]), shown.y(y[at]), 4.5, 0, 7); context.fill();
    }
    context.setLineDash([]);
    scaleBar(context, canvas, shown);
  };

  class PathView {
    constructor(place, view, onFrame) {
      this.view = view;
      this.canvas = page.element("canvas", { id: "path-" + view.id, tabindex: "0", role: "img", "aria-label": view.title });
      const figure = page.element("figure");
      this.caption = page.element("figcaption");
      figure.append(this.canvas, this.caption);
      place.append(figure);
      this.canvas.addEventListener("pointermove", (event) => { const frame = this.frameAt(event); if (frame !== null) onFrame(frame); });
    }

    show(series, truth) { this.series = series; this.truth = truth; this.span = [-Infinity, Infinity]; this.frame = null; this.describe(); this.draw(); }

    // What the colors and lines mean, below the view: there it hides no part of a path.
    describe() {
      const { series, truth, view, caption } = this, error = series.columns.x && series.columns.error_m;
      caption.replaceChildren(view.title);
      if (error) {
        const ramp = page.element("span", { class: "ramp", "aria-hidden": "true" });
        ramp.style.background = `linear-gradient(to right, ${RAMP.map((color) => `rgb(${color.join()})`).join()})`;
        caption.append("; ", ramp, " error 0 to " + largestOf(error).toPrecision(3) + " m");
      }
      if (truth) caption.append("; gray: ground truth" + (series.columns.x ? ", red: tracking lost" : ""));
      if (series.loops.length) caption.append("; loops: solid accepted, dashed refused");
    }

    frameAt(event) {
      const { series, view, shown } = this;
      if (!shown || !series.columns.x) return null;
      let best = null, distance = 30;
      series.columns[view.across].forEach((x, i) => {
        if (x === null) return;
        const d = Math.hypot(shown.x(x) - event.offsetX, shown.y(series.columns[view.up][i]) - event.offsetY);
        if (d < distance) { distance = d; best = i; }
      });
      return best;
    }

    draw() {
      const { canvas, series, truth, view } = this;
      const context = sharpContext(canvas);
      const columns = series.columns;
      const across = [columns[view.across] || [], truth ? truth[view.across] : []];
      const up = [columns[view.up] || [], truth ? truth[view.up] : []];
      this.shown = projection(canvas, across, up);
      if (truth) this.drawTruth(context);
      if (columns.x) this.drawPath(context);
      if (columns.x && series.loops.length) this.drawLoops(context);
      if (this.frame !== null) this.drawFrame(context);
      scaleBar(context, canvas, this.shown);
    }

    // The ground truth is thick and red where the odometry lost its pose; before the first pose it is not lost.
    drawTruth(context) {
      const { truth, series, view, shown } = this;
      context.strokeStyle = page.color("faint");
      context.lineWidth = 1.2;
      strokeLine(context, truth[view.across], truth[view.up], shown);
      if (!series.columns.x) return;
      let frame = 0;
      const lost = truth.t.map((t) => {
        while (frame + 1 < series.frames && series.t[frame + 1] <= t) ++frame;
        return t >= series.t[0] && t <= series.t[series.frames - 1] && series.columns.x[frame] === null && page.statusAt(series, frame) !== "initializing";
      });
      context.strokeStyle = page.color("bad");
      context.lineWidth = 3;
      strokeLine(context, truth[view.across].map((x, i) => (lost[i] ? x : null)), truth[view.up], shown);
    }

    drawPath(context) {
      const { series, view, shown, span } = this;
      const xs = series.columns[view.across], ys = series.columns[view.up], error = series.columns.error_m;
      const largest = error ? largestOf(error) : 1;
      context.lineWidth = 2.4;
      for (let i = 1; i < series.frames; ++i) {
        if (xs[i] === null || xs[i - 1] === null) continue;
        const inside = series.t[i] >= span[0] && series.t[i] <= span[1];
        context.globalAlpha = inside ? 1 : 0.15;
        context.strokeStyle = error && error[i] !== null ? page.rampColor(error[i] / largest) : page.color("accent");
        context.beginPath(); context.moveTo(shown.x(xs[i - 1]), shown.y(ys[i - 1])); context.lineTo(shown.x(xs[i]), shown.y(ys[i])); context.stroke();
      }
      context.globalAlpha = 1;
    }

    // Lines from each frame to the place that was recognized in it; refused ones are dashed, and below.
    drawLoops(context) {
      const { series, view, shown } = this;
      const xs = series.columns[view.across], ys = series.columns[view.up];
      for (const accepted of [false, true]) {
        context.strokeStyle = page.color(accepted ? "better" : "bad");
        context.globalAlpha = accepted ? 0.8 : 0.35;
        context.lineWidth = accepted ? 1.2 : 1;
        context.setLineDash(accepted ? [] : [3, 3]);
        for (const { query, match, reason } of series.loops) {
          if ((reason === "") !== accepted || query < 0 || match < 0 || xs[query] === null || xs[match] === null) continue;
          context.beginPath(); context.moveTo(shown.x(xs[query]), shown.y(ys[query])); context.lineTo(shown.x(xs[match]), shown.y(ys[match])); context.stroke();
        }
      }
      context.setLineDash([]);
      context.globalAlpha = 1;
    }

    drawFrame(context) {
      const { series, truth, view, shown, frame } = this;
      const x = series.columns.x ? series.columns[view.across][frame] : null;
      const at = truth ? page.nearest(truth.t, series.t[frame]) : -1;
      const dot = (px, py, color) => { context.fillStyle = color; context.beginPath(); context.arc(shown.x(px), shown.y(py), 5, 0, 7); context.fill(); };
      if (at >= 0) dot(truth[view.across][at], truth[view.up][at], page.color("faint"));
      if (x !== null) dot(x, series.columns[view.up][frame], page.color("bad"));
    }
  }

  page.pathViews = function (place, onFrame) {
    place.replaceChildren();
    const views = VIEWS.map((view) => new PathView(place, view, onFrame));
    return {
      show(series, truth) { for (const view of views) view.show(series, truth); },
      point(frame) { for (const view of views) { view.frame = frame; view.draw(); } },
      zoom(min, max) { for (const view of views) { view.span = [min, max]; view.draw(); } },
      redraw() { for (const view of views) view.draw(); },
    };
  };
})(window.stillpoint);
