// The page of a joint that was made of surfaces: the joint, a layer at a time, its elements, what was inferred, numbers.
"use strict";

const Page = (() => {
  const layers = Report.layers, bodies = Report.bodies;
  const { framed, tick, style, withLegend } = Figures.tools;
  const state = { layer: Math.max(0, layers.findIndex((l) => !l.bare)), shown: bodies.map(() => ({ bone: true, cartilage: true })), solid: false, theme: "light" };
  const quantities = {
    thickness: { head: "Thickness", title: "cartilage thickness", dimension: "length", of: "points", most: true },
    gap: { head: "Gap", title: "gap to the other surface", dimension: "length", of: "points" },
    jacobian: { head: "Least Jacobian", title: "least Jacobian of a column's elements", dimension: "", of: "columns" },
    change: { head: "Change", title: "change of the thickness", dimension: "length", of: "points", most: true }
  };
  const figures = [];
  let whole = null, parts = null, panels = [], ticket = 0;

  // ---- small things ----
  const select = (id, label, options, value, change) => makeSelect(id, label, options, value, (v) => change(Number(v)));
  const csvButton = (t, id) => make("button", { text: "CSV", title: "Save the numbers", "data-save": "csv", onclick: () => saveCsv(t(), id) });
  function scaleOf(quantity) {
    const q = quantities[quantity], scale = withEnds(scaleOfNumbers(Report.scales[quantity]));
    return { ...scale, zero: scale.least < 0, title: Format.axis(q.title, q.dimension) + (quantity === "gap" && scale.lowest < 0 ? ", below 0: overlap" : "") };
  }
  const bar = (canvas, scale, contours) => paintBar(canvas, scale, state.theme, contours);
  const keys = "Drag turns, Shift + drag shifts, Ctrl + wheel or a pinch enlarges, a double click resets.";

  // ---- head ----
  function head() {
    const loads = bodies.filter((b) => b.loaded).map((b) => b.name).join(", ");
    makeHead(`A joint of ${bodies.length} bones, made of their surfaces by dea build: ${Report.file}. Loaded: ${loads}. Units: ${[Report.units.length, Report.units.force, Report.units.pressure].join(", ")}.`);
    if (Report.warnings.length) $("head").append(make("div", { class: "warnings", id: "warnings" }, make("ul", {}, ...Report.warnings.map((l) => make("li", { text: l })))));
  }

  // ---- the joint: bones and cartilage in one mesh ----
  async function joint() {
    whole = new Maps();
    const controls = make("div", { class: "controls" });
    bodies.forEach((b, i) => {
      const group = make("span", { class: "group", role: "group" });
      if (b.mesh !== null) group.append(makeToggle(`bone${i}`, b.name, true, (on) => { state.shown[i].bone = on; drawJoint(); }));
      if (layers.some((l) => l.body === i && !l.bare)) group.append(makeToggle(`cartilage${i}`, b.mesh !== null ? "its cartilage" : `cartilage of ${b.name}`, true, (on) => { state.shown[i].cartilage = on; drawJoint(); }));
      controls.append(group);
    });
    if (bodies.some((b) => b.mesh !== null)) controls.append(makeToggle("solid", "solid bones", false, (on) => { state.solid = on; drawJoint(); }));
    controls.append(makeToggle("joint-mesh", "mesh", false, (on) => { whole.options.lines = on; whole.request(); }),
      make("button", { id: "joint-reset", text: "reset view", onclick: () => whole.setView(Report.view) }),
      make("button", { id: "joint-png", text: "save PNG", title: "On white, with the colours", onclick: () => Figures.saveCanvas(mapsPicture(whole, whole.panels, [whole.panels[0].what.scale], { head: [Report.title] }), fileName("joint")) }));
    const canvas = make("canvas", { id: "whole", tabindex: "0", role: "img", "aria-label": "The bones and their cartilage, coloured by its thickness" });
    makeSection("joint", "The joint", controls, whole.fault ? make("p", { class: "fault", id: "nowebgl", text: whole.fault }) : null,
      make("div", { class: "panels" }, make("div", { class: "panel" }, canvas)), make("div", { class: "bars" }, make("canvas", { id: "whole-bar" })),
      make("p", { class: "keys", text: `${keys} Where the model has the bones as they were before they are moved into balance. Bones may be drawn coarser than they are.` }));
    if (whole.fault) { canvas.hidden = true; return; }
    whole.setPanels([{ canvas, marks: [], title: () => "Cartilage thickness" }]);
    whole.onreset = () => whole.setView(Report.view);
    whole.setView(Report.view);
    await drawJoint();
  }
  // Points and triangles of several meshes, one behind the other.
  function joined(list) {
    const vertices = new Float32Array(list.reduce((n, m) => n + m.vertices.length, 0)), triangles = new Int32Array(list.reduce((n, m) => n + m.triangles.length, 0));
    let v = 0, t = 0;
    for (const m of list) { vertices.set(m.vertices, v); triangles.set(m.triangles.map((i) => i + v / 3), t); v += m.vertices.length; t += m.triangles.length; }
    return { vertices, triangles };
  }
  async function boneMeshes(wanted) {
    const out = [];
    for (const [i, b] of bodies.entries()) if (b.mesh !== null && wanted(i)) out.push(await Data.mesh(b.mesh));
    return out;
  }
  const jointMeshes = new Map();
  async function jointMesh() {
    const key = JSON.stringify([state.shown, state.solid]);
    if (jointMeshes.has(key)) return jointMeshes.get(key);
    const pieces = [];
    for (const l of layers) if (!l.bare && state.shown[l.body].cartilage) pieces.push({ mesh: await Data.mesh(l.mesh), values: await Data.array(l.thickness) });
    const bones = await boneMeshes((i) => state.shown[i].bone);
    if (state.solid) for (const mesh of bones) pieces.push({ mesh, values: null });
    const m = joined(pieces.map((p) => p.mesh)), points = m.vertices.length / 3, values = new Float32Array(points), cartilage = new Uint8Array(points);
    m.vertexCount = points;
    let v = 0;
    for (const p of pieces) {
      if (p.values) { values.set(p.values, v); cartilage.fill(1, v, v + p.mesh.vertexCount); }
      v += p.mesh.vertexCount;
    }
    Data.meshOfTriangles(m);
    const made = { mesh: m, values, cartilage, veil: state.solid ? null : joined(bones) };
    jointMeshes.set(key, made);
    return made;
  }
  async function drawJoint() {
    if (whole.fault) return;
    const mine = ++ticket, made = await jointMesh();
    if (mine !== ticket) return;
    const scale = { ...scaleOf("thickness"), noneText: state.solid ? "bone" : "" };
    if (made.veil) whole.drawVeil(made.veil.vertices, made.veil.triangles);
    whole.options.veil = !state.solid;
    whole.paint(whole.panels[0], { mesh: made.mesh, facets: null, vertices: made.values, shown: (x, i) => made.cartilage[i] === 1, scale });
    bar($("whole-bar"), scale, whole.options.contours);
  }

  // ---- a layer: thickness, gap, Jacobian ----
  function layerSection() {
    parts = new Maps();
    const controls = make("div", { class: "controls" }, select("layer", "Layer", layers.map((l, i) => [i, l.name]), state.layer, (v) => { state.layer = v; setLayer(); }),
      make("span", { class: "group", role: "group" }, makeToggle("contours", "contours", true, (on) => { parts.options.contours = on; drawLayer(); }), makeToggle("lines", "mesh", false, (on) => { parts.options.lines = on; parts.request(); }),
        makeToggle("marks", "marks", true, (on) => { parts.options.marks = on; parts.request(); }), makeToggle("veil", "bones", true, (on) => { parts.options.veil = on; parts.request(); })),
      make("button", { id: "reset", text: "reset view", onclick: resetLayer }),
      make("button", { id: "save-maps", text: "save PNG", title: "All maps with their titles, numbers and colours, on white", onclick: () => Figures.saveCanvas(mapsPicture(parts, panels, panels.map((p) => p.what.scale), { head: [Report.title], numbers: (p) => p.readout.textContent.split(" · "), foot: parts.options.marks ? "Ring: the thickest place, the least gap, the least Jacobian, the largest change." : "" }), fileName(layers[state.layer].name)) }));
    makeSection("layers", "Layers", controls, make("div", { class: "panels", id: "panels" }), make("div", { class: "bars", id: "bars" }),
      make("p", { class: "keys", text: `${keys} Gap: along the normal to the articular surface that it is in contact with, as built, before any load; grey where none faces it within ${Format.with(Report.reach, "length", 3)}. Jacobian: the least at a corner of the column's ${Report.elements_through} elements; 1 is a straight prism on an equilateral triangle, 0 or less is inside out. Change, where there is any: by how much the thickness had to differ from the surfaces', so that no element is inside out. Ring: the thickest place, the least gap, the least Jacobian, the largest change.` }));
    parts.onpick = readouts;
    parts.onreset = resetLayer;
  }
  const resetLayer = () => parts.setView(layers[state.layer].view);
  async function veil() {
    const all = joined(await boneMeshes(() => true));
    parts.drawVeil(all.vertices, all.triangles);
  }
  async function setLayer() {
    if (parts.fault) return;
    const mine = ++ticket, l = layers[state.layer], mesh = await Data.mesh(l.mesh), made = [];
    for (const quantity of Object.keys(quantities)) if (l[quantity] !== null && Report.scales[quantity]) made.push({ quantity, numbers: await Data.array(l[quantity]) });
    if (mine !== ticket) return;
    panels = made.map((w, i) => ({ ...w, sheet: mesh, canvas: makeMapCanvas("map" + i), readout: make("div", { class: "readout", id: "readout" + i }), marks: [], title: () => `${quantities[w.quantity].head}, ${l.name}` }));
    $("panels").replaceChildren(...panels.map((p) => makePanel([make("h3", { text: quantities[p.quantity].head })], p.canvas, p.readout)));
    $("bars").replaceChildren(...panels.map(() => make("canvas", {})));
    parts.setPanels(panels);
    resetLayer();
    drawLayer();
  }
  // The place that a map's ring marks: the thickest point, of the others the least value.
  function extreme(p) {
    if (p.quantity === "jacobian") return layers[state.layer].jacobians.triangle - 1;
    const most = quantities[p.quantity].most ? 1 : -1;
    let best = -1;
    for (let i = 0; i < p.numbers.length; ++i) if (!Number.isNaN(p.numbers[i]) && (best < 0 || most * p.numbers[i] > most * p.numbers[best])) best = i;
    return best;
  }
  function placeOf(p, i) {
    const m = p.sheet, corners = quantities[p.quantity].of === "points" ? [i] : [...m.triangles.subarray(3 * i, 3 * i + 3)];
    return [0, 1, 2].map((c) => corners.reduce((s, v) => s + m.vertices[3 * v + c] / corners.length, 0));
  }
  function drawLayer() {
    panels.forEach((p, i) => {
      const points = quantities[p.quantity].of === "points", scale = scaleOf(p.quantity), best = extreme(p);
      p.marks = best < 0 ? [] : [{ kind: "peak", at: placeOf(p, best) }];
      p.message = best < 0 ? "faces no other surface" : "";
      parts.paint(p, { mesh: p.sheet, facets: points ? null : p.numbers, vertices: points ? p.numbers : null, shown: () => true, scale });
      p.canvas.setAttribute("aria-label", `${p.title()}: ${scale.title}`);
      bar($("bars").children[i], scale, points && parts.options.contours);
    });
    readouts();
  }
  function readouts() {
    for (const p of panels) {
      const q = quantities[p.quantity], points = q.of === "points", hit = parts.hover ? p.hit : null, i = hit ? (points ? hit.vertex : hit.facet) : extreme(p);
      if (i < 0) { p.readout.replaceChildren(); continue; }
      const what = points ? `point ${p.sheet.nodes[i]}` : `triangle ${i + 1}`, x = placeOf(p, i).map((c) => Format.short(c, 5)).join(", ");
      p.readout.replaceChildren(hit ? "" : q.most ? "most: " : "least: ", make("b", { text: Format.with(p.numbers[i], q.dimension) }), ` · ${what} at (${x})`);
    }
  }

  // ---- elements ----
  // A line per layer: the share of its elements in each bin of [0, 1].
  function jacobians(s, width, ink) {
    const of = layers.filter((l) => l.jacobians), series = of.map((l, i) => ({ name: l.name, ...style(i, 99, ink, false) })), rows = [];
    of.forEach((l, i) => {
      const all = l.jacobians.counts.reduce((a, b) => a + b, 0), n = l.jacobians.counts.length;
      l.jacobians.counts.forEach((c, k) => rows.push({ i, from: k / n, to: (k + 1) / n, y: 100 * c / all, c }));
    });
    const chart = framed(width, 290, ink, { label: "least Jacobian of an element", ticks: 6 }, { label: "share of the elements [%]" }, {
      x: { domain: [0, 1], label: null }, y: { zero: true, nice: true },
      marks: [
        Plot.rect(rows.filter((r) => r.c > 0), { x1: "from", x2: "to", y1: 0, y2: "y", fill: (r) => series[r.i].colour, fillOpacity: of.length > 1 ? 0.22 : 0.4, title: (r) => `${series[r.i].name}: ${r.c} elements from ${tick(r.from)} to ${tick(r.to)}` }),
        ...of.map((l, i) => Plot.line(rows.filter((r) => r.i === i).flatMap((r) => [[r.from, r.y], [r.to, r.y]]), { x: (d) => d[0], y: (d) => d[1], stroke: series[i].colour, strokeWidth: 1.7, strokeDasharray: series[i].dash })),
        Plot.ruleY([0], { stroke: ink.soft })
      ]
    });
    return withLegend(chart, series, ink, width);
  }
  const jacobianFigure = () => ({
    id: "jacobians", title: "Quality of the elements", wide: true, build: jacobians,
    table: () => ({ left: "lrrr", headings: ["layer", "from", "to", "elements"], rows: layers.filter((l) => l.jacobians).flatMap((l) => l.jacobians.counts.map((c, k) => [l.name, k / l.jacobians.counts.length, (k + 1) / l.jacobians.counts.length, c])) }),
    caption: () => layers.filter((l) => l.jacobians).map((l) => `${l.name}: least ${Format.short(l.jacobians.least)} in the column of triangle ${l.jacobians.triangle}, at (${l.jacobians.where.map((c) => Format.short(c, 5)).join(", ")}).`).join(" ")
  });
  function elements() {
    if (!layers.some((l) => l.jacobians)) return;
    const jacobian = jacobianFigure();
    figures.push(jacobian);
    makeSection("elements", "Elements", make("div", { class: "figures" }, Figures.element(jacobian, state)));
  }

  // What was measured of a hip: a picture, of which narrow pages show one panel below the other. Its numbers are among the tables.
  function hip() {
    const text = Report.hip_figure;
    if (!text) return;
    const save = make("span", { class: "save" }, make("button", { text: "SVG", title: "Save as SVG", "data-save": "svg", onclick: () => Figures.save(new Blob([text], { type: "image/svg+xml" }), fileName("hip") + ".svg") }));
    const picture = (svg, attributes) => make("img", { ...attributes, src: "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg) });
    const panels = Report.hip_panels.map((box) => picture(text.replace(/ width="[^"]*" height="[^"]*" viewBox="[^"]*"/, ` viewBox="${box}"`), { class: "narrow", alt: "" }));
    makeSection("hip", "Frames and angles", make("figure", { id: "figure-hip", class: "wide" }, make("div", { class: "title" }, make("h3", { text: "What was measured of the hip" }), save),
      picture(text, { id: "hip-figure", alt: "Sections through the centre of the femoral head with the centre-edge angles and the roof; the rim of the socket" }),
      ...panels, make("figcaption", { class: "caption narrow", text: Report.hip_words.join(" ") })));
  }

  // ---- what was inferred, numbers, provenance ----
  function told() {
    const list = (lines) => make("ul", { class: "told" }, ...lines.map((l) => make("li", { text: l })));
    makeSection("told", "Mended and inferred", make("p", { class: "about", text: "In the order in which it was done. An option puts something else in the place of each: dea build --help." }), list(Report.findings),
      Report.changes.length ? make("p", { class: "tabletitle", text: "Layers that are not as they were wanted" }) : null, Report.changes.length ? list(Report.changes) : null);
  }
  function numbers() {
    const s = makeSection("numbers", "Numbers", make("p", { class: "about", text: `As printed by dea build, and the options that it took. ${Report.headline}.` }));
    for (const t of Report.tables) s.append(make("p", { class: "tabletitle" }, t.title, " ", make("span", { class: "save" }, csvButton(() => t, t.title))), makeTable(t));
  }
  const foot = () => makeFoot("Maps hold the model’s numbers in single precision.");

  function redraw() {
    for (const m of [whole, parts]) { m.theme = state.theme; m.request(); }
    if (whole.panels.length && whole.panels[0].what) bar($("whole-bar"), whole.panels[0].what.scale, whole.options.contours);
    if (panels.length) drawLayer();
    Figures.drawAll(figures, state, 60);
  }

  // The page from top to bottom: a section is a function that appends itself. A new one is a line here.
  const sections = [joint, layerSection, elements, hip, told, numbers];

  async function start() {
    head();
    for (const make of sections) await make();
    foot();
    followReader(state, redraw, () => { for (const m of [whole, parts]) m.draw(true); figures.forEach((f) => Figures.draw(f, state)); });
    if (!parts.fault) await veil();
    await setLayer();
    document.documentElement.dataset.ready = "true";
  }
  startPage(start);

  return { state, get whole() { return whole; }, get parts() { return parts; }, get panels() { return panels; }, setLayer, drawJoint };
})();
