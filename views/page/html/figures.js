// The 2-D figures: each is a function of the page's state that returns an SVG element. Numbers come from the report.
"use strict";

const Figures = (() => {
  const fontFamily = '"Source Sans 3", "Source Sans Pro", "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif';

  // Colour and dash of result i: the reference is in ink, the others in colours that the colour-blind can tell apart.
  function style(i, count, ink, reference) {
    if (reference && i === count - 1) return { colour: ink.reference, dash: null };
    const n = ink.series.length;
    return { colour: ink.series[i % n], dash: [null, "6,3", "2,3"][Math.floor(i / n) % 3] };
  }
  const compared = () => Report.kind === "compare";
  const labels = () => Report.results.map((r) => r.label);
  const labelled = (i) => labels()[i] + (Format.unit("pressure") ? ` [${Format.unit("pressure")}]` : "");
  const resultStyle = (i, ink) => style(i, Report.results.length, ink, compared());

  const ruler = document.createElement("canvas").getContext("2d");
  function textWidth(text, size) {
    ruler.font = `${size}px ${getComputedStyle(document.body).fontFamily}`;
    return ruler.measureText(text).width;
  }
  function cut(text, size, width) {
    if (textWidth(text, size) <= width) return text;
    let n = text.length;
    while (n > 1 && textWidth(text.slice(0, n) + "…", size) > width) --n;
    return text.slice(0, n) + "…";
  }

  const svgns = "http://www.w3.org/2000/svg";
  function svg(tag, attributes, text) {
    const e = document.createElementNS(svgns, tag);
    for (const [k, v] of Object.entries(attributes)) if (v !== null) e.setAttribute(k, v);
    if (text !== undefined) e.textContent = text;
    return e;
  }

  const root = (width, height, ink) => svg("svg", { xmlns: svgns, width, height, viewBox: `0 0 ${width} ${height}`, "font-family": fontFamily, "font-size": 13, fill: ink.ink, role: "img" });
  // A chart of Plot's inside another picture.
  function place(parent, chart, x, y) {
    chart.removeAttribute("class");
    for (const old of chart.querySelectorAll("style")) old.remove();
    chart.setAttribute("x", x);
    chart.setAttribute("y", y);
    parent.append(chart);
  }
  // A figure with its legend above, as one SVG. entries: { name, colour, dash, box }.
  function withLegend(chart, entries, ink, width) {
    const size = 13, row = 20;
    let x = 0, y = 0;
    const places = entries.map((e) => {
      const text = cut(e.name, size, width - 40), w = 28 + textWidth(text, size) + 18;
      if (x > 0 && x + w > width) { x = 0; y += row; }
      const place = [x, y, text];
      x += w;
      return place;
    });
    const top = entries.length ? y + row + 6 : 0, height = Number(chart.getAttribute("height")) + top;
    const out = root(width, height, ink);
    entries.forEach((e, i) => {
      const [px, py, text] = places[i];
      if (e.box) out.append(svg("rect", { x: px + 3, y: py + 3, width: 16, height: 12, fill: e.colour }));
      else out.append(svg("line", { x1: px, x2: px + 22, y1: py + 9, y2: py + 9, stroke: e.colour, "stroke-width": 2.2, "stroke-dasharray": e.dash }));
      out.append(svg("text", { x: px + 28, y: py + 13.5 }, text));
    });
    place(out, chart, 0, top);
    return out;
  }

  function base(width, height, ink) {
    return { width, height, style: { background: "none", color: ink.ink, fontFamily, fontSize: "13px", overflow: "visible" },
      marginLeft: 62, marginBottom: 44, marginTop: 14, marginRight: 28 };  // right: half of the last number of the x axis
  }
  const grid = (ink) => ({ stroke: ink.line, strokeOpacity: 1 });
  const axis = { labelAnchor: "center", labelArrow: "none", tickSize: 4, tickPadding: 4, labelOffset: 38 };
  const axisY = { labelAnchor: "center", labelArrow: "none", tickSize: 4, tickPadding: 4, labelOffset: 52, ticks: 5 };
  // build(margin) -> chart, with as much room left of the axis as the ticks need beside the title.
  function fitted(build) {
    const chart = build(62);
    const ticks = [...chart.querySelectorAll('[aria-label="y-axis tick label"] text')].map((t) => textWidth(t.textContent, 13));
    const margin = Math.ceil(Math.max(0, ...ticks)) + 38;
    return margin > 62 ? build(margin) : chart;
  }
  const axisAt = (margin) => ({ ...axisY, labelOffset: margin - 10 });
  const known = (x) => x !== null && x !== undefined && !Number.isNaN(x);
  const tick = (x) => Format.short(x, 6);
  // A chart between two axes. `across`, `up`: what they have beside the usual, or across a function that makes the axis; `plot`: scales and marks.
  function framed(width, height, ink, across, up, { marks, ...plot }) {
    return fitted((margin) => {
      const upwards = { ...axisAt(margin), tickFormat: tick, ...up };
      return Plot.plot({
        ...base(width, height, ink), marginLeft: margin, ...plot,
        marks: [Plot.gridY({ ...grid(ink), ticks: upwards.ticks }), typeof across === "function" ? across() : Plot.axisX({ ...axis, tickFormat: tick, ...across }), Plot.axisY(upwards), ...marks]
      });
    });
  }
  const ticksIn = (width, each = 90) => Math.max(3, Math.floor(width / each));
  // Rows of marks: y "0", "1", ... from the top, each with its name before it, cut to `room`. `lines`: how many across.
  function rowed(width, height, ink, { names, room, padding, x, across, lines, marks, entries = [] }) {
    const shown = names.map((name) => cut(name, 13, room));
    const chart = Plot.plot({
      ...base(width, height, ink), marginLeft: 16 + Math.max(...shown.map((name) => textWidth(name, 13))),
      x, y: { domain: names.map((name, i) => String(i)), label: null, padding },
      marks: [Plot.gridX({ ...grid(ink), ticks: lines }), Plot.axisX({ ...axis, tickFormat: tick, ...across }), Plot.axisY({ tickSize: 0, tickFormat: (i) => shown[Number(i)] }), ...marks]
    });
    return withLegend(chart, entries, ink, width);
  }
  // A box in each of these rows: ends of the whiskers, box on what is `under` it, median, mean. `keys`: of whiskers and box, from low to high.
  function boxMarks(rows, [low, from, to, high], colour, ink, under = []) {
    return [
      ...[low, high].map((x) => Plot.tickX(rows, { x, y: "y", stroke: colour, strokeWidth: 1.6, insetTop: 6, insetBottom: 6 })), ...under,
      Plot.barX(rows, { x1: from, x2: to, y: "y", fill: colour, fillOpacity: 0.28, stroke: colour, strokeWidth: 1.6 }),
      Plot.tickX(rows, { x: "median", y: "y", stroke: colour, strokeWidth: 2.6 }),
      Plot.dot(rows, { x: "mean", y: "y", symbol: "diamond", r: 4, fill: ink.paper, stroke: colour, strokeWidth: 1.5 })
    ];
  }

  // ---- curves over time ----
  // series: [{ name, times, values, colour, dash }]
  function curves({ series, quantity, dimension, logarithmic, now, zero = true, x = Report.time_name }, width, ink) {
    const points = [], dots = [];
    series.forEach((s, i) => s.times.forEach((t, k) => {
      const y = known(s.values[k]) ? s.values[k] : NaN;
      points.push({ i, t, y });
      const alone = (k === 0 || !known(s.values[k - 1])) && (k + 1 === s.values.length || !known(s.values[k + 1]));
      if (known(s.values[k]) && (alone || s.times.length <= 30)) dots.push({ i, t, y });
    }));
    const any = points.some((p) => !Number.isNaN(p.y)), powers = [];
    const ends = logarithmic ? decades(points.map((p) => p.y)) : null;
    if (ends) {
      const from = Math.round(Math.log10(ends[0])), to = Math.round(Math.log10(ends[1])), step = Math.ceil((to - from) / 5);
      for (let k = from; k <= to; k += step) powers.push(10 ** k);
    }
    const up = { label: Format.axis(quantity, dimension), ...(logarithmic ? { labelOffset: 70, ticks: powers, tickFormat: powerOfTen } : {}) };
    const chart = framed(width, 270, ink, { label: x, ticks: ticksIn(width) }, up, {
      ...(logarithmic ? { marginLeft: 78 } : {}),
      x: { label: x, grid: false, domain: extent(points.map((p) => p.t)) },
      y: logarithmic ? { type: "log", domain: ends } : { nice: true, zero, ...(any ? {} : { domain: [0, 1] }) },
      marks: [
        logarithmic ? null : Plot.ruleY([0], { stroke: ink.soft }),
        known(now) ? Plot.ruleX([now], { stroke: ink.soft, strokeDasharray: "2,3" }) : null,
        ...series.map((s, i) => Plot.line(points.filter((p) => p.i === i), { x: "t", y: "y", stroke: s.colour, strokeWidth: 1.9, strokeDasharray: s.dash })),
        Plot.dot(dots, { x: "t", y: "y", fill: (d) => series[d.i].colour, r: 2.3, title: (d) => `${series[d.i].name}, ${x} ${tick(d.t)}: ${Format.with(d.y, dimension)}` })
      ]
    });
    return withLegend(chart, series.length > 1 ? series : [], ink, width);
  }

  function decades(values) {
    const [least, most] = extent(values.filter((x) => x > 0).map(Math.log10));
    return [10 ** Math.floor(least), 10 ** Math.max(Math.ceil(most), Math.floor(least) + 1)];
  }
  function powerOfTen(x) {
    const power = Math.round(Math.log10(x));
    return "10" + String(power).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
  }

  function extent(values) {
    let least = Infinity, most = -Infinity;
    for (const x of values) if (known(x)) { least = Math.min(least, x); most = Math.max(most, x); }
    if (!(most > least)) return Number.isFinite(least) ? [least - 0.5, least + 0.5] : [0, 1];
    return [least, most];
  }

  // A number of every state of every result: get(measures) of the chosen region.
  function measureSeries(state, ink, get) {
    return Report.results.map((r, i) => ({
      name: r.label, times: r.times, ...resultStyle(i, ink),
      values: state.surface.about.measures[i].map((m) => (m[state.region] ? get(m[state.region]) : null))
    }));
  }
  const nowOf = (state) => Report.frames[state.frame].time;
  // Of a result's region in the state that is shown; null: there are none.
  function measuresNow(state, i, region) {
    const k = Report.frames[state.frame].states[i];
    return k < 0 ? null : state.surface.about.measures[i][k]?.[region];
  }

  // ---- figures: { id, title, caption(state), build(state, width, ink), wide, when(state) } ----
  function box(state, width, ink) {
    const rows = Report.results.map((r, i) => ({ i, y: String(i), ...(measuresNow(state, i, state.region) || {}).nodes })), full = rows.filter((r) => known(r.median));
    const colour = (r) => resultStyle(r.i, ink).colour;
    return rowed(width, 66 + 46 * rows.length, ink, {
      names: labels(), room: Math.min(170, width * 0.32), padding: 0.42, across: { label: Format.axis("pressure", "pressure"), ticks: ticksIn(width, 110) },
      x: { zero: true, nice: true, ...(full.length ? {} : { domain: [0, 1] }) },
      marks: [
        Plot.link(full, { x1: "p5", x2: "p95", y1: "y", y2: "y", stroke: colour, strokeWidth: 1.6 }),
        ...boxMarks(full, ["p5", "p25", "p75", "p95"], colour, ink, [Plot.barX(full, { x1: "p25", x2: "p75", y: "y", fill: ink.paper })]),
        Plot.dot(full, { x: "peak", y: "y", r: 3.2, fill: colour })
      ]
    });
  }

  // Nodal pressures of each result over the reference's, one panel each.
  function scatter(state, width, ink) {
    const last = Report.results.length - 1, frame = Report.frames[state.frame], s = state.surface;
    const nodal = frame.states.map((k, i) => {
      const values = s.fields.pressure[i] && s.fields.pressure[i].state(k);
      return values ? Data.carried(s, i, Data.nodalAverage(s.meshes[i], values)) : null;
    });
    const most = Math.max(1e-12, ...nodal.filter(Boolean).map((v) => v.reduce((a, x) => (x > a ? x : a), 0)));
    const columns = Math.min(last, Math.max(1, Math.floor(width / 280))), each = (width - 22 * (columns - 1)) / columns;
    const side = Math.min(each, 430), rows = Math.ceil(last / columns), high = side + 34;
    const out = root(width, rows * high, ink);
    for (let i = 0; i < last; ++i) {
      const points = [], a = nodal[i], b = nodal[last];
      if (a && b) for (let v = 0; v < b.length; ++v) if (!Number.isNaN(a[v]) && (a[v] > 0 || b[v] > 0)) points.push([b[v], a[v]]);
      const pattern = s.about.patterns[state.frame][0][i], colour = resultStyle(i, ink).colour, many = points.length > 5000;
      const line = [];
      if (pattern && known(pattern.slope)) {
        // inside the frame
        const at = (x) => pattern.intercept + pattern.slope * x, xs = [0, most];
        if (pattern.slope > 0) { xs[0] = Math.max(0, -pattern.intercept / pattern.slope); xs[1] = Math.min(most, (most - pattern.intercept) / pattern.slope); }
        if (xs[1] > xs[0]) line.push({ x1: xs[0], y1: at(xs[0]), x2: xs[1], y2: at(xs[1]) });
      }
      const chart = fitted((margin) => Plot.plot({
        ...base(side, side, ink), marginLeft: margin, marginRight: 8, marginTop: 8,
        x: { domain: [0, most] }, y: { domain: [0, most] },
        color: many ? { type: "log", range: [ink.line, colour] } : undefined,
        marks: [
          Plot.gridX({ ...grid(ink), ticks: 5 }), Plot.gridY({ ...grid(ink), ticks: 5 }),
          Plot.axisX({ ...axis, ticks: 5, label: cut(labelled(last), 13, side - 80), tickFormat: tick }),
          Plot.axisY({ ...axisAt(margin), label: cut(labelled(i), 13, side - 70), tickFormat: tick }),
          many ? Plot.dot(points, Plot.hexbin({ fill: "count" }, { x: (p) => p[0], y: (p) => p[1], binWidth: 6, symbol: "hexagon", r: 3.4, stroke: null }))
               : Plot.dot(points, { x: (p) => p[0], y: (p) => p[1], r: 1.7, fill: colour, fillOpacity: 0.5 }),
          Plot.link([0], { x1: 0, y1: 0, x2: most, y2: most, stroke: ink.soft, strokeDasharray: "4,4" }),
          Plot.link(line, { x1: "x1", y1: "y1", x2: "x2", y2: "y2", stroke: ink.ink, strokeWidth: 1.4 })
        ]
      }));
      const x = (i % columns) * (each + 22), y = Math.floor(i / columns) * high;
      const words = pattern ? `r = ${Format.number(pattern.r, 3)}, slope ${Format.number(pattern.slope, 3)}` : "no values at this time";
      out.append(svg("text", { x: x + 62, y: y + 15, "font-weight": 600 }, cut(words, 14, side - 64)));
      place(out, chart, x, y + 24);
    }
    return out;
  }

  // Bars by region: one cluster per region.
  function bars(quantity, dimension, get) {
    return (state, width, ink) => {
      const about = state.surface.about, rows = [], names = about.regions.map((r) => r || "whole surface");
      about.regions.forEach((name, r) => Report.results.forEach((result, i) => {
        const m = measuresNow(state, i, r), value = m ? get(m) : null;
        rows.push({ fx: String(r), x: String(i), i, y: known(value) ? value : NaN });
      }));
      const band = (width - 76) / names.length;
      const regions = () => Plot.axisFx({ anchor: "bottom", tickSize: 0, label: null, tickFormat: (r) => cut(names[Number(r)], 13, band) });
      const chart = framed(width, 260, ink, regions, { label: Format.axis(quantity, dimension) }, {
        fx: { domain: names.map((n, r) => String(r)), padding: 0.2, label: null, axis: null },
        x: { axis: null, domain: Report.results.map((r, i) => String(i)), padding: 0.08 },
        y: { zero: true, nice: true },
        marks: [
          Plot.barY(rows, { fx: "fx", x: "x", y: "y", fill: (d) => resultStyle(d.i, ink).colour, title: (d) => Format.with(d.y, dimension) }),
          Plot.ruleY([0], { stroke: ink.soft })
        ]
      });
      return withLegend(chart, Report.results.map((r, i) => ({ name: r.label, box: true, colour: resultStyle(i, ink).colour })), ink, width);
    };
  }

  function profile(state, width, ink) {
    const about = state.surface.about, bins = about.bins, all = about.profiles[state.frame];
    const filled = (b) => all.some((p) => p && known(p[b]));
    let from = 0, to = bins.length - 1;  // bins before the first facet and behind the last one say nothing
    while (to > 0 && !filled(to - 1)) --to;
    while (from < to && !filled(from)) ++from;
    const places = Array.from({ length: to - from }, (x, k) => from + k);
    const series = Report.results.map((r, i) => ({
      name: r.label, ...resultStyle(i, ink), times: places.map((b) => (bins[b] + bins[b + 1]) / 2),
      values: places.map((b) => (all[i] && known(all[i][b]) ? all[i][b] : null))
    }));
    return curves({ series, quantity: "mean pressure", dimension: "pressure", x: "angle from the axis [°]", now: null }, width, ink);
  }

  // Percentiles of one result against time, as bands.
  function bands(state, width, ink) {
    const r = Report.results[0], rows = r.times.map((t, k) => {
      const m = state.surface.about.measures[0][k], d = m && m[state.region] ? m[state.region].nodes : {};
      const or = (x) => (known(x) ? x : NaN);
      return { t, p5: or(d.p5), p25: or(d.p25), median: or(d.median), p75: or(d.p75), p95: or(d.p95), peak: or(d.peak) };
    });
    const c = ink.series[0], any = rows.some((d) => !Number.isNaN(d.median));
    const chart = framed(width, 270, ink, { label: Report.time_name, ticks: ticksIn(width) }, { label: Format.axis("pressure", "pressure") }, {
      x: { domain: extent(rows.map((d) => d.t)) }, y: { zero: true, nice: true, ...(any ? {} : { domain: [0, 1] }) },
      marks: [
        Plot.areaY(rows, { x: "t", y1: "p5", y2: "p95", fill: c, fillOpacity: 0.18 }),
        Plot.areaY(rows, { x: "t", y1: "p25", y2: "p75", fill: c, fillOpacity: 0.35 }),
        Plot.line(rows, { x: "t", y: "median", stroke: c, strokeWidth: 2.2 }),
        Plot.line(rows, { x: "t", y: "peak", stroke: c, strokeWidth: 1.4, strokeDasharray: "3,3" }),
        Plot.dot(rows.filter((d) => !Number.isNaN(d.median)), { x: "t", y: "median", r: 2.3, fill: c }),
        Plot.ruleY([0], { stroke: ink.soft }),
        known(nowOf(state)) ? Plot.ruleX([nowOf(state)], { stroke: ink.soft, strokeDasharray: "2,3" }) : null
      ]
    });
    return withLegend(chart, [{ name: "median", colour: c }, { name: "peak", colour: c, dash: "3,3" }], ink, width);
  }

  const regionName = (state) => { const r = state.surface.about.regions[state.region]; return r ? `, region ${r}` : ""; };
  const where = (state) => `${state.surface.about.title}${regionName(state)}`;
  const at = (state) => { const t = nowOf(state); return t === null ? "compared states" : Format.at(t); };
  const over = (id, title, quantity, dimension, get, caption) => ({
    id, title, caption: (state) => `${caption} ${where(state)}.`,
    build: (state, width, ink) => curves({ series: measureSeries(state, ink, get), quantity, dimension, now: nowOf(state) }, width, ink)
  });

  // Keys of the headline numbers, titles, quantities, dimensions.
  const headlines = [["p99", "99th percentile", "p99", "pressure"], ["mean", "Mean pressure", "mean pressure", "pressure"], ["area", "Contact area", "contact area", "area"], ["peak", "Peak pressure", "peak pressure", "pressure"]];
  function list() {
    const out = { now: [], time: [] };
    if (!Report.surfaces.length) return out;
    const several = Report.surfaces.some((s) => s.regions.length > 1);
    if (compared() || Report.results[0].times.length === 1)
      out.now.push({ id: "box", title: "Pressure distribution", build: box,
        caption: (s) => `Nodes with pressure, weighted by area: box 25 to 75 %, line median, diamond mean, whiskers 5 and 95 %, dot peak. ${where(s)}, ${at(s)}.` });
    if (compared()) {
      out.now.push({ id: "scatter", title: "Node by node", build: scatter, wide: Report.results.length > 3,
        caption: (s) => `Nodal pressure of each result over that of ${labels()[labels().length - 1]}, where either is above 0. Dashed: identity; solid: least-squares line. r and slope weighted by nodal area. ${s.surface.about.title}, ${at(s)}.` });
      if (several) {
        const when = (s) => s.surface.about.regions.length > 1;
        for (const [key, title, quantity, dimension] of headlines)
          out.now.push({ id: "region-" + key, title: title + " by region", when: (s) => s.surface.about.regions.length > 1, build: bars(quantity, dimension, (m) => m.headline[key]), caption: (s) => `Above the threshold. ${s.surface.about.title}, ${at(s)}.` });
      }
      if (Report.surfaces.some((s) => s.bins.length > 1))
        out.now.push({ id: "profile", title: "Pressure along the angle", build: profile, when: (s) => s.surface.about.bins.length > 1,
          caption: (s) => `Area-weighted mean of the facets in each bin, those without pressure included, against the angle from the axis. ${s.surface.about.title}, ${at(s)}.` });
      if (Report.results.some((r) => r.times.length > 1)) {
        for (const [key, title, quantity, dimension] of headlines) out.time.push(over("time-" + key, title, quantity, dimension, (m) => m.headline[key], "Above the threshold."));
        out.time.push(over("time-force", "Resultant", "force", "force", (m) => m.force, "|Σ p A n| on the surface in its reference shape."));
      }
    } else {
      if (Report.results[0].times.length > 1)
        out.time.push({ id: "bands", title: "Pressure distribution", build: bands,
          caption: (s) => `Nodes with pressure, weighted by area: bands 5 to 95 % and 25 to 75 %. ${where(s)}.` });
    }
    if (Report.kind === "run" && (Report.charts[0] || { times: [] }).times.length > 1)
      Report.charts.forEach((c, i) => out.time.push({
        id: "chart" + i, title: c.title, caption: () => c.caption,
        build: (state, width, ink) => curves({
          series: c.names.map((name, k) => ({ name, times: c.times, values: c.values[k], ...style(k, c.names.length, ink, false) })),
          quantity: c.quantity, dimension: c.dimension, logarithmic: c.logarithmic, now: nowOf(state) }, width, ink)
      }));
    for (const f of out.now) tell(f, (state) => [Report.frames[state.frame]]);
    for (const f of out.time) tell(f, () => Report.frames);
    return out;
  }
  // States that are no solution are drawn as the others: the caption says which they are.
  function tell(figure, frames) {
    const { caption } = figure;
    figure.caption = (state) => {
      const times = frames(state).filter((f) => f.unsolved.length).map((f) => (f.time === null ? "the compared states" : Format.short(f.time, 9)));
      if (!times.length) return caption(state);
      const listed = times.length > 8 ? `${times.slice(0, 8).join(", ")}, ... (${times.length} states)` : times.join(", ");
      return `${caption(state)} No solution: ${Format.at(listed)}.`;
    };
  }

  // ---- on the page ----
  // Heading, buttons that save, plot, caption.
  function element(f, state) {
    const button = (text, title, click) => make("button", { text, title, "data-save": text.toLowerCase(), onclick: click });
    f.plot = make("div", { class: "plot" });
    f.words = make("figcaption", { class: "caption" });
    f.head = make("h3", {});
    f.element = make("figure", { id: "figure-" + f.id, class: f.wide ? "wide" : null }, make("div", { class: "title" }, f.head, make("span", { class: "save" },
      button("PNG", "Save as PNG", () => savePng(f, state, fileName(f.id))), button("SVG", "Save as SVG", () => saveSvg(onPaper(f, state), fileName(f.id))),
      f.table ? button("CSV", "Save the numbers", () => saveCsv(f.table(state), f.id)) : null)), f.plot, f.words);
    return f.element;
  }
  // As wide as there is room.
  function draw(f, state) {
    f.element.hidden = f.when ? !f.when(state) : false;
    const width = Math.floor(Math.min(f.plot.clientWidth || 600, f.wide ? 1100 : 720));
    if (f.element.hidden || width < 60) return;
    f.head.textContent = typeof f.title === "string" ? f.title : f.title(state);
    try {
      f.plot.replaceChildren(f.build(state, width, Colours.ink[state.theme]));
    } catch (error) {  // the other figures are drawn all the same
      f.plot.replaceChildren(make("p", { class: "fault", text: `This figure could not be drawn: ${error.message}` }));
      console.error(error);
    }
    f.words.textContent = f.caption(state);
    if (f.drawn) f.drawn();
  }
  // Those out of sight after `wait` ms in which nothing else is drawn. `then`: after each of both.
  let later = 0;
  function drawAll(figures, state, wait, then = () => {}) {
    clearTimeout(later);
    const waiting = [];
    for (const f of figures) {
      const box = f.element.getBoundingClientRect();
      if (!f.element.hidden && (box.top > window.innerHeight + 300 || box.bottom < -300)) waiting.push(f);
      else draw(f, state);
    }
    then();
    if (waiting.length) later = setTimeout(() => { waiting.forEach((f) => draw(f, state)); then(); }, wait);
  }

  // ---- saving ----
  function save(blob, name) {
    const url = URL.createObjectURL(blob), link = make("a", { href: url, download: name });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  }
  async function saveCanvas(canvas, name) { save(await new Promise((done) => canvas.toBlob(done, "image/png")), name + ".png"); }
  const svgText = (root) => '<?xml version="1.0" encoding="UTF-8"?>\n' + new XMLSerializer().serializeToString(root);
  const saveSvg = (root, name) => save(new Blob([svgText(root)], { type: "image/svg+xml" }), name + ".svg");
  // On white, whatever the page's theme: pictures go into papers.
  function onPaper(figure, state) {
    const ink = Colours.ink.light, root = figure.build(state, 620, ink), width = Number(root.getAttribute("width")) + 24, height = Number(root.getAttribute("height")) + 24;
    const out = svg("svg", { xmlns: svgns, width, height, viewBox: `0 0 ${width} ${height}` });
    root.setAttribute("x", 12);
    root.setAttribute("y", 12);
    out.append(svg("rect", { width: "100%", height: "100%", fill: ink.paper }), root);
    return out;
  }
  async function savePng(figure, state, name) {
    const root = onPaper(figure, state), k = 3;
    const image = new Image();
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svgText(root));
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = k * Number(root.getAttribute("width"));
    canvas.height = k * Number(root.getAttribute("height"));
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    saveCanvas(canvas, name);
  }

  // what the figures of studies are made of, too
  const tools = { svg, svgns, root, place, withLegend, base, axis, axisAt, fitted, framed, ticksIn, rowed, boxMarks, known, tick, extent, style };
  return { list, element, draw, drawAll, save, saveCanvas, saveSvg, resultStyle, cut, textWidth, tools };
})();
