// Maps: one WebGL renderer draws every panel in turn, each is copied into a canvas of its own. One camera for all, so
// they are linked. Nothing is drawn unless something has changed.
"use strict";

const Colours = (() => {
  // red, green, blue, and 255 where lines on the colour are white
  function table(map) {
    const out = new Uint8Array(256 * 4), text = Report.colours[map];
    for (let i = 0; i < 256; ++i) {
      for (let k = 0; k < 3; ++k) out[4 * i + k] = parseInt(text.substr(6 * i + 2 * k, 2), 16);
      out[4 * i + 3] = Report.lines[map][i] === "w" ? 255 : 0;
    }
    return out;
  }
  const tables = { sequential: table("sequential"), diverging: table("diverging") };
  function entry(map, fraction) {
    const i = 4 * Math.round(255 * Math.min(1, Math.max(0, fraction)));
    return tables[map].subarray(i, i + 4);
  }
  const line = (map, fraction) => (entry(map, fraction)[3] ? "rgba(255,255,255,0.75)" : "rgba(0,0,0,0.75)");
  const css = (map, fraction) => `rgb(${entry(map, fraction).subarray(0, 3).join()})`;
  const ink = {
    light: { paper: "#ffffff", panel: "#f6f6f4", ink: "#1d1f21", soft: "#5c6166", line: "#d9dadb", none: "#d8d2c6", gone: "#f0efec",
      veil: [0.36, 0.34, 0.30], rim: "#4a4a48", series: ["#0072b2", "#d55e00", "#009e73", "#a0549a", "#56b4e9", "#b8860b", "#6b4e2e"], reference: "#2b2b2b" },
    dark: { paper: "#16181a", panel: "#1e2123", ink: "#e6e6e3", soft: "#a3a8ac", line: "#3a3f43", none: "#8d887e", gone: "#33373a",
      veil: [0.80, 0.78, 0.72], rim: "#c9c7c2", series: ["#56b4e9", "#f0883e", "#2fc69a", "#d990cf", "#8ed0f5", "#e6c14a", "#c4a484"], reference: "#f0efea" }
  };
  return { tables, css, line, ink };
})();

function rgb(text) {
  return [1, 3, 5].map((i) => parseInt(text.substr(i, 2), 16) / 255);
}

