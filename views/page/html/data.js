// What the page knows: the JSON of the report and its packed arrays, unpacked when they are first asked for.
"use strict";

const Report = JSON.parse($("report").textContent);

const Data = (() => {
  const cache = new Map();

  async function inflated(id) {
    const text = $("array" + id).textContent;
    let bytes;
    if (Uint8Array.fromBase64) {
      bytes = Uint8Array.fromBase64(text);
    } else {
      const raw = atob(text);
      bytes = new Uint8Array(raw.length);
      for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    }
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // views/page/page_parts.h: byte planes, perhaps differences.
  async function unpack(a) {
    const planes = await inflated(a.id), n = a.count, out = new (a.bytes === 2 ? Uint16Array : Int32Array)(n);
    for (let i = 0, before = 0; i < n; ++i) {
      let word = 0;
      for (let k = 0; k < a.bytes; ++k) word |= planes[k * n + i] << (8 * k);
      out[i] = a.delta ? before + word : word;
      before = out[i];
    }
    return a.real ? new Float32Array(out.buffer) : out;
  }

  function array(a) {
    if (!cache.has(a.id)) cache.set(a.id, unpack(a));
    return cache.get(a.id);
  }

  // Numbers that are packed in 16 bits; 65535: undefined.
  function restored(raw, least, most) {
    const out = new Float32Array(raw.length), step = 1 / 65534;
    for (let i = 0; i < raw.length; ++i) { const f = raw[i] * step; out[i] = raw[i] === 65535 ? NaN : least * (1 - f) + most * f; }
    return out;
  }

  // A field of one result on one surface: value(s) per facet in each state; NaN where undefined.
  class Field {
    constructor(about, values) {
      this.about = about;
      this.values = values;
      this.place = [];  // per state: its place among those that have values
      let n = 0;
      for (const range of about.ranges) this.place.push(range === null ? -1 : n++);
      this.last = [-1, null];
    }
    // Level of nodal averages where contact ends (views/map/map_geometry.h, edge_level); null: the field has none.
    edge(k) {
      const s = this.about.fixed ? 0 : k;
      return this.about.edges.length && this.place[s] >= 0 ? this.about.edges[s] ?? Infinity : null;
    }
    // Float32Array per facet, or null: this state has none.
    state(k) {
      if (k < 0) return null;
      const s = this.about.fixed ? 0 : k, place = this.place[s];
      if (place === undefined || place < 0) return null;
      const n = this.about.facets, raw = this.values.subarray(place * n, (place + 1) * n);
      if (this.about.exact) return raw;
      if (this.last[0] === s) return this.last[1];
      this.last = [s, restored(raw, ...this.about.ranges[s])];
      return this.last[1];
    }
  }

  async function field(about) {
    if (!about) return null;
    return new Field(about, await array(about.values));
  }

  const meshes = new Map();
  async function mesh(index) {
    if (!meshes.has(index)) {
      const about = Report.meshes[index], m = { index };
      for (const key of Object.keys(about)) m[key] = await array(about[key]);
      m.vertexCount = m.vertices.length / 3;
      m.facetCount = m.begin.length - 1;
      m.map = mapMesh(m);
      meshes.set(index, m);
    }
    return meshes.get(index);
  }

  // Triangles of smooth maps, the same as dea plot's: quads cut into four about their middle (make_map_mesh). Points
  // are the vertices, then the middles.
  function mapMesh(m) {
    const quads = [], of = (f) => m.corner.subarray(m.begin[f], m.begin[f + 1]), whole = new Uint8Array(m.facetCount);
    for (let f = 0; f < m.facetCount; ++f) {
      const v = of(f);
      if (v.length === 4 && Math.min(...v) >= 0 && new Set(v).size === 4) { whole[f] = 1; quads.push(f); }
    }
    const points = new Float32Array(m.vertices.length + 3 * quads.length), triangles = [], facet = [], middles = [];
    points.set(m.vertices);
    quads.forEach((f, q) => {
      const v = of(f), middle = m.vertexCount + q;
      for (let k = 0; k < 4; ++k) {
        for (let c = 0; c < 3; ++c) points[3 * middle + c] += m.vertices[3 * v[k] + c] / 4;
        triangles.push(v[k], v[(k + 1) % 4], middle);
        facet.push(f);
        middles.push(v[k]);
      }
    });
    for (let t = 0; t < m.facet.length; ++t) {
      if (whole[m.facet[t]]) continue;
      triangles.push(...m.triangles.subarray(3 * t, 3 * t + 3));
      facet.push(m.facet[t]);
    }
    return { points, triangles: Int32Array.from(triangles), facet: Int32Array.from(facet), middles: Int32Array.from(middles) };
  }
  // Fills what a mesh of triangles alone has beside its points and triangles.
  function meshOfTriangles(m) {
    m.facetCount = m.triangles.length / 3;
    m.corner = m.triangles;
    m.begin = Int32Array.from({ length: m.facetCount + 1 }, (x, i) => 3 * i);
    m.facet = Int32Array.from({ length: m.facetCount }, (x, i) => i);
    m.map = mapMesh(m);
    return m;
  }
  // Below 0 where nothing is above the level.
  const above = (list, level) => Float64Array.from(list, (x) => (Number.isNaN(x) ? -1 : x - level));
  // Values per vertex -> per point; a middle has the mean of its corners.
  function pointValues(m, values) {
    const n = m.vertexCount, c = m.map.middles, out = new Float64Array(n + c.length / 4);
    out.set(values);
    for (let q = 0; 4 * q < c.length; ++q) out[n + q] = (values[c[4 * q]] + values[c[4 * q + 1]] + values[c[4 * q + 2]] + values[c[4 * q + 3]]) / 4;
    return out;
  }

  // Everything of one surface: a mesh per result, its fields, how to carry values to the reference's nodes.
  async function surface(index) {
    const about = Report.surfaces[index];
    const out = { about, index, meshes: [], carry: [], fields: {} };
    for (const m of about.meshes) out.meshes.push(await mesh(m));
    for (const c of about.carry)
      out.carry.push(c === null ? null : { vertices: await array(c.vertices), weights: await array(c.weights) });
    for (const key of Object.keys(about.fields)) {
      out.fields[key] = [];
      for (const f of about.fields[key]) out.fields[key].push(await field(f));
    }
    return out;
  }

  // Per vertex the area-weighted average of the facets around it (src/results/comparison.h, nodal_average).
  function nodalAverage(m, values) {
    const sum = new Float64Array(m.vertexCount), area = new Float64Array(m.vertexCount);
    for (let f = 0; f < m.facetCount; ++f) {
      const x = values[f], a = m.areas[f];
      if (Number.isNaN(x)) continue;
      for (let k = m.begin[f]; k < m.begin[f + 1]; ++k) {
        const v = m.corner[k];
        let seen = v < 0;
        for (let j = m.begin[f]; j < k && !seen; ++j) seen = m.corner[j] === v;  // a collapsed quad names one twice
        if (seen) continue;
        sum[v] += a * x;
        area[v] += a;
      }
    }
    const out = new Float32Array(m.vertexCount);
    for (let v = 0; v < out.length; ++v) out[v] = area[v] > 0 ? sum[v] / area[v] : NaN;
    return out;
  }

  // Nodal values of a result at the reference's nodes; NaN where not covered.
  function carried(surface, result, nodal) {
    const c = surface.carry[result];
    if (c === null) return nodal;
    const n = c.vertices.length / 3, out = new Float32Array(n);
    for (let i = 0; i < n; ++i) {
      out[i] = c.vertices[3 * i] < 0 ? NaN : 0;
      for (let k = 3 * i; k < 3 * i + 3 && c.vertices[k] >= 0; ++k) out[i] += c.weights[k] * nodal[c.vertices[k]];
    }
    return out;
  }

  return { array, mesh, meshOfTriangles, restored, above, surface, nodalAverage, carried, pointValues };
})();

// Numbers as people write them.
const Format = {
  number(x, digits = 4) {
    if (x === null || x === undefined || Number.isNaN(x)) return "–";
    if (x === 0) return "0";
    const size = Math.abs(x);
    let text = size >= 1e6 || size < 1e-4 ? x.toExponential(digits - 1) : x.toPrecision(digits);
    if (text.includes("e+") && size < 1e6) text = String(Number(text));
    return text.replace("-", "−");
  },
  // Ends without the zeros of toPrecision.
  short(x, digits = 4) { return x === null || Number.isNaN(x) ? "–" : String(Number(Number(x).toPrecision(digits))).replace("-", "−"); },
  unit(dimension) { return dimension === "degrees" ? "°" : Report.units[dimension] || ""; },
  axis(quantity, dimension) {
    const unit = Format.unit(dimension), name = quantity.charAt(0).toUpperCase() + quantity.slice(1);
    return unit ? `${name} [${unit}]` : name;
  },
  beside(text, x, unit) { return text + (unit && x !== null && !Number.isNaN(x) ? " " + unit : ""); },
  with(x, dimension, digits) { return Format.beside(Format.number(x, digits), x, Format.unit(dimension)); },
  // Four digits without zeros at the end, as in the program's tables.
  printed(x, dimension) { return Format.beside(Format.short(x), x, Report.units[dimension]); },
  time(frame) { return frame.time === null ? "compared states" : Format.short(frame.time, 9); },
  // "time 2", "cycle 40 %": what a table of loads or motion calls its rows' times.
  at(time) {
    const [, name, unit] = /^(.*?)\s*[[(](.*)[\])]$/.exec(Report.time_name) || [null, Report.time_name, ""];
    return `${name} ${typeof time === "number" ? Format.short(time, 9) : time}${unit && " " + unit}`;
  }
};

// The least of the multiples of a power of ten that is not below `raw`, but for a part of it.
function roundStep(raw, multiples, part) {
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  return (multiples.find((m) => m * power >= raw * part) ?? multiples.at(-1)) * power;
}
const niceStep = (range, count) => roundStep(range / count, [1, 2, 2.5, 5, 10], 0.999);
// From line to line, and from number to number of a colour bar (views/map/map_scale.h).
const scaleStep = (low, high) => roundStep((high - low) / Report.steps.count, Report.steps.multiples, 1 - 1e-9);

// A name for a file that a page saves: the page's title and what it is.
function fileName(id) { return `${Report.title} ${id}`.replace(/[^\p{L}\p{N}._-]+/gu, "_").slice(0, 100); }
// `change` gets the chosen value as text; `options`: [value, text].
function makeSelect(id, label, options, value, change) {
  const s = make("select", { id, onchange: (e) => change(e.target.value) });
  for (const [v, t] of options) s.append(make("option", { value: String(v), text: t, selected: v === value }));
  return make("label", { id: id + "-label" }, label, s);
}
function makeToggle(id, text, on, change, title = null) {
  return make("button", { id, text, title, "aria-pressed": String(on), onclick: (e) => {
    const now = e.target.getAttribute("aria-pressed") !== "true";
    e.target.setAttribute("aria-pressed", String(now));
    change(now);
  } });
}
// Appended to the page.
function makeSection(id, title, ...children) {
  const s = make("section", { id }, title ? make("h2", { text: title }) : null, ...children);
  $("main").append(s);
  return s;
}
// A table as CSV; what is not there is an empty cell; a ' stands before what a spreadsheet would take for a formula.
function csvText(t) {
  const formula = /^([=@].|[+-](?![\d.,eE+%\s-]*$))/;
  const cell = (x) => { let s = x === null || x === undefined || Number.isNaN(x) ? "" : String(x); if (formula.test(s)) s = "'" + s; return /[",\n\r]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s; };
  return [t.headings, ...t.rows].map((r) => r.map(cell).join(",")).join("\n") + "\n";
}
function saveCsv(t, id) { Figures.save(new Blob([csvText(t)], { type: "text/csv" }), fileName(id) + ".csv"); }

function makeTable(t) {
  const cell = (tag, text, i) => make(tag, { text: String(text), class: t.left[i] === "l" ? "word" : null });
  return make("div", { class: "scroll" }, make("table", {}, make("thead", {}, make("tr", {}, ...t.headings.map((h, i) => cell("th", h, i)))),
    make("tbody", {}, ...t.rows.map((row) => make("tr", {}, ...row.map((x, i) => cell("td", x, i)))))));
}
function makeHead(sub) {
  $("head").append(make("div", { class: "top" }, make("div", {}, make("h1", { text: Report.title }), make("p", { class: "sub", text: sub })),
    make("div", { class: "controls" }, make("button", { id: "theme", title: "Light or dark page" }))));
}
function makeFoot(sentence, ...more) {
  $("foot").append(make("h2", { text: "How this page was made" }), make("pre", { id: "command", text: Report.command }), ...more,
    make("p", { class: "about", text: `${Report.program}. ${sentence} Nothing on this page comes from the network.` }),
    make("details", { class: "licences" }, make("summary", { text: "Licences of the libraries in this page" }), make("pre", { text: $("licences").textContent.trim() })));
}
// Light or dark as the reader's system is, until the button is pressed; light on paper. `redraw`: in another theme or
// width; `print`: draws what waits until it is in sight.
function followReader(state, redraw, print) {
  const button = $("theme"), dark = window.matchMedia("(prefers-color-scheme: dark)");
  const set = (theme) => {
    state.theme = theme;
    document.documentElement.dataset.theme = theme;
    button.textContent = theme === "dark" ? "Light" : "Dark";
    redraw();
  };
  let wide = window.innerWidth, before = "light";
  set(dark.matches ? "dark" : "light");
  button.addEventListener("click", () => set(state.theme === "dark" ? "light" : "dark"));
  dark.addEventListener("change", (e) => set(e.matches ? "dark" : "light"));
  window.addEventListener("resize", () => { if (wide !== window.innerWidth) { wide = window.innerWidth; redraw(); } });
  window.addEventListener("beforeprint", () => { before = state.theme; set("light"); print(); });
  window.addEventListener("afterprint", () => set(before));
}
function startPage(start) {
  start().catch((error) => {
    $("main").prepend(make("p", { class: "fault", text: `This page could not be drawn: ${error.message}` }));
    console.error(error);
  });
}

// Plays states by a button: `next` goes to the next one and answers how long it stays [ms], or a promise of that.
function makePlayer(id, next) {
  let timer = 0;
  return {
    get on() { return timer !== 0; },
    play(on) {
      const button = $(id);
      clearTimeout(timer);
      timer = 0;
      button.textContent = on ? "❚❚" : "▶";
      button.setAttribute("aria-label", on ? "Pause" : "Play");
      if (!on) return;
      const step = async () => {
        const mine = timer, stay = await next();
        if (timer === mine) timer = setTimeout(step, stay);  // neither paused nor begun anew meanwhile
      };
      timer = setTimeout(step, 120);
    }
  };
}
// The states: a button that plays them, a slider, where it is. `ids`: of these three.
function makeTimeBar(ids, title, states, state, play, move, id = null) {
  const [button, slider, words] = ids, hidden = states < 2;
  return make("div", { class: "time", id }, make("button", { id: button, text: "▶", title, "aria-label": "Play", hidden, onclick: play }),
    make("input", { id: slider, type: "range", min: "0", max: String(states - 1), step: "1", value: String(state), "aria-label": "State", hidden, oninput: (e) => move(Number(e.target.value)) }),
    make("output", { id: words }));
}
// A map's canvas below its name, and what is said of it.
const makeMapCanvas = (id) => make("canvas", { id, tabindex: "0", role: "img" });
const makePanel = (name, ...parts) => make("div", { class: "panel" }, make("div", { class: "name" }, ...name), ...parts);

