// SPDX-License-Identifier: BSD-3-Clause
// Paths of runs in 3-D, by three.js. The library is decoded when a scene is first shown.
"use strict";
(function (page) {
  const CAMERAS = 40; // drawn per run, at equal steps
  const HOME = [-1, -1.4, 1.1]; // direction from the center to the eye
  const CLICK_PX = 14, TURN = 0.12, STEP_PX = 40, ZOOM = 1 / 1.2; // ZOOM: of the distance, as OrbitControls counts it
  let library = null;

  async function decode() {
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("This browser offers no WebGL: the top view is shown.");
    const bytes = Uint8Array.from(atob(document.getElementById("three").textContent), (letter) => letter.charCodeAt(0));
    const text = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
    document.head.append(page.element("script", {}, text));
    return THREE;
  }

  // Pairs of successive points without a gap between them: {xyz, indices of their ends}.
  function segments({ x, y, z }) {
    const xyz = [], ends = [];
    for (let i = 1; i < x.length; ++i) {
      if (x[i] === null || x[i - 1] === null) continue;
      xyz.push(x[i - 1], y[i - 1], z[i - 1], x[i], y[i], z[i]);
      ends.push(i - 1, i);
    }
    return { xyz, ends };
  }

  class PathScene {
    constructor(three, canvas, onTime, onEye) {
      Object.assign(this, { three, canvas, onTime, onEye });
      this.renderer = new three.WebGLRenderer({ canvas, antialias: true });
      this.camera = new three.PerspectiveCamera(50, 1, 0.01, 1e5);
      this.camera.up.set(0, 0, 1); // gravity is along -z
      this.controls = new three.OrbitControls(this.camera, canvas);
      this.controls.addEventListener("change", () => this.render());
      this.controls.addEventListener("end", () => this.tellEye());
      canvas.addEventListener("keydown", (event) => this.onKey(event));
      canvas.addEventListener("pointerdown", (event) => { this.pressed = event.button === 0 ? [event.offsetX, event.offsetY] : null; });
      canvas.addEventListener("pointerup", (event) => this.onClick(event));
    }

    // Lines of a width [px], between successive pairs of points.
    lines(xyz, { color, colors, width, dash, opacity }) {
      const { three } = this, geometry = new three.LineSegmentsGeometry().setPositions(xyz);
      if (colors) geometry.setColors(colors);
      const material = new three.LineMaterial({ color: colors ? "#ffffff" : color, vertexColors: Boolean(colors), linewidth: width,
        ...(dash && { dashed: true, dashSize: dash[0] * this.size / 400, gapSize: dash[1] * this.size / 400 }), ...(opacity && { transparent: true, opacity }) });
      const drawn = new three.LineSegments2(geometry, material);
      if (dash) drawn.computeLineDistances();
      this.content.add(drawn);
      return drawn;
    }

    // Four edges to the corners of the image, and the image; its upper side is marked. The camera looks along z, x is to the right.
    frustum({ x, y, z, q }, i, depth) {
      const { three } = this, at = new three.Vector3(x[i], y[i], z[i]);
      const turn = new three.Quaternion(q.x[i], q.y[i], q.z[i], Math.sqrt(Math.max(0, 1 - q.x[i] ** 2 - q.y[i] ** 2 - q.z[i] ** 2)));
      const corner = (u, v) => new three.Vector3(0.6 * u * depth, 0.45 * v * depth, depth).applyQuaternion(turn).add(at);
      const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)], mark = corner(0, -1.4);
      const pairs = corners.flatMap((one, k) => [at, one, one, corners[(k + 1) % 4]]).concat([corners[0], mark, mark, corners[1]]);
      return pairs.flatMap((point) => [point.x, point.y, point.z]);
    }

    // Shows paths {x, y, z: [m], or null; t; q: {x, y, z} or null; color, dash, width; error; loops; landmarks; surfaces}.
    // `shows`: names of what is drawn besides the paths.
    show(paths, shows, eye) {
      const { three } = this;
      this.dispose();
      this.paths = paths;
      this.shows = shows;
      this.measure();
      this.scene = new three.Scene();
      this.scene.background = new three.Color(page.color("background"));
      this.content = new three.Group();
      this.scene.add(this.content);
      this.addGrid();
      const largest = paths.reduce((most, path) => (path.error || []).reduce((a, b) => Math.max(a, b), most), 1e-9);
      for (const path of paths) this.addPath(path, largest);
      this.markers = paths.map((path) => this.addMarker(path));
      this.current = paths.map(() => null);
      if (eye) this.lookFrom(eye); else if (!this.isPlaced) this.home();
      this.isPlaced = true;
      return largest;
    }

    // Center, size and floor of all paths.
    measure() {
      const range = (axis) => {
        let low = Infinity, high = -Infinity;
        for (const path of this.paths) for (const value of path[axis]) if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); }
        return low <= high ? [low, high] : [0, 1];
      };
      const ranges = ["x", "y", "z"].map(range);
      this.center = ranges.map(([low, high]) => (low + high) / 2);
      this.size = Math.max(...ranges.map(([low, high]) => high - low), 0.1);
      this.floor = ranges[2][0];
    }

    // Squares of 1, 2, 5, 10 ... m below the paths.
    addGrid() {
      const power = 10 ** Math.floor(Math.log10(this.size / 4)), cell = [1, 2, 5, 10].map((step) => step * power).find((step) => step >= this.size / 4);
      const count = 2 * Math.ceil(0.75 * this.size / cell), line = page.color("line");
      const grid = new this.three.GridHelper(count * cell, count, line, line);
      grid.rotation.x = Math.PI / 2;
      grid.position.set(this.center[0], this.center[1], this.floor);
      this.content.add(grid);
      this.cell = cell;
    }

    addPath(path, largest) {
      const { xyz, ends } = segments(path), { shows } = this;
      if (!xyz.length) return;
      const byError = shows.has("error") && path.error;
      const colors = byError && ends.flatMap((i) => new this.three.Color(path.error[i] === null ? path.color : page.rampColor(path.error[i] / largest)).toArray());
      this.lines(xyz, { color: path.color, colors, width: path.width, dash: path.dash.length ? path.dash : null });
      if (path.q && shows.has("cameras")) this.addCameras(path);
      if (path.loops && shows.has("loops")) this.addLoops(path);
      if (path.landmarks && shows.has("landmarks")) this.addLandmarks(path.landmarks);
      if (path.surfaces && shows.has("surfaces")) this.addSurfaces(path.surfaces);
    }

    addCameras(path) {
      const located = path.x.map((x, i) => i).filter((i) => path.x[i] !== null && path.q.x[i] !== null), step = Math.max(1, Math.ceil(located.length / CAMERAS));
      const edges = located.filter((_, i) => i % step === 0).flatMap((i) => this.frustum(path, i, this.size / 40));
      if (edges.length) this.lines(edges, { color: path.color, width: 1, opacity: 0.45 });
    }

    // From each frame to the place that was recognized in it; refused ones are dashed.
    addLoops({ x, y, z, loops }) {
      for (const accepted of [true, false]) {
        const known = loops.filter(({ query, match, reason }) => (reason === "") === accepted && query >= 0 && match >= 0 && x[query] !== null && x[match] !== null);
        const xyz = known.flatMap(({ query, match }) => [query, match].flatMap((i) => [x[i], y[i], z[i]]));
        if (xyz.length) this.lines(xyz, { color: page.color(accepted ? "better" : "bad"), width: accepted ? 1.5 : 1, dash: accepted ? null : [3, 3], opacity: 0.7 });
      }
    }

    // Static ones in gray, dynamic ones in red.
    addLandmarks({ x, y, z, static: statics }) {
      const xyz = x.flatMap((_, i) => [x[i], y[i], z[i]]);
      this.addPoints(xyz.slice(0, 3 * statics), 2.5, { color: page.color("faint") });
      this.addPoints(xyz.slice(3 * statics), 4, { color: page.color("bad") });
    }

    addSurfaces({ x, y, z, color }) {
      const channel = (value, shift) => ((value >> shift) & 31) / 31;
      const colors = color.flatMap((value) => new this.three.Color(channel(value, 10), channel(value, 5), channel(value, 0)).convertSRGBToLinear().toArray());
      this.addPoints(x.flatMap((_, i) => [x[i], y[i], z[i]]), 2, { vertexColors: true }, colors);
    }

    // Points of a size [px], in one color or, if there are `colors`, each in its own.
    addPoints(xyz, size, look, colors) {
      if (!xyz.length) return;
      const { three } = this, geometry = new three.BufferGeometry(), floats = (values) => new three.BufferAttribute(new Float32Array(values), 3);
      geometry.setAttribute("position", floats(xyz));
      if (colors) geometry.setAttribute("color", floats(colors));
      this.content.add(new three.Points(geometry, new three.PointsMaterial({ ...look, size: size * (window.devicePixelRatio || 1), sizeAttenuation: false })));
    }

    addMarker(path) {
      const marker = new this.three.Mesh(new this.three.SphereGeometry(this.size / 120, 12, 8), new this.three.MeshBasicMaterial({ color: path.color }));
      this.content.add(marker);
      return marker;
    }

    // Marks one frame of each path, by index; undefined: none.
    point(frames) {
      this.paths.forEach((path, i) => {
        const at = frames[i], marker = this.markers[i];
        marker.visible = at !== undefined && path.x[at] !== null;
        if (marker.visible) marker.position.set(path.x[at], path.y[at], path.z[at]);
        this.remove(this.current[i]);
        this.current[i] = marker.visible && path.q && path.q.x[at] !== null && this.shows.has("cameras") ? this.lines(this.frustum(path, at, this.size / 15), { color: path.color, width: 2 }) : null;
      });
      this.render();
    }

    // --- eye ---
    home() {
      const { camera, controls, center, size } = this, away = new this.three.Vector3(...HOME).setLength(1.25 * size / Math.min(1, this.aspect()));
      controls.target.set(...center);
      camera.position.copy(controls.target).add(away);
      controls.update();
    }
    lookFrom(eye) {
      this.camera.position.fromArray(eye);
      this.controls.target.fromArray(eye, 3);
      this.controls.update();
    }
    tellEye() { this.onEye([...this.camera.position.toArray(), ...this.controls.target.toArray()]); }

    onKey(event) {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const { controls } = this, turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (turns && event.shiftKey) controls.pan(-STEP_PX * turns[0], -STEP_PX * turns[1]);
      else if (turns) { controls.rotateLeft(TURN * turns[0]); controls.rotateUp(TURN * turns[1]); }
      else if (event.key === "+") controls.dollyIn(ZOOM);
      else if (event.key === "-") controls.dollyOut(ZOOM);
      else if (event.key === "0") this.home();
      else return;
      event.preventDefault();
      event.stopPropagation(); // these keys step through frames elsewhere
      controls.update();
      this.tellEye();
    }

    // A click of the main button, not the end of a movement, selects the time of the nearest pose.
    onClick(event) {
      const { pressed } = this, { clientWidth, clientHeight } = this.canvas;
      this.pressed = null;
      if (!pressed || event.button !== 0 || Math.hypot(event.offsetX - pressed[0], event.offsetY - pressed[1]) > 3) return;
      let best = null, distance = CLICK_PX;
      const point = new this.three.Vector3();
      for (const path of this.paths) path.x.forEach((x, i) => {
        if (x === null) return;
        point.set(x, path.y[i], path.z[i]).project(this.camera);
        const d = Math.hypot((point.x + 1) / 2 * clientWidth - event.offsetX, (1 - point.y) / 2 * clientHeight - event.offsetY);
        if (point.z < 1 && d < distance) { distance = d; best = path.t[i]; }
      });
      if (best !== null) this.onTime(best);
    }

    // --- drawing ---
    aspect() { return this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight); }

    render() {
      const { canvas, renderer, camera } = this;
      if (!this.scene || !canvas.clientWidth) return;
      renderer.setPixelRatio(window.devicePixelRatio || 1);
      renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
      camera.aspect = this.aspect();
      camera.updateProjectionMatrix();
      renderer.render(this.scene, camera);
    }

    remove(object) {
      if (!object) return;
      this.content.remove(object);
      object.geometry.dispose();
      object.material.dispose();
    }

    dispose() { if (this.content) for (const object of [...this.content.children]) this.remove(object); }
  }

  // A scene in a canvas. onTime(t) is called when a pose is clicked, onEye([eye, target]) when the eye has moved.
  // Rejected where the browser cannot show it.
  page.pathScene = async function (canvas, onTime, onEye) {
    library = library || decode();
    return new PathScene(await library, canvas, onTime, onEye);
  };
})(window.stillpoint);
