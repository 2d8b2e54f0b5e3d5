// Turning the joint: maps of stored pressures, chosen by a slider per factor and played over the cycle. Between stored
// cases only where the page says so.
"use strict";

const StudyMaps = (() => {
  const about = Report.maps;
  const view = { at: [], state: 0, show: "state", between: false, theme: "light", contact: null, sort: 0, position: 0, range: "all", smooth: true };
  let solid = null, flat = null, panels = [], ticket = 0, page = null, byLevels = null, kept = [], order = [], readout = null;

  // ---- which cases there are ----
  const keyOf = (levels) => levels.join(",");
  const contacts = () => [...new Map(about.surfaces.map((s) => [s.contact_id + " " + s.contact, s.contact])).entries()];
  const surfaceOf = (field) => about.surfaces[field.surface];
  const ofContact = (field) => surfaceOf(field).contact_id + " " + surfaceOf(field).contact === view.contact;
  const own = Report.columns.filter((c) => !c.of);  // the study's; those of a table of subjects stand behind them
  const gridded = () => Report.grid && own.length > 0;

  function index() {
    byLevels = new Map(about.fields.filter(ofContact).map((f) => [keyOf(f.levels.slice(0, own.length)), f]));
    kept = own.map((c, k) => [...new Set(about.fields.filter(ofContact).map((f) => f.levels[k]))].sort((a, b) => a - b));
    sorted();
  }
  function sorted() {
    const c = view.sort;
    order = about.fields.filter(ofContact);
    if (Report.columns.length) order.sort((a, b) => a.levels[c] - b.levels[c] || a.number - b.number);
  }
  // Stored cases beside the sliders and their weights; null: one of them is not stored.
  function corners() {
    if (!gridded()) return order.length ? [{ field: order[Math.round(view.position)], weight: 1 }] : null;
    let found = [{ levels: [], weight: 1 }];
    view.at.forEach((x, k) => {
      const low = Math.min(Math.floor(x + 1e-9), kept[k].length - 1), f = x - low < 1e-9 || low + 1 >= kept[k].length ? 0 : x - low;
      found = found.flatMap((c) => [{ levels: [...c.levels, kept[k][low]], weight: c.weight * (1 - f) }, ...(f ? [{ levels: [...c.levels, kept[k][low + 1]], weight: c.weight * f }] : [])]);
    });
    const out = found.map((c) => ({ field: byLevels.get(keyOf(c.levels)), weight: c.weight }));
    return out.every((c) => c.field) ? out : null;
  }

  // ---- values ----
  async function fieldValues(field, kind) {
    const e = field.entries.findIndex((x) => x[0] === kind);
    if (e < 0) return null;
    const n = surfaceOf(field).count, raw = (await Data.array(field.values)).subarray(e * n, (e + 1) * n);
    return { values: Data.restored(raw, field.entries[e][1], field.entries[e][2]), edge: field.entries[e][3] ?? Infinity };
  }
  // Linear between stored cases.
  async function blended(of, kind) {
    const parts = await Promise.all(of.map((c) => fieldValues(c.field, kind)));
    if (parts.some((p) => !p)) return null;
    if (parts.length === 1) return parts[0];
    const out = new Float32Array(parts[0].values.length);
    let edge = 0;
    parts.forEach((p, k) => { for (let i = 0; i < out.length; ++i) out[i] += of[k].weight * p.values[i]; edge += of[k].weight * p.edge; });
    return { values: out, edge };
  }

  // ---- what is shown ----
  const titles = {
    state: ["contact pressure", "pressure"], largest: ["largest pressure of all states", "pressure"], mean: ["mean pressure over the cycle", "pressure"],
    exposure: ["exposure", "dose"], overpressure: ["overpressure", "dose"]
  };
  const meanKinds = () => (Report.means ? [["means", "mean over cases"], ["deviations", "standard deviation over cases"], ...Report.means.groups.slice(2).map((g, i) => ["difference" + i, `mean: ${g} less ${Report.means.groups[1]}`])] : []);
  const isMean = () => /^(means|deviations|difference)/.test(view.show);
  const overCycle = () => view.stateKind === "cycle";
  function quantityTitle() {
    if (!isMean()) {
      const [title, dimension] = titles[view.show];
      const unit = dimension === "dose" ? StudyFigures.doseUnit() : Format.unit("pressure");
      return title.charAt(0).toUpperCase() + title.slice(1) + (unit ? ` [${unit}]` : "");
    }
    const of = view.show.startsWith("difference") ? meanKinds().find((k) => k[0] === view.show)[1] : `${meanKinds().find((k) => k[0] === view.show)[1]} (${Report.means.groups[view.group]})`;
    return Format.axis(`${of}${overCycle() ? ", over the cycle" : ""}`, "pressure");
  }
  function scaleOf(shown) {
    const kind = { state: "pressure", largest: "pressure" }[view.show] || view.show;
    const scale = { ...scaleOfNumbers(about.scales[kind]), noneText: "none", title: quantityTitle() };
    if (!isMean() && view.range !== "map") return scale;
    const difference = view.show.startsWith("difference");
    let high = 0;
    for (const x of shown.values) if (Math.abs(x) > high) high = Math.abs(x);
    scale.most = high || 1;
    scale.least = difference ? -scale.most : 0;
    scale.level = scaleStep(scale.least, scale.most);
    return difference ? { ...scale, map: "diverging", noneText: "" } : scale;
  }
  // The grid of several meshes that a surface's means are on.
  const commonOf = (surface) => Report.means.common.find((c) => c.surfaces.includes(surface));
  async function meanField(surface) {
    const common = commonOf(surface), kinds = common ? common.kinds : Report.means.surfaces[surface], k = kinds.find((x) => x.kind === (overCycle() ? "mean" : String(view.state)));
    if (!k) return null;
    const of = view.show.startsWith("difference") ? k.differences[Number(view.show.slice(10))] : k.groups[view.group];
    if (!of) return null;
    const packed = view.show === "means" ? of.mean : view.show === "deviations" ? of.sd : of.values;
    return { values: Data.restored(await Data.array(packed.values), packed.least, packed.most), edge: view.show.startsWith("difference") ? null : 1e-12, of, count: of.count ? await Data.array(of.count) : null };
  }
  async function current() {
    const of = corners();
    if (isMean()) {
      const surface = of ? of[0].field.surface : about.fields.find(ofContact).surface, shown = await meanField(surface);
      return { surface, common: commonOf(surface), shown, of: null, message: shown ? "" : "fewer than two cases" };
    }
    if (!of) return { surface: typeof view.surface === "number" ? view.surface : about.fields.find(ofContact).surface, shown: null, of: null, message: "no stored solution here" };
    const meshes = new Set(of.map((c) => c.field.surface)), surface = of[0].field.surface;
    if (meshes.size > 1) return { surface, shown: null, of, message: "other meshes: nothing between them" };
    const shown = await blended(of, view.show === "state" ? String(view.state) : view.show);
    return { surface, shown, of, message: shown ? "" : view.show === "state" ? "no solution in this state" : "a state is missing" };
  }

  async function flatMesh(surface, mesh) {
    const s = about.surfaces[surface];
    if (!s.flat) return null;
    if (!s.flatMesh) {
      const p = await Data.array(s.flat.points), t = await Data.array(s.flat.triangles), n = p.length / 2, vertices = new Float32Array(3 * n);
      for (let i = 0; i < n; ++i) { vertices[3 * i] = p[2 * i]; vertices[3 * i + 1] = p[2 * i + 1]; }
      s.flatMesh = Data.meshOfTriangles({ ...mesh, vertices, triangles: t });
    }
    return s.flatMesh;
  }
  function setViews(surface, common, unrolled) {
    const key = common ? `common ${common.mesh}` : surface;
    if (view.surface === key) return;
    view.surface = key;
    if (!common) solid.setView(about.surfaces[surface].view);
    if (!unrolled) return;
    const [x, y] = [0, 1].map((k) => Figures.tools.extent(unrolled.vertices.filter((v, i) => i % 3 === k)));
    const center = [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2, 0], far = Math.max(x[1] - x[0], y[1] - y[0]) / 2;
    flat.setView({ axis: [0, 0, 1], up: [0, 1, 0], center, radius: far });
  }

  async function update() {
    const mine = ++ticket;
    for (const s of about.surfaces) if (!s.count) s.count = (await Data.mesh(s.mesh)).vertexCount;
    const now = await current();
    const mesh = await Data.mesh(now.common ? now.common.mesh : about.surfaces[now.surface].mesh), unrolled = now.common ? mesh : await flatMesh(now.surface, mesh);
    if (mine !== ticket) return;
    view.now = now;
    setViews(now.surface, now.common, unrolled);
    const values = now.shown ? now.shown.values : new Float32Array(mesh.vertexCount).fill(NaN), scale = scaleOf({ values });
    for (const p of panels) {
      const m = p.flat ? unrolled : now.common ? null : mesh;
      p.element.hidden = !m;
      if (!m) continue;
      p.message = now.message;
      const what = { mesh: m, facets: null, vertices: values, shown: (x) => x > 0, scale };
      if (now.shown && now.shown.edge !== null) { what.over = [Data.above(values, now.shown.edge)]; what.from = now.shown.edge; }
      else what.shown = () => true;
      p.maps.paint(p, what);
      p.canvas.setAttribute("aria-label", `${p.title()}: ${scale.title}`);
    }
    view.scale = scale;
    drawBarNow();
    words();
  }
  const drawBarNow = () => { if (view.scale) paintBar($("map-bar"), view.scale, view.theme, true); };

  // ---- words below the maps ----
  function levelText(k, x) {
    const c = Study.columns[k], low = Math.floor(x + 1e-9), f = x - low;
    if (f < 1e-9 || low + 1 >= kept[k].length) return c.levels[kept[k][Math.min(low, kept[k].length - 1)]] + c.unit;
    return Format.short(c.numbers[kept[k][low]] * (1 - f) + c.numbers[kept[k][low + 1]] * f) + c.unit;
  }
  function words() {
    const now = view.now, parts = [], place = Report.places.findIndex((p) => p.part === "" && p.contact === about.surfaces[now.surface].contact);
    gridded() && view.at.forEach((x, k) => { $("level" + k).textContent = levelText(k, x); });
    if (!gridded() && $("position")) $("level-case").textContent = order.length ? `case ${order[Math.round(view.position)].number}` : "–";
    $("map-time").textContent = overCycle() || ["largest", "mean", "exposure", "overpressure"].includes(view.show) ? "over all states" : `${Report.choices[view.state]}${Report.study.states > 1 ? ` (${view.state + 1} of ${Report.study.states})` : ""}`;
    readout.classList.toggle("between", !!(now.of && now.of.length > 1));
    if (isMean()) {
      const of = now.shown && now.shown.of;
      if (of && of.cases) parts.push(`${of.cases} cases`, `mean over the surface ${Format.printed(of.area_mean, "pressure")}`, `spread over the surface ${Format.printed(of.area_spread, "pressure")} (root mean square of the standard deviations)`);
      else if (of) parts.push(`mean difference ${Format.printed(of.area_mean, "pressure")}`, `root mean square ${Format.printed(of.area_rms, "pressure")}`);
    } else if (now.of && now.of.length > 1) {
      parts.push(`between stored cases ${now.of.map((c) => c.field.number).join(", ")}: linear between their maps, not solved`);
    } else if (now.of) {
      const f = now.of[0].field, i = page.placeOf(f.number);
      parts.push(`case ${f.number}`, ...Study.columns.map((c, k) => Study.said(c, f.levels[k])));
      if (place >= 0 && i >= 0 && ["state", "largest"].includes(view.show) && now.shown) {
        const choice = view.show === "state" ? view.state : Report.study.states;
        Report.statistics.forEach((s, k) => { if (StudyFigures.isInside(k) && k !== page.state.statistic) return; const v = Study.kept.get(k + "," + place); if (v) parts.push(`${s.quantity} ${Format.printed(v[i * Report.choices.length + choice], s.dimension)}`); });
      }
    }
    if (solid.hover || flat.hover) {
      const p = panels.find((q) => q.hit && !q.element.hidden);
      if (p && now.shown) parts.unshift(`${now.common ? "point" : "node"} ${p.what.mesh.nodes[p.hit.vertex] + 1}: ${Format.number(now.shown.values[p.hit.vertex])}${now.shown.count ? ` (${now.shown.count[p.hit.vertex]} of ${now.shown.of.cases} cases cover it)` : ""}`);
    }
    if (now.message) parts.unshift(now.message);
    readout.textContent = parts.join(" · ");
    page.mapMoved(now.of && now.of.length === 1 ? now.of[0].field.number : null);
  }

  // ---- controls ----
  function slider(id, label, most, step, value, input, out) {
    const range = make("input", { id, type: "range", min: "0", max: String(most), step: String(step), "aria-label": label, oninput: (e) => input(Number(e.target.value)) });
    range.value = String(value);
    return make("label", {}, make("span", { text: label }), range, make("output", { id: out }));
  }
  function sliders() {
    const host = $("sliders");
    host.replaceChildren();
    if (gridded()) {
      view.at = kept.map((levels, k) => Math.min(view.at[k] ?? Math.floor((levels.length - 1) / 2), levels.length - 1));
      own.forEach((c, k) => host.append(slider("factor" + k, c.name, kept[k].length - 1, view.between && c.numeric ? 0.05 : 1, view.at[k], (x) => { view.at[k] = x; update(); }, "level" + k)));
    } else if (order.length > 1) {
      host.append(slider("position", "case", order.length - 1, 1, view.position, (x) => { view.position = x; update(); }, "level-case"));
      const by = make("select", { id: "sort", onchange: (e) => { view.sort = Number(e.target.value); sorted(); update(); } });
      Report.columns.forEach((c, k) => by.append(make("option", { value: String(k), text: c.name })));
      host.append(make("label", {}, make("span", { text: "in the order of" }), by));
    }
  }
  function setState(k) {
    view.state = Math.min(Report.study.states - 1, Math.max(0, k));
    $("map-state").value = String(view.state);
    return update();
  }
  const player = makePlayer("map-play", async () => {
    solid.hurry();
    await setState((view.state + 1) % Report.study.states);
    return view.state === Report.study.states - 1 ? 900 : 280;
  });
  function play(on) {
    if (on && view.show !== "state" && !isMean()) { view.show = "state"; $("map-show").value = "state"; }
    player.play(on);
  }
  // What is shown, of which contact and group, with which scale; saving.
  function mapControls() {
    const has = (kind) => kind === "state" || about.fields.some((f) => f.entries.some((e) => e[0] === kind));
    const shown = Object.keys(titles).filter(has).map((kind) => [kind, kind === "state" ? "pressure in a state" : titles[kind][0]]);
    const groups = Report.means ? Report.means.groups.map((g, i) => [i, g]) : [];
    const controls = make("div", { class: "controls" },
      contacts().length > 1 ? makeSelect("map-contact", "Contact", contacts(), view.contact, (v) => { view.contact = v; index(); sliders(); update(); }) : null,
      makeSelect("map-show", "Show", [...shown, ...meanKinds()], view.show, (v) => { view.show = v; fitControls(); update(); }),
      makeSelect("map-group", "of", groups, view.group, (v) => { view.group = Number(v); update(); }),
      makeToggle("map-cycle", "over the cycle", false, (on) => { view.stateKind = on ? "cycle" : "state"; update(); }),
      makeSelect("map-range", "Scale", [["all", "all maps"], ["map", "this map"]], view.range, (v) => { view.range = v; update(); }));
    if (gridded() && own.some((c) => c.numeric))
      controls.append(makeToggle("between", "between stored cases", false, (on) => {
        view.between = on;
        if (!on) view.at = view.at.map((x) => Math.round(x));
        sliders();
        update();
      }, "Lets the sliders stop between stored cases: maps are then linear between them, not solved"));
    if (!solid.fault)
      controls.append(make("button", { text: "reset view", onclick: () => { view.surface = null; update(); } }),
        make("button", { id: "map-png", text: "PNG", title: "Save both maps as PNG", onclick: () => save("png") }),
        make("button", { id: "map-svg", text: "SVG", title: "Save both maps as SVG; the maps in it are pictures", onclick: () => save("svg") }));
    controls.append(make("button", { id: "map-csv", text: "CSV", title: "Save the values at the nodes", onclick: () => save("csv") }));
    return controls;
  }
  function build(host, thePage) {
    page = thePage;
    solid = new Maps();
    flat = new Maps();
    flat.flat = true;
    view.contact = contacts()[0][0];
    view.group = 0;
    view.stateKind = "state";
    host.append(mapControls());
    if (solid.fault) host.append(make("p", { class: "fault", id: "nowebgl", text: solid.fault }));
    host.append(make("div", { class: "sliders", id: "sliders" }));
    const place = make("div", { class: "panels", style: "--least: 330px" });
    panels = [[solid, false, "Surface"], [flat, true, "Unrolled, equal areas"]].map(([maps, unrolled, title]) => {
      const p = { maps, flat: unrolled, title: () => title, marks: [], canvas: makeMapCanvas(unrolled ? "flat" : "solid") };
      p.element = makePanel([make("h3", { text: title })], p.canvas);
      if (maps.fault) p.canvas.hidden = true;
      place.append(p.element);
      return p;
    });
    readout = make("div", { class: "readout", id: "map-readout" });
    const bar = make("div", { class: "bars" }, make("canvas", { id: "map-bar" }));
    const time = makeTimeBar(["map-play", "map-state", "map-time"], "Play over the states", Report.study.states, 0, () => play(!player.on), (k) => { play(false); setState(k); });
    host.append(place, bar, readout, time);
    for (const note of about.notes) host.append(make("p", { class: "keys", text: note.charAt(0).toUpperCase() + note.slice(1) + "." }));
    host.append(make("p", { class: "keys", text: "Drag turns, Shift + drag shifts, Ctrl + wheel or a pinch enlarges, a double click resets. Pressures at the nodes of the surface with springs, in the reference configuration. In a state the edge of contact encloses as much area as the facets with pressure have; what is summed over states is shown wherever a node had pressure." }));
    for (const [maps, own, other] of [[solid, 0, 1], [flat, 1, 0]]) {
      maps.setPanels([panels[own]]);
      maps.onreset = () => { view.surface = null; update(); };
      maps.onpick = () => { link(own, other); words(); };
    }
    fitControls();
  }
  function fitControls() {
    $("map-group-label").hidden = !["means", "deviations"].includes(view.show) || Report.means.groups.length < 2;
    $("map-cycle").hidden = !isMean() || Report.study.states < 2;
    $("sliders").hidden = isMean();
  }
  // What is under the pointer in one map, in the other.
  function link(own, other) {
    const from = panels[own], to = panels[other];
    if (to.element.hidden || !to.what) return;
    const m = to.what.mesh;
    to.hit = from.maps.hover && from.hit ? { ...from.hit, point: [...m.vertices.subarray(3 * from.hit.vertex, 3 * from.hit.vertex + 3)] } : null;
    to.maps.hover = from.maps.hover;
    to.maps.request();
  }

  // ---- saving, on white ----
  const picture = () => mapsPicture(solid, panels.filter((p) => !p.element.hidden), [view.scale], { head: [$("map-time").textContent, readout.textContent] });
  function nodeTable() {
    const s = about.surfaces[view.now.surface], now = view.now, mesh = panels[now.common ? 1 : 0].what.mesh, rows = [], count = now.shown && now.shown.count;
    for (let v = 0; v < mesh.vertexCount; ++v) rows.push([mesh.nodes[v] + 1, ...mesh.vertices.subarray(3 * v, 3 * v + 3), StudyFigures.exact(now.shown ? now.shown.values[v] : NaN), ...(count ? [count[v]] : [])]);
    return { headings: [now.common ? "point of the common grid" : "node of the surface", "x", "y", "z", quantityTitle(), ...(count ? ["cases that cover it"] : [])], rows, surface: s.surface };
  }
  function save(kind) {
    const name = fileName(`map ${view.show} ${view.now.of ? "case " + view.now.of.map((c) => c.field.number).join("-") : ""} ${view.show === "state" ? view.state + 1 : ""}`);
    if (kind === "csv") return Figures.save(new Blob([csvText(nodeTable())], { type: "text/csv" }), name + ".csv");
    const canvas = picture(), { width, height } = canvas;
    if (kind === "png") return Figures.saveCanvas(canvas, name);
    const { svg, svgns } = Figures.tools, out = svg("svg", { xmlns: svgns, width, height, viewBox: `0 0 ${width} ${height}` });
    out.append(svg("image", { width, height, href: canvas.toDataURL("image/png") }));
    Figures.saveSvg(out, name);
  }

  async function start(host, thePage) {
    build(host, thePage);
    index();
    sliders();
    view.state = loadedState();
    $("map-state").value = String(view.state);
    await update();
  }
  // The state in which the first case that is shown bears most.
  function loadedState() {
    const of = corners(), force = Report.statistics.findIndex((s) => s.name === "force");
    if (!of) return 0;
    const place = Report.places.findIndex((p) => p.part === "" && p.contact === surfaceOf(of[0].field).contact), i = page.placeOf(of[0].field.number), v = Study.kept.get(force + "," + place);
    if (!v || i < 0) return 0;
    let best = 0;
    for (let k = 0; k < Report.study.states; ++k) if (v[i * Report.choices.length + k] > (v[i * Report.choices.length + best] || 0)) best = k;
    return best;
  }
  function setTheme(theme) {
    view.theme = theme;
    if (!solid) return;
    for (const maps of [solid, flat]) { maps.theme = theme; maps.request(); }
    drawBarNow();
  }
  // The sliders to a case, by its number.
  function showCase(number) {
    const f = about.fields.find((x) => x.number === number && ofContact(x));
    if (!f) return false;
    if (gridded()) { view.at = own.map((c, k) => f.levels[k]).map((l, k) => kept[k].indexOf(l)); sliders(); } else { view.position = order.indexOf(f); $("position") && ($("position").value = String(view.position)); }
    update();
    return true;
  }
  return { start, update, setTheme, setState, play, showCase, view, drawBarNow, get panels() { return panels; }, get maps() { return [solid, flat]; }, get settled() { return solid.settled && flat.settled; } };
})();