class Maps {
  constructor() {
    this.panels = [];
    this.theme = "light";
    this.geometries = new Map();
    this.options = { lines: false, contours: true, veil: true, marks: true, smooth: true };
    this.version = 0;  // of the camera
    this.orientation = new THREE.Quaternion();
    this.target = new THREE.Vector3();
    this.zoom = 1;
    this.radius = 1;
    this.drawn = 0;
    this.flat = false;     // an unrolled surface: it is shifted, never turned
    this.plain = false;    // drawn without the veil, for speed
    this.loading = false;  // the veil
    this.fault = "";
    // Of a body that is moved by hand: { key, kind: "move", "turn" or "load", at, axis (of length 1), size (load: 0 to 1),
    // text, colour (of ink.series; null: ink) }. onhandle(handle, change, ended): along the axis, or about it in radians;
    // load: the axis as it now is.
    this.handles = [];
    this.onhandle = null;
    this.grabbed = null;
    try {
      this.canvas = document.createElement("canvas");
      const context = this.canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: false });
      if (!context) throw new Error("no WebGL 2");
      this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, context, antialias: true, alpha: true });
      this.renderer.outputColorSpace = "srgb-linear";  // colours of the table go to the screen as they are
      this.renderer.setPixelRatio(1);
      this.canvas.addEventListener("webglcontextrestored", () => this.request());
    } catch (error) {
      this.fault = "This browser has no WebGL 2: the maps are left out, figures and tables are below.";
      return;
    }
    this.camera = new THREE.OrthographicCamera();
    this.textures = {};
    for (const [name, table] of Object.entries(Colours.tables)) {
      const t = new THREE.DataTexture(table, 256, 1, THREE.RGBAFormat, THREE.UnsignedByteType);
      t.minFilter = t.magFilter = THREE.LinearFilter;
      t.needsUpdate = true;
      this.textures[name] = t;
    }
    this.material = new THREE.ShaderMaterial({
      side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      uniforms: { table: { value: null }, least: { value: 0 }, most: { value: 1 }, none: { value: new THREE.Vector3() },
        gone: { value: new THREE.Vector3() }, level: { value: 0 }, zero: { value: 0 }, from: { value: 0 }, within: { value: 0 } },
      vertexShader: `
        attribute float value; attribute float shown; attribute vec2 over; attribute float line;
        varying float v; varying float s; varying vec2 o; varying float l; varying vec3 n;
        void main() {
          v = value; s = shown; o = over; l = line; n = normalMatrix * normal;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `
        uniform sampler2D table; uniform float least, most, level, zero, from, within; uniform vec3 none, gone;
        varying float v; varying float s; varying vec2 o; varying float l; varying vec3 n;
        void main() {
          float f = clamp((v - least) / (most - least), 0.0, 1.0);
          vec3 c = texture2D(table, vec2((f * 255.0 + 0.5) / 256.0, 0.5)).rgb;
          float e = max(o.x, o.y), px = fwidth(e);  // cut within the triangle
          c = mix(none, c, px > 1e-6 ? clamp(e / px + 0.5, 0.0, 1.0) : step(0.0, e));
          if (level > 0.0 && l > -1e30) {
            float q = l / level, w = max(fwidth(q), 1e-6), k = floor(q + 0.5);
            float far = smoothstep(0.45, 0.25, w);  // lines closer than a few pixels would only be a smear
            // between the ends, at 0 only if asked, and none where contact has ended
            float there = max(1.0 - within, step(0.0, e)) * step(least / level + 1e-4, k) * step(k, most / level - 1e-4) * step(from, k * level) * max(zero, step(0.5, abs(k)));
            float light = clamp((k * level - least) / (most - least), 0.0, 1.0);
            vec3 ink = vec3(step(0.5, texture2D(table, vec2((light * 255.0 + 0.5) / 256.0, 0.5)).a));
            c = mix(c, ink, 0.7 * (1.0 - smoothstep(0.2, 1.1, abs(q - k) / w)) * far * there);
          }
          if (s < -1.5) c = gone;
          float facing = abs(normalize(n).z);
          gl_FragColor = vec4(c * (0.80 + 0.20 * facing), 1.0);
        }`
    });
    this.lineMaterial = new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, premultipliedAlpha: true,
      uniforms: { colour: { value: new THREE.Vector4() } },
      vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
      fragmentShader: "uniform vec4 colour; void main() { gl_FragColor = colour; }"
    });
    this.rimMaterial = this.lineMaterial.clone();
    this.veilMaterial = new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, premultipliedAlpha: true, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
      uniforms: { colour: { value: new THREE.Vector3() } },
      vertexShader: `
        varying vec3 x;
        void main() { vec4 p = modelViewMatrix * vec4(position, 1.0); x = p.xyz; gl_Position = projectionMatrix * p; }`,
      fragmentShader: `
        uniform vec3 colour; varying vec3 x;
        void main() {
          // the faces' own normals: shells and layers share nodes, averages there mean nothing
          float edge = 1.0 - abs(normalize(cross(dFdx(x), dFdy(x))).z);
          float a = 0.006 + 0.16 * edge * edge * edge;
          gl_FragColor = vec4(colour * a, a);
        }`
    });
    this.scene = new THREE.Scene();
    this.observer = new IntersectionObserver((entries) => {
      for (const e of entries) {
        const panel = this.panels.find((p) => p.canvas === e.target);
        if (panel) panel.visible = e.isIntersecting;
      }
      this.request();
    }, { rootMargin: "200px" });
    this.sizes = new ResizeObserver(() => this.request());
  }

  setView(view) {
    const axis = new THREE.Vector3(...view.axis).normalize(), up = new THREE.Vector3(...view.up).normalize();
    const right = new THREE.Vector3().crossVectors(up, axis).normalize();
    up.crossVectors(axis, right);
    this.orientation.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, up, axis));
    this.target.set(...view.center);
    this.radius = view.radius;
    this.zoom = 1;
    this.rest = 0;  // a view that is set is no motion: drawn whole at once
    this.moved();
  }

  moved() { ++this.version; this.request(); }

  // Whether what is on the screen stays as it is: nothing waits to be drawn, loaded or drawn again whole.
  get settled() { return !this.pending && !this.plain && !this.loading; }

  // Asks for one drawing soon.
  request() {
    if (this.fault || this.pending) return;
    this.pending = requestAnimationFrame(() => { this.pending = 0; this.draw(); });
  }

  setPanels(panels) {
    if (this.fault) return;
    for (const p of this.panels) { this.observer.unobserve(p.canvas); this.sizes.unobserve(p.canvas); }
    this.panels = panels;
    for (const p of panels) {
      p.visible = true;
      this.observer.observe(p.canvas);
      this.sizes.observe(p.canvas);
      if (!p.wired) this.wire(p);
    }
    this.request();
  }

  // ---- geometry: corners of triangles, each with a value of its own ----
  geometry(m) {
    if (this.geometries.has(m)) return this.geometries.get(m);
    const around = new Float64Array(m.vertices.length), x = m.vertices;
    for (let t = 0; t < m.triangles.length; t += 3) {
      const a = 3 * m.triangles[t], b = 3 * m.triangles[t + 1], c = 3 * m.triangles[t + 2];
      const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
      const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const v of [a, b, c]) { around[v] += nx; around[v + 1] += ny; around[v + 2] += nz; }
    }
    // corners of the map's triangles; the middles of quads have the mean of their corners' normals
    const { points, triangles, middles } = m.map, normals = new Float64Array(points.length);
    normals.set(around);
    for (let i = 0; i < middles.length; ++i)
      for (let k = 0; k < 3; ++k) normals[x.length + 3 * (i >> 2) + k] += around[3 * middles[i] + k];
    const at = new Float32Array(3 * triangles.length), across = new Float32Array(at.length);
    for (let k = 0; k < triangles.length; ++k) {
      const v = 3 * triangles[k], size = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
      for (let i = 0; i < 3; ++i) { at[3 * k + i] = points[v + i]; across[3 * k + i] = normals[v + i] / size; }
    }
    // outlines of facets, and edges that only one facet has
    const edges = new Map(), lines = [], rim = [];
    for (let f = 0; f < m.facetCount; ++f) {
      const begin = m.begin[f], count = m.begin[f + 1] - begin;
      const corners = [3, 6, 7, 10].includes(count) ? 3 : 4, curved = count >= corners * 2 && count !== 10;
      for (let k = 0; k < corners; ++k) {
        const a = m.corner[begin + k], b = m.corner[begin + (k + 1) % corners];
        if (a < 0 || b < 0 || a === b) continue;
        const mid = curved ? m.corner[begin + corners + k] : -1;
        const key = a < b ? a * m.vertexCount + b : b * m.vertexCount + a;
        const path = mid >= 0 ? [a, mid, mid, b] : [a, b];
        if (!edges.has(key)) edges.set(key, [0, path]);
        edges.get(key)[0] += 1;
      }
    }
    for (const [times, path] of edges.values()) for (const v of path) {
      lines.push(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
      if (times === 1) rim.push(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
    }
    const line = (points, material) => {
      const g = new THREE.BufferGeometry();
      g.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
      const object = new THREE.LineSegments(g, material);
      object.frustumCulled = false;
      return object;
    };
    const attribute = (list) => new THREE.BufferAttribute(list, 3);
    const out = { positions: attribute(at), normals: attribute(across), lines: line(lines, this.lineMaterial), rim: line(rim, this.rimMaterial), projected: null, version: -1 };
    this.geometries.set(m, out);
    return out;
  }

  // Colours of one panel. `what`: { mesh, facets (per facet) or vertices (per vertex), may be NaN; shown(x, i): of facets,
  // and of vertices without `over`: whether it has the scale's colour, else that of "none"; over: lists per vertex, where
  // one of them is 0 or more, interpolated, the scale's colours are shown; lines: with facets, values per vertex whose
  // lines are drawn, none below `from` }, scale: { map, least, most, level }.
  paint(panel, what) {
    panel.what = what;
    if (this.fault) return;
    const m = what.mesh, smooth = !!what.vertices, triangles = m.map.triangles, n = triangles.length;
    if (!panel.object || panel.mesh !== m) {
      const geometry = new THREE.BufferGeometry(), g = this.geometry(m);
      geometry.setAttribute("position", g.positions);
      geometry.setAttribute("normal", g.normals);
      for (const [name, size] of [["over", 2], ["value", 1], ["shown", 1], ["line", 1]]) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(size * n), size));
      if (panel.object) panel.object.geometry.deleteAttribute("position"), panel.object.geometry.dispose();
      panel.object = new THREE.Mesh(geometry, this.material);
      panel.object.frustumCulled = false;
      panel.mesh = m;
    }
    const attributes = ["value", "shown", "over", "line"].map((name) => panel.object.geometry.getAttribute(name)), [values, shown, over, line] = attributes.map((a) => a.array);
    const lines = what.vertices || what.lines ? Data.pointValues(m, what.vertices || what.lines) : null;
    const source = smooth ? Data.pointValues(m, what.vertices) : what.facets;
    // a small number to either side stays one: on the graphics card they are of 4 bytes
    const size = (list) => { let s = 0; for (const x of list) if (Math.abs(x) > s && x < Infinity) s = Math.abs(x); return s || 1; };
    const edges = smooth && what.over ? what.over.map((list) => { const s = size(list); return Data.pointValues(m, list.map((x) => Math.max(-1, x / s))); }) : null;
    for (let k = 0; k < n; ++k) {
      const i = smooth ? triangles[k] : m.map.facet[(k / 3) | 0];
      const x = source ? source[i] : NaN, y = lines ? lines[triangles[k]] : NaN;
      line[k] = Number.isNaN(y) ? -1e38 : y;
      if (Number.isNaN(x)) { values[k] = 0; shown[k] = -1000; continue; }
      values[k] = x;
      shown[k] = 1;
      if (edges) { over[2 * k] = edges[0][i]; over[2 * k + 1] = edges[edges.length - 1][i]; }
      else over[2 * k] = over[2 * k + 1] = what.shown(x, i) ? 1 : -1;
    }
    for (const a of attributes) a.needsUpdate = true;
    this.request();
  }

  async setVeil(about) {
    if (this.fault || !about) return;
    this.loading = true;
    const x = await Data.array(about.vertices), t = await Data.array(about.triangles);
    this.loading = false;
    this.drawVeil(x, t, about.begin);
  }

  // `x`: three floats per point; `t`: an Int32Array, three points per triangle; `begin`: where each part's triangles begin, and the end.
  drawVeil(x, t, begin = [0, t.length / 3]) {
    if (this.fault) return;
    const points = new THREE.BufferAttribute(x, 3), triangles = new Uint32Array(t.buffer, t.byteOffset, t.length);
    this.veil = [];
    for (let i = 0; i + 1 < begin.length; ++i) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", points);
      geometry.setIndex(new THREE.BufferAttribute(triangles.subarray(3 * begin[i], 3 * begin[i + 1]), 1));
      const part = new THREE.Mesh(geometry, this.veilMaterial);
      part.frustumCulled = false;
      part.renderOrder = 3;
      part.matrixAutoUpdate = false;
      this.veil.push(part);
    }
    this.request();
  }

  // `motions`: per part of the veil quaternion and translation, or null; the last one is the surface's own, which stays where it is.
  placeVeil(motions) {
    const matrix = (m) => new THREE.Matrix4().compose(new THREE.Vector3(m[4], m[5], m[6]), new THREE.Quaternion(m[0], m[1], m[2], m[3]), new THREE.Vector3(1, 1, 1));
    const own = motions && motions[motions.length - 1], back = own ? matrix(own).invert() : null;
    this.veil.forEach((part, i) => {
      part.matrix.identity();
      if (back && motions[i]) part.matrix.multiplyMatrices(back, matrix(motions[i]));
      part.matrixWorldNeedsUpdate = true;
    });
  }

  // ---- drawing ----
  // `offset`: of the panel's surface from the one that the target is of.
  aim(width, height, offset = null, outset = 1.06) {
    const half = this.radius * outset / this.zoom, wide = Math.max(1, width / height), tall = Math.max(1, height / width);
    const c = this.camera;
    c.left = -half * wide; c.right = half * wide; c.top = half * tall; c.bottom = -half * tall;
    const reach = 40 * this.radius;
    c.near = 0; c.far = 2 * reach;
    c.position.set(0, 0, reach).applyQuaternion(this.orientation).add(this.target);
    if (offset) c.position.add(offset);
    c.quaternion.copy(this.orientation);
    c.updateProjectionMatrix();
    c.updateMatrixWorld();
    return 2 * half * wide / width;  // length per pixel
  }

  render(panel, width, height, ink) {
    if (this.canvas.width !== width || this.canvas.height !== height) this.renderer.setSize(width, height, false);
    const u = this.material.uniforms, scale = panel.what.scale;
    u.table.value = this.textures[scale.map];
    u.least.value = scale.least;
    u.most.value = scale.most;
    u.level.value = this.options.contours ? scale.level : 0;
    u.zero.value = scale.zero ? 1 : 0;
    u.from.value = panel.what.from ?? -1e30;
    u.within.value = panel.what.facets ? 0 : 1;
    u.none.value.set(...rgb(ink.none));
    u.gone.value.set(...rgb(ink.gone));
    const line = rgb(ink.rim);
    this.lineMaterial.uniforms.colour.value.set(...line.map((c) => 0.28 * c), 0.28);
    this.rimMaterial.uniforms.colour.value.set(...line.map((c) => 0.8 * c), 0.8);
    this.veilMaterial.uniforms.colour.value.set(...ink.veil);
    const g = this.geometry(panel.mesh);
    this.scene.clear();
    this.scene.add(panel.object, g.rim);
    if (this.options.lines) this.scene.add(g.lines);
    if (this.options.veil && this.veil && !this.plain) {
      this.placeVeil(panel.motions);
      this.scene.add(...this.veil);
    }
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.render(this.scene, this.camera);
  }

  // Onto any 2-D context at (x, y); `k`: pixels per CSS pixel.
  drawPanel(panel, context, x, y, width, height, k, ink) {
    const length = this.aim(width, height, panel.offset);
    context.fillStyle = ink.panel;
    context.fillRect(x, y, width, height);
    this.render(panel, width, height, ink);
    context.drawImage(this.canvas, x, y, width, height);
    context.save();
    context.translate(x, y);
    this.overlay(panel, context, width, height, k, length, ink);
    context.restore();
  }

  // Called while something moves: where drawing is slow, the veil comes back when it has come to rest.
  hurry() {
    this.rest = performance.now() + 250;
  }

  // `all`: also what is out of sight, as on paper.
  draw(all = false) {
    if (this.fault) return;
    const start = performance.now(), moving = !all && this.slow && start < (this.rest || 0);
    this.plain = moving;
    if (moving) {
      clearTimeout(this.later);
      this.later = setTimeout(() => this.request(), 300);
    }
    const ink = Colours.ink[this.theme], k = Math.min(2, window.devicePixelRatio || 1);
    for (const panel of this.panels) {
      if (!(panel.visible || all) || !panel.what) continue;
      const width = Math.round(panel.canvas.clientWidth * k), height = Math.round(panel.canvas.clientHeight * k);
      if (!(width > 0 && height > 0)) continue;
      if (panel.canvas.width !== width || panel.canvas.height !== height) {
        panel.canvas.width = width;
        panel.canvas.height = height;
      }
      this.drawPanel(panel, panel.canvas.getContext("2d"), 0, 0, width, height, k, ink);
    }
    ++this.drawn;
    if (!moving && this.veil && this.options.veil && (this.measured = (this.measured || 0) + 1) <= 4) {
      // drawing goes on after the commands are given: wait for one pixel, a few times, to know how long it takes
      const gl = this.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      if (this.measured > 1) this.slow = performance.now() - start > 120;  // the first one builds shaders
    }
  }

  toScreen(point, width, height) {
    const v = new THREE.Vector3(...point).project(this.camera);
    return [(v.x + 1) / 2 * width, (1 - v.y) / 2 * height];
  }

  overlay(panel, c, width, height, k, length, ink) {
    c.font = `${13 * k}px ${getComputedStyle(document.body).fontFamily}`;
    c.lineCap = "round";
    const halo = (draw) => {
      c.strokeStyle = ink.paper; c.lineWidth = 4 * k; draw();
      c.strokeStyle = ink.ink; c.lineWidth = 1.6 * k; draw();
    };
    if (this.options.marks) for (const mark of panel.marks || []) {
      const [px, py] = this.toScreen(mark.at, width, height), r = 6 * k;
      halo(() => {
        c.beginPath();
        if (mark.kind === "center") { c.moveTo(px - r, py); c.lineTo(px + r, py); c.moveTo(px, py - r); c.lineTo(px, py + r); }
        else c.arc(px, py, r * 0.8, 0, 2 * Math.PI);
        c.stroke();
      });
    }
    this.drawHandles(panel, c, width, height, k, length, ink);
    if (this.hover && panel.hit) {
      const [px, py] = this.toScreen(panel.hit.point, width, height), r = 9 * k;
      halo(() => {
        c.beginPath();
        for (const [a, b] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) { c.moveTo(px + a * r * 0.45, py + b * r * 0.45); c.lineTo(px + a * r * 1.3, py + b * r * 1.3); }
        c.stroke();
      });
    }
    // a ruler and where the axes point
    const step = niceStep(width * length / 3.2, 1), bar = step / length, bx = 12 * k, by = height - 12 * k;
    c.strokeStyle = ink.soft; c.lineWidth = 1.5 * k;
    c.beginPath(); c.moveTo(bx, by - 3 * k); c.lineTo(bx, by); c.lineTo(bx + bar, by); c.lineTo(bx + bar, by - 3 * k); c.stroke();
    c.fillStyle = ink.soft; c.textAlign = "left"; c.textBaseline = "bottom";
    c.fillText(Format.short(step) + (Report.units.length ? " " + Report.units.length : ""), bx + 1 * k, by - 5 * k);
    if (!this.flat) this.drawAxes(c, width, height, k, ink);
    if (panel.message) {
      c.fillStyle = ink.ink; c.textAlign = "center"; c.textBaseline = "middle";
      c.font = `${14 * k}px ${getComputedStyle(document.body).fontFamily}`;
      const w = c.measureText(panel.message).width + 20 * k;
      c.globalAlpha = 0.9; c.fillStyle = ink.paper; c.fillRect(width / 2 - w / 2, height / 2 - 14 * k, w, 28 * k);
      c.globalAlpha = 1; c.fillStyle = ink.ink; c.fillText(panel.message, width / 2, height / 2, width - 10 * k);
    }
  }

  // ---- handles ----
  // Points of a handle's line, its tip last; `length`: of the model per pixel, as handleLength has it.
  handleLine(handle, length) {
    const at = new THREE.Vector3(...handle.at), axis = new THREE.Vector3(...handle.axis);
    if (handle.kind !== "turn") return [at, at.clone().addScaledVector(axis, length * (handle.kind === "move" ? 78 : 60 + 50 * handle.size))];
    const u = new THREE.Vector3(Math.abs(axis.x) < 0.8 ? 1 : 0, Math.abs(axis.x) < 0.8 ? 0 : 1, 0).cross(axis).normalize(), v = axis.clone().cross(u);
    return Array.from({ length: 73 }, (_, i) => at.clone().addScaledVector(u, 100 * length * Math.cos(i * Math.PI / 36)).addScaledVector(v, 100 * length * Math.sin(i * Math.PI / 36)));
  }
  // Of the model per pixel of a handle: smaller in a small panel. `width`, `height`: in CSS pixels; `length`: of the model for one.
  handleLength(width, height, length) { return length * Math.min(1, Math.min(width, height) / 460); }
  // The handles that can be grabbed in a panel, with their lines in its pixels. `length` as of aim().
  placedHandles(panel, width, height, k, length) {
    if (!this.onhandle || panel.held !== "now") return [];
    // where the point that they belong to is out of sight, they stand at the margin next to it
    const size = this.handleLength(width / k, height / k, k * length), margin = Math.min(0.5, 110 * size / (k * length) / Math.min(width, height) * k);
    const kept = (x, all) => Math.min(all - margin * Math.min(width, height), Math.max(margin * Math.min(width, height), x));
    return this.handles.map((handle) => {
      const [x, y] = this.toScreen(handle.at, width, height), dx = kept(x, width) - x, dy = kept(y, height) - y;
      return { handle, line: this.handleLine(handle, size).map((p) => this.toScreen(p.toArray(), width, height)).map(([px, py]) => [px + dx, py + dy]) };
    });
  }
  drawHandles(panel, c, width, height, k, length, ink) {
    for (const { handle, line } of this.placedHandles(panel, width, height, k, length)) {
      const near = (this.grabbed || this.near) === handle.key, colour = handle.colour === null ? ink.ink : ink.series[handle.colour], tip = line[line.length - 1];
      const trace = () => { c.beginPath(); line.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y))); c.stroke(); };
      c.lineJoin = "round";
      for (const [stroke, wide] of [[ink.paper, 3], [colour, 0]]) {
        c.strokeStyle = c.fillStyle = stroke;
        c.lineWidth = ((handle.kind === "load" ? 3.4 : near ? 3 : 1.8) + wide) * k;
        trace();
        if (handle.kind === "turn") continue;
        const angle = Math.atan2(tip[1] - line[0][1], tip[0] - line[0][0]), size = (handle.kind === "load" ? 13 : 10) * k;
        c.beginPath();
        for (const turn of [0, 2.5, -2.5]) c.lineTo(tip[0] + size * Math.cos(angle + turn), tip[1] + size * Math.sin(angle + turn));
        c.closePath();
        if (wide) c.stroke(); else c.fill();
      }
      if (!handle.text) continue;
      const place = handle.kind === "turn" ? line[9] : tip, out = Math.hypot(place[0] - line[0][0], place[1] - line[0][1]) || 1;
      c.textAlign = "center"; c.textBaseline = "middle"; c.lineWidth = 3 * k;
      c.strokeStyle = ink.paper;
      const [x, y] = handle.kind === "turn" ? place : [tip[0] + 20 * k * (tip[0] - line[0][0]) / out, tip[1] + 20 * k * (tip[1] - line[0][1]) / out];
      c.strokeText(handle.text, x, y);
      c.fillText(handle.text, x, y);
    }
  }
  // The handle under a pointer, and where along its line. `reach`: in CSS pixels.
  handleAt(panel, x, y, width, height, reach) {
    const length = this.aim(width, height, panel.offset);
    let best = null;
    for (const { handle, line } of this.placedHandles(panel, width, height, 1, length)) {
      for (let i = 0; i + 1 < line.length; ++i) {
        const [ax, ay] = line[i], dx = line[i + 1][0] - ax, dy = line[i + 1][1] - ay, all = dx * dx + dy * dy || 1;
        // an arrow is grabbed by its outer part: at the foot there are others
        const t = Math.min(1, Math.max(handle.kind === "turn" ? 0 : 0.45, ((x - ax) * dx + (y - ay) * dy) / all));
        const far = Math.hypot(x - ax - t * dx, y - ay - t * dy);
        if (far <= reach && (!best || far < best.far)) best = { handle, far, along: i + t };
      }
    }
    return best;
  }
  // The pointer has dragged what it has grabbed by (dx, dy) CSS pixels.
  dragHandle(panel, grab, dx, dy, width, height) {
    const handle = this.handles.find((h) => h.key === grab.key);
    if (!handle) return;
    const length = this.aim(width, height, panel.offset), at = new THREE.Vector3(...handle.at), size = this.handleLength(width, height, length);
    const screen = (p) => this.toScreen(p.toArray(), width, height);
    if (handle.kind === "load") {
      const right = new THREE.Vector3(1, 0, 0).applyQuaternion(this.orientation), up = new THREE.Vector3(0, 1, 0).applyQuaternion(this.orientation);
      const tip = this.handleLine(handle, size)[1].addScaledVector(right, dx * length).addScaledVector(up, -dy * length).sub(at);
      if (tip.length() > 0) this.onhandle(handle, tip.normalize().toArray(), false);
      return;
    }
    // how far its line goes on the screen per unit of its motion
    let a, b, step;
    if (handle.kind === "move") {
      step = length;
      [a, b] = [at, at.clone().addScaledVector(new THREE.Vector3(...handle.axis), step)].map(screen);
    } else {
      const line = this.handleLine(handle, size), i = ((Math.round(grab.along) % 72) + 72) % 72;
      step = Math.PI / 18;
      [a, b] = [line[(i + 71) % 72], line[(i + 1) % 72]].map(screen);
    }
    const sx = (b[0] - a[0]) / step, sy = (b[1] - a[1]) / step, all = sx * sx + sy * sy, whole = handle.kind === "move" ? 1 / length : 100 * size / length;
    if (all < 0.04 * whole * whole) return;  // it points at the viewer
    const change = (dx * sx + dy * sy) / all;
    if (handle.kind === "turn") grab.along += change * 36 / Math.PI;
    this.onhandle(handle, handle.kind === "turn" ? change / 3 : change, false);  // geared: a turn is fine work
  }

  // Where the axes point.
  drawAxes(c, width, height, k, ink) {
    const ox = width - 34 * k, oy = height - 32 * k, inverse = this.orientation.clone().invert();
    const axes = [["x", 1, 0, 0], ["y", 0, 1, 0], ["z", 0, 0, 1]].map(([name, ...d]) => [name, new THREE.Vector3(...d).applyQuaternion(inverse)]);
    axes.sort((a, b) => a[1].z - b[1].z);
    c.textAlign = "center"; c.textBaseline = "middle";
    for (const [name, d] of axes) {
      const flat = Math.hypot(d.x, d.y);
      c.globalAlpha = d.z < -0.3 ? 0.5 : 1;
      c.strokeStyle = ink.soft; c.fillStyle = ink.soft; c.lineWidth = 1.4 * k;
      c.beginPath(); c.moveTo(ox, oy); c.lineTo(ox + 15 * k * d.x, oy - 15 * k * d.y); c.stroke();
      if (flat > 0.25) c.fillText(name, ox + 23 * k * d.x * (0.6 + 0.4 / flat) , oy - 23 * k * d.y * (0.6 + 0.4 / flat));
    }
    c.globalAlpha = 1;
  }

  // ---- picking: triangles under the pointer, nearest to the viewer ----
  projected(m) {
    const g = this.geometry(m);
    if (g.version === this.version && g.projected) return g.projected;
    const out = g.projected || new Float32Array(m.vertices.length), q = this.orientation.clone().invert();
    const e = new THREE.Matrix4().makeRotationFromQuaternion(q).elements, o = this.target, x = m.vertices;
    for (let i = 0; i < x.length; i += 3) {
      const a = x[i] - o.x, b = x[i + 1] - o.y, c = x[i + 2] - o.z;
      for (let k = 0; k < 3; ++k) out[i + k] = e[k] * a + e[4 + k] * b + e[8 + k] * c;
    }
    g.projected = out;
    g.version = this.version;
    return out;
  }

  // `px`, `py`: in the camera's frame, lengths from the target. { triangle, facet, weights, point } or null.
  hit(m, px, py) {
    const p = this.projected(m), t = m.triangles;
    let best = null, nearest = -Infinity;
    for (let k = 0; k < t.length; k += 3) {
      const a = 3 * t[k], b = 3 * t[k + 1], c = 3 * t[k + 2];
      const ax = p[a] - px, ay = p[a + 1] - py, bx = p[b] - px, by = p[b + 1] - py, cx = p[c] - px, cy = p[c + 1] - py;
      const wc = ax * by - ay * bx, wa = bx * cy - by * cx, wb = cx * ay - cy * ax, sum = wa + wb + wc;
      if (sum === 0 || wa * sum < 0 || wb * sum < 0 || wc * sum < 0) continue;
      const depth = (wa * p[a + 2] + wb * p[b + 2] + wc * p[c + 2]) / sum;
      if (depth <= nearest) continue;
      nearest = depth;
      best = { triangle: k / 3, facet: m.facet[k / 3], weights: [wa / sum, wb / sum, wc / sum] };
    }
    if (best === null) return null;
    const corners = [0, 1, 2].map((i) => t[3 * best.triangle + i]);
    best.point = [0, 1, 2].map((i) => corners.reduce((s, v, k) => s + best.weights[k] * m.vertices[3 * v + i], 0));
    best.vertex = corners[best.weights.indexOf(Math.max(...best.weights))];
    return best;
  }

  // The place under the pointer in every panel: they share camera and frame.
  pick(x, y, width, height) {
    const length = this.aim(width, height);
    const px = (x - width / 2) * length, py = (height / 2 - y) * length, known = new Map();
    this.hover = true;
    for (const panel of this.panels) {
      if (!panel.mesh) continue;
      const o = panel.offset ? panel.offset.clone().applyQuaternion(this.orientation.clone().invert()) : { x: 0, y: 0 };
      if (!known.has(panel.mesh)) known.set(panel.mesh, this.hit(panel.mesh, px + o.x, py + o.y));
      panel.hit = known.get(panel.mesh);
    }
    if (this.onpick) this.onpick();
    this.request();
  }

  unpick() {
    this.hover = false;
    for (const panel of this.panels) panel.hit = null;
    if (this.onpick) this.onpick();
    this.request();
  }

  // ---- mouse, touch, wheel ----
  turn(dx, dy) {
    if (this.flat) return;
    this.hurry();
    const q = new THREE.Quaternion();
    this.orientation.multiply(q.setFromAxisAngle(new THREE.Vector3(0, 1, 0), -dx));
    this.orientation.multiply(q.setFromAxisAngle(new THREE.Vector3(1, 0, 0), -dy)).normalize();
    this.moved();
  }

  shift(dx, dy) {
    this.hurry();
    this.target.add(new THREE.Vector3(-dx, dy, 0).applyQuaternion(this.orientation));
    this.moved();
  }

  enlarge(factor) {
    this.hurry();
    this.zoom = Math.min(50, Math.max(0.2, this.zoom * factor));
    this.moved();
  }

  wire(panel) {
    panel.wired = true;
    const canvas = panel.canvas, pointers = new Map();
    let spread = 0, grab = null;
    const release = () => {
      if (!grab) return;
      const handle = this.handles.find((h) => h.key === grab.key);
      grab = this.grabbed = null;
      if (handle && this.onhandle) this.onhandle(handle, null, true);
      this.request();
    };
    canvas.addEventListener("pointerdown", (e) => {
      pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
      release();
      const under = pointers.size === 1 && e.button === 0 && !e.shiftKey ? this.handleAt(panel, e.offsetX, e.offsetY, canvas.clientWidth, canvas.clientHeight, e.pointerType === "touch" ? 20 : 9) : null;
      if (under) {
        grab = { key: under.handle.key, along: under.along };
        this.grabbed = grab.key;
      }
      try { canvas.setPointerCapture(e.pointerId); } catch (error) { /* a pointer that is gone already */ }
      if (pointers.size === 2) spread = this.spread(pointers);
    });
    canvas.addEventListener("pointermove", (e) => {
      if (!pointers.has(e.pointerId)) {
        const under = this.handles.length ? this.handleAt(panel, e.offsetX, e.offsetY, canvas.clientWidth, canvas.clientHeight, 9) : null;
        this.near = under && under.handle.key;
        canvas.style.cursor = under ? "pointer" : "";
        this.pick(e.offsetX, e.offsetY, canvas.clientWidth, canvas.clientHeight);
        return;
      }
      const [x, y] = pointers.get(e.pointerId), dx = e.offsetX - x, dy = e.offsetY - y;
      pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
      if (grab && pointers.size === 1) {
        this.dragHandle(panel, grab, dx, dy, canvas.clientWidth, canvas.clientHeight);
        return;
      }
      if (pointers.size === 2) {
        const now = this.spread(pointers);
        if (spread > 0 && now > 0) this.enlarge(now / spread);
        spread = now;
      }
      if (pointers.size === 2 || e.shiftKey || e.buttons === 2 || e.buttons === 4) {
        const length = this.aim(canvas.clientWidth, canvas.clientHeight) / pointers.size;
        this.shift(dx * length, dy * length);
      } else {
        this.turn(dx * 0.008, dy * 0.008);
      }
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (e) => {
        pointers.delete(e.pointerId);
        release();
        if (e.pointerType === "touch" && pointers.size === 0) this.pick(e.offsetX, e.offsetY, canvas.clientWidth, canvas.clientHeight);
      });
    canvas.addEventListener("pointerleave", () => { if (pointers.size === 0) this.unpick(); });
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    canvas.addEventListener("dblclick", () => this.onreset && this.onreset());
    // the wheel belongs to the page until Ctrl is held or the map was clicked
    canvas.addEventListener("wheel", (e) => {
      if (!e.ctrlKey && !e.metaKey && document.activeElement !== canvas) return;
      e.preventDefault();
      this.enlarge(Math.exp(-0.0015 * e.deltaY));
    }, { passive: false });
  }

  spread(pointers) {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  }
}

// A scale: its ends, from line to line, least and largest value; null: there are none.
function scaleOfNumbers(numbers) {
  const [least, most, level, lowest, highest] = numbers || [0, 1, 0.2, 0, 0];
  return { map: "sequential", least, most, level, lowest, highest, noneText: "" };
}
// The same with whether values go on beyond its ends.
function withEnds(scale) {
  const margin = 1e-6 * (scale.most - scale.least);
  return { ...scale, beyondMost: scale.highest > scale.most + margin, beyondLeast: scale.lowest < scale.least - margin };
}

// A colour bar on a 2-D context, `width` x 76 CSS pixels at scale k.
// `contours`: whether the maps have lines of equal value.
function drawBar(c, x, y, width, k, scale, ink, contours) {
  c.save();
  c.translate(x, y);
  c.scale(k, k);
  const font = getComputedStyle(document.body).fontFamily, height = 15, top = 24;
  c.font = `14px ${font}`;
  const swatchText = scale.noneText ? c.measureText(scale.noneText).width : 0;
  const ticks = [], margin = 1e-6 * scale.level;
  for (let i = Math.ceil(scale.least / scale.level - 1e-6); i * scale.level <= scale.most + margin && ticks.length < 20; ++i) ticks.push(i * scale.level);
  const texts = ticks.map((value) => Format.short(value)), first = c.measureText(texts[0] || "").width / 2;
  const left = 2, swatch = scale.noneText ? 34 : 0, gap = scale.noneText ? Math.max(22, swatchText - swatch + 30) : 0;
  const from = left + swatch + gap + (swatch ? 0 : Math.max(14, first)), to = width - 26, span = Math.max(40, to - from);
  c.fillStyle = ink.ink; c.textAlign = "left"; c.textBaseline = "alphabetic";
  c.fillText(scale.title, from, 15, width - from);
  if (swatch) {
    c.fillStyle = ink.none;
    c.fillRect(left, top, swatch, height);
    c.fillStyle = ink.soft;
    c.fillText(scale.noneText, left, top + height + 19);
  }
  for (let i = 0; i < 256; ++i) {
    c.fillStyle = Colours.css(scale.map, i / 255);
    c.fillRect(from + i * span / 256, top, span / 256 + 0.6, height);
  }
  const place = (value) => from + span * (value - scale.least) / (scale.most - scale.least);
  if (contours) for (const value of ticks) {
    if ((Math.abs(value) < margin && !scale.zero) || value < scale.least + margin || value > scale.most - margin) continue;
    c.fillStyle = Colours.line(scale.map, (value - scale.least) / (scale.most - scale.least));
    c.fillRect(place(value) - 0.7, top, 1.4, height);
  }
  const arrow = (base, tip, fraction) => {
    c.fillStyle = Colours.css(scale.map, fraction);
    c.beginPath(); c.moveTo(base, top); c.lineTo(base, top + height); c.lineTo(tip, top + height / 2); c.fill();
  };
  if (scale.beyondMost) arrow(from + span, from + span + 12, 1);
  if (scale.beyondLeast) arrow(from, from - 12, 0);
  // every number has a tick; where there is no room for all of them, every second one is written, or fewer
  const widest = Math.max(...texts.map((t) => c.measureText(t).width)) + 10, room = span * scale.level / (scale.most - scale.least);
  const every = [1, 2, 5, 10].find((k) => k * room >= widest) || 20;
  c.strokeStyle = ink.soft; c.fillStyle = ink.soft; c.textAlign = "center"; c.lineWidth = 1;
  ticks.forEach((value, i) => {
    const px = place(value);
    c.beginPath(); c.moveTo(px, top + height); c.lineTo(px, top + height + 4); c.stroke();
    if (Math.round(value / scale.level) % every === 0) c.fillText(texts[i], px, top + height + 19);
  });
  c.restore();
}

// The same on a canvas of its own, as wide as it is on the page.
function paintBar(canvas, scale, theme, contours) {
  const k = Math.min(2, window.devicePixelRatio || 1), width = canvas.clientWidth;
  if (!width) return;
  canvas.width = Math.round(width * k);
  canvas.height = Math.round(76 * k);
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `Colours of ${scale.title}: ${Format.short(scale.least)} to ${Format.short(scale.most)}`);
  drawBar(canvas.getContext("2d"), 0, 0, width, k, scale, Colours.ink[theme], contours);
}

// Panels with their titles and numbers, and the colour bars of their scales, on a white canvas. A panel may have `maps` of its own. `words`: head, lines above all
// (the first in bold); numbers(panel), a list of short texts below it; foot, what the marks are; columns, if not as many as there are panels.
// Panels of another surface begin a row.
function mapsPicture(maps, panels, scales, words = {}) {
  const k = 2.5, ink = Colours.ink.light, side = 340, gap = 14, titleHeight = 34, line = 18, small = 13, pad = 16;
  const columns = words.columns || Math.min(panels.length, 4), cells = [];
  panels.forEach((p, i) => {
    const [column, row] = i ? cells[i - 1] : [-1, 0], same = !i || p.surface === panels[i - 1].surface;
    cells.push(same && column + 1 < columns ? [column + 1, row] : [0, row + 1]);
  });
  const rows = cells[cells.length - 1][1] + 1;
  const width = Math.max(2 * pad + columns * side + (columns - 1) * gap, 420), inner = width - 2 * pad, barHeight = 76;
  const perRow = width > 1000 ? 2 : 1, barRows = Math.ceil(scales.length / perRow);
  const wrapped = (parts, room, between) => {
    const lines = [];
    for (const part of parts) {
      const longer = lines.length ? lines[lines.length - 1] + between + part : part;
      if (lines.length && Figures.textWidth(longer, small) <= room) lines[lines.length - 1] = longer;
      else lines.push(part);
    }
    return lines;
  };
  const head = (words.head || []).filter(Boolean), foot = words.foot ? wrapped(words.foot.split(" "), inner, " ") : [];
  const numbers = panels.map((p) => (words.numbers ? wrapped(words.numbers(p), side, " · ") : []));
  const top = pad + (head.length ? 26 * head.length + 8 : 0), below = line * Math.max(0, ...numbers.map((n) => n.length));
  const each = titleHeight + side + below, bars = top + rows * each + (rows - 1) * gap + 14;
  const height = bars + barRows * (barHeight + 6) + line * foot.length + pad;
  const canvas = document.createElement("canvas"), c = canvas.getContext("2d");
  canvas.width = Math.round(width * k);
  canvas.height = Math.round(height * k);
  c.fillStyle = ink.paper;
  c.fillRect(0, 0, canvas.width, canvas.height);
  const font = getComputedStyle(document.body).fontFamily;
  const text = (t, x, y, size, bold, colour) => {
    c.fillStyle = colour;
    c.font = `${bold ? "600 " : ""}${size * k}px ${font}`;
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    c.fillText(t, x * k, y * k);
  };
  head.forEach((t, i) => text(Figures.cut(t, i ? 16 : 19, inner), pad, pad + 20 + 26 * i, i ? 15 : 18, i === 0, ink.ink));
  panels.forEach((p, i) => {
    const [column, row] = cells[i], x = pad + column * (side + gap), y = top + row * (each + gap);
    text(Figures.cut(p.title(), 17, side), x, y + 20, 16, true, ink.ink);
    (p.maps || maps).plain = false;
    (p.maps || maps).drawPanel(p, c, Math.round(x * k), Math.round((y + titleHeight - 6) * k), Math.round(side * k), Math.round(side * k), k, ink);
    numbers[i].forEach((t, n) => text(t, x, y + titleHeight - 6 + side + line * (n + 1), small, false, ink.soft));
  });
  scales.forEach((scale, i) => {
    const wide = Math.min(700, (inner - (perRow - 1) * 30) / perRow);
    drawBar(c, (pad + (i % perRow) * (wide + 30)) * k, (bars + Math.floor(i / perRow) * (barHeight + 6)) * k, wide, k, scale, ink, maps.options.contours);
  });
  foot.forEach((t, i) => text(t, pad, bars + barRows * (barHeight + 6) + line * (i + 0.6), small, false, ink.soft));
  for (const p of panels) (p.maps || maps).request();
  return canvas;
}
