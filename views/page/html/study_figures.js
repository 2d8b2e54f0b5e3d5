// Figures of a study: each is a function of the page's state that returns an SVG element, and of its numbers as a table.
// All statistics come from the program; here they are chosen, drawn and written down.
"use strict";

// The numbers of the shown cases, unpacked.
const Study = (() => {
  // unit: behind a number
  const unitOf = (c) => { const unit = Format.unit(c.dimension); return { label: c.name + (unit && ` [${unit}]`), unit: unit.length > 1 ? " " + unit : unit }; };
  const columns = Report.columns.map((c) => ({ ...c, ...unitOf(c), numbers: c.levels.map((l) => (c.numeric ? Number(l) : NaN)), level: null }));
  const own = columns.filter((c) => !c.of);  // the study's; those of a table of subjects stand behind them
  const out = { columns, own, numbers: null, outcomes: null, count: 0, cells: null, kept: new Map() };
  out.start = async () => {
    for (const c of columns) c.level = await Data.array(Report.columns[columns.indexOf(c)].level);
    out.numbers = await Data.array(Report.cases.number);
    out.outcomes = await Data.array(Report.cases.outcome);
    out.count = out.numbers.length;
    for (const c of columns) c.shown = Array.from(new Set(c.level)).sort((a, b) => a - b);
    if (!Report.grid) return;
    out.cells = new Int32Array(own.reduce((n, c) => n * c.levels.length, 1)).fill(-1);
    for (let i = 0; i < out.count; ++i) out.cells[out.cell(own.map((c) => c.level[i]))] = i;
  };
  out.cell = (levels) => own.reduce((n, c, k) => n * c.levels.length + levels[k], 0);
  out.load = async (s, p) => {
    const key = s + "," + p;
    if (!out.kept.has(key)) out.kept.set(key, await Data.array(Report.values[s][p]));
    return out.kept.get(key);
  };
  // Of a shown case; NaN: no solution, no number, or no such case.
  out.value = (state, i, choice = state.choice, s = state.statistic) => {
    const v = out.kept.get(s + "," + state.place);
    return i < 0 || !v ? NaN : v[i * Report.choices.length + choice];
  };
  out.level = (c, i) => columns[c].levels[columns[c].level[i]];
  out.said = (c, level) => `${c.name} = ${c.levels[level]}${c.unit}`;
  out.words = (i) => columns.map((c) => out.said(c, c.level[i])).join(", ");
  return out;
})();

const StudyFigures = (() => {
  const { svg, svgns, root, place, withLegend, base, axis, axisAt, fitted, framed, ticksIn, rowed, boxMarks, known, tick, extent, style } = Figures.tools;
  const cut = Figures.cut, textWidth = Figures.textWidth, kMostLines = 12, kMostPanels = 12, kMostDots = 3000;

  const statistic = (state) => Report.statistics[state.statistic];
  const axisOf = (state) => {
    const { quantity, dimension } = statistic(state);
    return Format.axis(quantity, dimension) + (dimension === "none" || Format.unit(dimension) ? "" : " [the model's unit]");
  };
  // Numbers of the inside of the layers are of whole contacts, and not of each.
  const isInside = (s) => /^(source|target)_/.test(Report.statistics[s].name);
  const hasPlace = (s, p) => !isInside(s) || Report.summary[s][p].some((b) => b.count > 0);
  const where = (state) => `${Report.places[state.place].title}, ${Report.choices[state.choice]}`;
  const ofState = (table, state) => table[state.statistic][state.place][state.choice];
  const column = (c) => Study.columns[c];
  const seriesStyle = (i, ink) => style(i, 99, ink, false);
  const exact = (x) => (known(x) ? Number(Number(x).toPrecision(7)) : "");

  // Charts side by side, each with a title; the legend above them.
  function panels(charts, titles, entries, width, ink, extra) {
    const columns = charts.length < 2 ? 1 : Math.max(1, Math.min(charts.length, Math.floor(width / 230)));
    const each = Math.floor((width - 14 * (columns - 1)) / columns), built = charts.map((build) => build(each));
    const head = titles ? 22 : 0, high = Math.max(...built.map((b) => Number(b.getAttribute("height")))) + head;
    const out = svg("svg", { xmlns: svgns, width, height: Math.ceil(built.length / columns) * (high + 8), fill: ink.ink });
    built.forEach((chart, i) => {
      const x = (i % columns) * (each + 14), y = Math.floor(i / columns) * (high + 8);
      if (titles) out.append(svg("text", { x: x + 6, y: y + 15, "font-weight": 600 }, cut(titles[i], 13, each - 10)));
      place(out, chart, x, y + head);
    });
    const whole = withLegend(out, entries, ink, width);
    return extra ? stacked(extra, whole, width, ink) : whole;
  }
  function stacked(above, below, width, ink) {
    const a = Number(above.getAttribute("height")), b = Number(below.getAttribute("height")), out = root(width, a + b, ink);
    place(out, above, 0, 0);
    place(out, below, 0, a);
    return out;
  }
  // Colours of a scale, as a figure's head.
  function colourBar(title, scale, width, ink) {
    const ticks = lines(scale, true), texts = ticks.map((v) => Format.short(v, 6)), widest = Math.max(...texts.map((t) => textWidth(t, 12)));
    const out = root(width, 46, ink), from = Math.max(8, widest / 2), to = Math.min(width - Math.max(24, widest / 2), 380), span = to - from;
    out.append(svg("text", { x: from, y: 13 }, cut(title, 13, width - 20)));
    for (let i = 0; i < 64; ++i) out.append(svg("rect", { x: from + i * span / 64, y: 19, width: span / 64 + 0.5, height: 10, fill: Colours.css("sequential", (i + 0.5) / 64) }));
    const every = Math.max(1, Math.ceil((widest + 8) / (span / Math.max(1, ticks.length - 1))));
    ticks.forEach((v, i) => {
      const x = from + span * (v - scale.low) / (scale.high - scale.low);
      out.append(svg("line", { x1: x, x2: x, y1: 29, y2: 32, stroke: ink.soft }));
      if (i % every === 0) out.append(svg("text", { x, y: 43, "text-anchor": "middle", "font-size": 12, fill: ink.soft }, texts[i]));
    });
    return out;
  }
  function scaleFor(values) {
    let [low, high] = extent(values);
    const step = niceStep(high - low, 8);
    low = Math.floor(low / step + 1e-9) * step;
    high = Math.ceil(high / step - 1e-9) * step;
    return { low, high: high > low ? high : low + step, step };
  }
  function lines(scale, ends) {
    const out = [], m = 1e-6 * scale.step;
    for (let k = Math.ceil(scale.low / scale.step - 1e-6); k * scale.step <= scale.high + m && out.length < 60; ++k) {
      const v = k * scale.step;
      if (ends || (v > scale.low + m && v < scale.high - m)) out.push(v);
    }
    return out;
  }
  const share = (scale, v) => (v - scale.low) / (scale.high - scale.low);

  // ---- response: grids ----
  // The case at levels of columns, [column, level]; others as fixed.
  function caseAt(state, pairs) {
    const at = new Map(pairs);
    return Study.cells[Study.cell(Study.own.map((c, k) => at.get(k) ?? state.fixed[k]))];
  }
  // Levels that shown cases have; of more than `most` some from end to end.
  const levelsOf = (c, most = Infinity) => {
    const all = column(c).shown, n = Math.min(most, all.length);
    return n === all.length ? all : Array.from({ length: n }, (x, i) => all[Math.round(i * (all.length - 1) / (n - 1))]);
  };
  const numbersOf = (c) => column(c).shown.map((l) => column(c).numbers[l]);
  const orderOf = (c, l) => levelsOf(c, kMostLines).indexOf(l);
  // Over columns of a table of subjects cases are dots.
  const gridded = (state) => Report.grid && ![state.x, response(state).second].some((c) => c >= 0 && column(c).of);
  function response(state) {
    const second = state.second >= 0 && state.second !== state.x ? state.second : -1;
    const third = state.third >= 0 && state.third !== state.x && state.third !== second ? state.third : -1;
    return { second, third };
  }
  function fixedWords(state, used) {
    const words = Study.own.map((c, k) => (used.includes(k) ? null : Study.said(c, state.fixed[k]))).filter(Boolean);
    return words.length ? `; ${words.join(", ")}` : "";
  }
  function xScale(c) {
    const col = column(c);
    return col.numeric ? { label: col.label, domain: extent(col.numbers) } : { label: col.name, type: "point", domain: col.levels, padding: 0.5 };
  }
  const xOf = (c, level) => (column(c).numeric ? column(c).numbers[level] : column(c).levels[level]);
  function axisX(c, width) {
    const col = column(c), few = col.numeric && col.levels.length <= Math.max(3, Math.floor(width / 52));
    const room = (width - 70) / Math.max(1, col.levels.length);  // beside the other axis
    const every = Math.ceil(46 / room);  // of words: those that have room
    return { label: cut(col.label, 13, width - 70), ticks: col.numeric ? (few ? col.numbers : Math.max(3, Math.floor(width / 80))) : col.levels.filter((l, i) => i % every === 0),
      tickFormat: col.numeric ? tick : (t) => cut(String(t), 13, room * every - 4) };
  }

  function curvePoints(state, second, panelAt, most = kMostLines) {
    const points = [];
    for (const l of second < 0 ? [0] : levelsOf(second, most))
      for (const k of levelsOf(state.x)) {
        const i = caseAt(state, [...panelAt, [state.x, k], [second, l]]);
        points.push({ line: l, k, i, x: xOf(state.x, k), y: Study.value(state, i) });
      }
    return points;
  }
  function curveChart(state, second, points, domain, ink) {
    return (width) => {
      const lost = points.filter((p) => !known(p.y)), lineStyle = (l) => seriesStyle(second < 0 ? 0 : orderOf(second, l), ink);
      return framed(width, 270, ink, axisX(state.x, width), { label: axisOf(state) }, {
        x: xScale(state.x), y: { domain, nice: true },
        marks: [
          ...[...(second < 0 && !column(state.x).numeric ? [] : new Set(points.map((p) => p.line)))].map((l) => Plot.line(points.filter((p) => p.line === l), { x: "x", y: (p) => (known(p.y) ? p.y : NaN), stroke: lineStyle(l).colour, strokeWidth: 1.9, strokeDasharray: lineStyle(l).dash })),
          Plot.dot(points.filter((p) => known(p.y)), { x: "x", y: "y", r: 2.4, fill: (p) => lineStyle(p.line).colour, title: (p) => `case ${Study.numbers[p.i]}: ${Study.words(p.i)}: ${Format.with(p.y, statistic(state).dimension)}` }),
          Plot.text(lost, { x: "x", y: () => domain[0], text: () => "×", fill: (p) => lineStyle(p.line).colour, fontSize: 14, fontWeight: 700 })
        ]
      });
    };
  }
  function domainOf(values) {
    const [a, b] = extent(values);
    return a >= 0 && a < 0.6 * b ? [0, b] : [a - 0.05 * (b - a), b + 0.05 * (b - a)];
  }
  function panelLevels(third) { return third < 0 ? [null] : levelsOf(third, kMostPanels); }
  const panelMap = (third, l) => (l === null ? [] : [[third, l]]);
  const panelTitles = (third) => (third < 0 ? null : panelLevels(third).map((l) => Study.said(column(third), l)));

  function curve(state, width, ink) {
    const { second, third } = response(state), all = panelLevels(third).map((l) => curvePoints(state, second, panelMap(third, l)));
    const domain = domainOf(all.flat().map((p) => p.y));
    const entries = second < 0 ? [] : levelsOf(second, kMostLines).map((l, i) => ({ name: Study.said(column(second), l), ...seriesStyle(i, ink) }));
    return panels(all.map((points) => curveChart(state, second, points, domain, ink)), panelTitles(third), entries, width, ink);
  }
  function tableOf(state, cases) {
    return { headings: ["case", ...Study.columns.map((c) => c.name), statistic(state).name], rows: cases.map((i) => [Study.numbers[i], ...Study.columns.map((c, k) => Study.level(k, i)), exact(Study.value(state, i))]) };
  }
  function curveTable(state) {
    const { second, third } = response(state);
    return tableOf(state, panelLevels(third).flatMap((l) => curvePoints(state, second, panelMap(third, l), Infinity)).map((p) => p.i).filter((i) => i >= 0));
  }

  // Lines of value `level` through a grid of values, linear between its points: pieces with two ends.
  function isoPieces(x, y, v, level) {
    const pieces = [], cross = (a, b, p, q) => { const f = (level - a) / (b - a); return [p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1])]; };
    for (let i = 0; i + 1 < x.length; ++i) for (let j = 0; j + 1 < y.length; ++j) {
      const corner = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => ({ v: v[a][b], p: [x[a], y[b]] }));
      if (corner.some((c) => !known(c.v))) continue;
      const middle = { v: corner.reduce((s, c) => s + c.v / 4, 0), p: [(x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2] };
      for (let k = 0; k < 4; ++k) {  // four triangles about the middle: no diagonal is preferred
        const t = [corner[k], corner[(k + 1) % 4], middle], ends = [];
        for (let e = 0; e < 3; ++e) {
          const a = t[e], b = t[(e + 1) % 3];
          if ((a.v >= level) !== (b.v >= level)) ends.push(cross(a.v, b.v, a.p, b.p));
        }
        if (ends.length === 2) pieces.push(ends);
      }
    }
    return pieces;
  }
  const edges = (x) => x.map((v, i) => [i === 0 ? v : (x[i - 1] + v) / 2, i + 1 === x.length ? v : (v + x[i + 1]) / 2]);
  function mapValues(state, second, panelAt) {
    return levelsOf(state.x).map((a) => levelsOf(second).map((b) => {
      const i = caseAt(state, [...panelAt, [state.x, a], [second, b]]);
      return { i, v: Study.value(state, i) };
    }));
  }
  function mapChart(state, second, cells, scale, ink) {
    return (width) => {
      const x = numbersOf(state.x), y = numbersOf(second), ex = edges(x), ey = edges(y), boxes = [];
      cells.forEach((row, a) => row.forEach((c, b) => boxes.push({ x: x[a], y: y[b], x1: ex[a][0], x2: ex[a][1], y1: ey[b][0], y2: ey[b][1], ...c })));
      const v = cells.map((row) => row.map((c) => c.v)), values = lines(scale, false), labels = [];
      const there = boxes.filter((d) => known(d.v)).sort((p, q) => p.v - q.v), marks = there.length > 2 ? [{ ...there[0], sign: "▽" }, { ...there.at(-1), sign: "△" }] : [];
      const marked = (p) => marks.some((m) => p.x1 >= m.x1 && p.x1 <= m.x2 && p.y1 >= m.y1 && p.y1 <= m.y2);
      const pieces = values.flatMap((level) => {
        const of = isoPieces(x, y, v, level).map(([p, q]) => ({ level, x1: p[0], y1: p[1], x2: q[0], y2: q[1] }));
        const inside = of.filter((p) => p.x1 > x[0] && p.x1 < x.at(-1) && p.y1 > y[0] && p.y1 < y.at(-1) && !marked(p));
        if (inside.length) labels.push({ level, x: inside[inside.length >> 1].x1, y: inside[inside.length >> 1].y1 });
        return of;
      });
      const line = (level) => Colours.line("sequential", share(scale, level));
      return fitted((margin) => Plot.plot({
        ...base(width, Math.min(430, Math.max(230, width * 0.72)), ink), marginLeft: margin, x: xScale(state.x), y: { ...xScale(second), label: null },
        marks: [
          Plot.rect(boxes, { x1: "x1", x2: "x2", y1: "y1", y2: "y2", fill: (d) => (known(d.v) ? Colours.css("sequential", share(scale, d.v)) : ink.gone), title: (d) => (d.i < 0 ? "no such case" : `case ${Study.numbers[d.i]}: ${Study.words(d.i)}: ${known(d.v) ? Format.with(d.v, statistic(state).dimension) : "no solution"}`) }),
          Plot.link(pieces, { x1: "x1", x2: "x2", y1: "y1", y2: "y2", stroke: (d) => line(d.level), strokeWidth: 1.2 }),
          Plot.text(labels, { x: "x", y: "y", text: (d) => Format.short(d.level, 6), fill: (d) => line(d.level).replace("0.75", "1"), stroke: (d) => Colours.css("sequential", share(scale, d.level)), strokeWidth: 3, fontSize: 12 }),
          Plot.text(marks, { x: (d) => (d.x1 + d.x2) / 2, y: (d) => (d.y1 + d.y2) / 2, text: "sign", fill: (d) => line(d.v).replace("0.75", "1"), fontSize: 15, fontWeight: 700 }),
          Plot.text(boxes.filter((d) => !known(d.v)), { x: "x", y: "y", text: () => "×", fill: ink.ink, fontSize: 14 }),
          Plot.axisX({ ...axis, ...axisX(state.x, width) }), Plot.axisY({ ...axisAt(margin), label: cut(column(second).label, 13, 200), tickFormat: tick, ticks: y.length <= 12 ? y : 6 })
        ]
      }));
    };
  }
  function map(state, width, ink) {
    const { second, third } = response(state), all = panelLevels(third).map((l) => mapValues(state, second, panelMap(third, l)));
    const scale = scaleFor(all.flat(2).map((c) => c.v));
    return panels(all.map((cells) => mapChart(state, second, cells, scale, ink)), panelTitles(third), [], width, ink, colourBar(axisOf(state), scale, width, ink));
  }
  const canMap = (state) => { const { second } = response(state); return second >= 0 && column(state.x).numeric && column(second).numeric; };

  // ---- response: samples and tables of cases ----
  function dotsOf(state) {
    const every = Math.ceil(Study.count / kMostDots), dots = [];
    for (let i = 0; i < Study.count; i += every) dots.push({ i, x: xOf(state.x, column(state.x).level[i]), y: Study.value(state, i) });
    return { dots, every };
  }
  function scatter(state, width, ink) {
    const { second } = response(state), { dots } = dotsOf(state), there = dots.filter((d) => known(d.y)), c2 = second >= 0 ? column(second) : null;
    const scale = c2 && c2.numeric ? scaleFor(c2.numbers) : null, level = (d) => c2.level[d.i];
    const colour = (d) => (!c2 ? seriesStyle(0, ink).colour : scale ? Colours.css("sequential", share(scale, c2.numbers[level(d)])) : seriesStyle(level(d), ink).colour);
    const domain = domainOf(there.map((d) => d.y));
    const chart = (w) => framed(w, 330, ink, axisX(state.x, w), { label: axisOf(state) }, {
      x: xScale(state.x), y: { domain, nice: true },
      marks: [
        Plot.dot(there, { x: "x", y: "y", r: there.length > 800 ? 1.6 : 2.6, fill: colour, fillOpacity: there.length > 800 ? 0.6 : 0.85, title: (d) => `case ${Study.numbers[d.i]}: ${Study.words(d.i)}: ${Format.with(d.y, statistic(state).dimension)}` }),
        Plot.text(dots.filter((d) => !known(d.y)), { x: "x", y: () => domain[0], text: () => "×", fill: ink.ink, fontSize: 13 })
      ]
    });
    const entries = c2 && !scale ? c2.levels.slice(0, kMostLines).map((name, l) => ({ name: `${c2.name} = ${name}`, box: true, ...seriesStyle(l, ink) })) : [];
    return panels([chart], null, entries, width, ink, scale ? colourBar(c2.name, scale, width, ink) : null);
  }
  const caseTable = (state) => tableOf(state, Array.from({ length: Study.count }, (x, i) => i));

  function responseFigure() {
    return {
      id: "response", title: (s) => statistic(s).title, wide: true,
      build: (s, w, ink) => (!gridded(s) ? scatter : s.kind === "map" && canMap(s) ? map : curve)(s, w, ink),
      table: (s) => (!gridded(s) ? caseTable(s) : curveTable(s)),
      caption: (s) => {
        const { second, third } = response(s), used = [s.x, second, third].filter((k) => k >= 0);
        if (!gridded(s)) return `A dot per case${dotsOf(s).every > 1 ? `, of one case in ${dotsOf(s).every}` : ""}; × on the axis: no solution. ${where(s)}.`;
        const few = (c, most) => (c >= 0 && column(c).shown.length > most ? ` ${most} of ${column(c).shown.length} values of ${column(c).name}.` : "");
        const all = curveTable(s).rows.filter((r) => known(r.at(-1)) && r.at(-1) !== "").sort((p, q) => p.at(-1) - q.at(-1));
        const at = (r) => `${Format.printed(r.at(-1), statistic(s).dimension)} (case ${r[0]}: ${Study.columns.map((c, k) => (used.includes(k) ? `${c.name} = ${r[k + 1]}${c.unit}` : null)).filter(Boolean).join(", ")})`;
        const ends = all.length > 1 ? ` Least ${at(all[0])}, largest ${at(all.at(-1))}.` : "";
        const cut = (s.kind === "map" && canMap(s) ? "" : few(second, kMostLines)) + few(third, kMostPanels);
        const drawn = s.kind === "map" && canMap(s) ? "Each field of the map is a case; lines of equal value are linear between cases; ▽ least, △ largest" : `Each dot is a case${second < 0 && !column(s.x).numeric ? "" : "; lines only join them"}`;
        return `${drawn}; ×: no solution. ${where(s)}${fixedWords(s, used)}.${ends}${cut}${Report.maps ? " A click shows the case in the maps." : ""}`;
      }
    };
  }

  // ---- over the cycle ----
  const bandGroups = (state) => Report.bands.groups.filter((g) => g.column === state.by);
  function cycle(state, width, ink) {
    const t = Report.bands.instants, groups = bandGroups(state), drawn = state.lines, points = [];
    const of = (i) => (state.by < 0 ? 0 : column(state.by).level[i]);
    drawn.places.forEach((i, n) => t.forEach((x, k) => points.push({ n, g: of(i), x, y: drawn.values[n * t.length + k], i })));
    const bands = groups.map((g) => {
      const b = g.bands[state.statistic][state.place];
      return t.map((x, k) => ({ x, low: b.low[k] ?? NaN, high: b.high[k] ?? NaN, mean: b.mean[k] ?? NaN, median: b.median[k] ?? NaN }));
    });
    const label = Report.bands.percent ? "% of the cycle" : Report.time_name, thin = Math.min(0.6, Math.max(0.14, 25 / Math.max(1, drawn.places.length)));
    const chart = (w) => framed(w, 330, ink, { label, ticks: ticksIn(w) }, { label: axisOf(state) }, {
      x: { label, domain: extent(t) }, y: { nice: true, zero: true, domain: domainOf(points.map((p) => p.y)) },
      marks: [
        ...bands.map((b, g) => Plot.areaY(b, { x: "x", y1: "low", y2: "high", fill: seriesStyle(g, ink).colour, fillOpacity: 0.16 })),
        Plot.line(points, { x: "x", y: (p) => (known(p.y) ? p.y : NaN), z: "n", stroke: (p) => seriesStyle(p.g, ink).colour, strokeWidth: 0.8, strokeOpacity: thin, title: (p) => `case ${Study.numbers[p.i]}: ${Study.words(p.i)}` }),
        ...bands.map((b, g) => Plot.line(b, { x: "x", y: "mean", stroke: seriesStyle(g, ink).colour, strokeWidth: 2.6, strokeDasharray: seriesStyle(g, ink).dash })),
        ...(state.by < 0 ? bands : []).map((b, g) => Plot.line(b, { x: "x", y: "median", stroke: seriesStyle(g, ink).colour, strokeWidth: 1.4, strokeDasharray: "4,3" }))
      ]
    });
    const name = (g) => (g.column < 0 ? "mean" : Study.said(column(g.column), g.level));
    const entries = groups.map((g, k) => ({ name: name(g), ...seriesStyle(k, ink) }));
    if (state.by < 0) entries.push({ name: "median", colour: seriesStyle(0, ink).colour, dash: "4,3" });
    return panels([chart], null, entries, width, ink);
  }
  function cycleTable(state) {
    const rows = [];
    for (const g of bandGroups(state)) {
      const b = g.bands[state.statistic][state.place];
      Report.bands.instants.forEach((t, k) => rows.push([g.column < 0 ? "all" : column(g.column).levels[g.level], t, b.count[k], exact(b.mean[k]), exact(b.sd[k]), exact(b.median[k]), exact(b.low[k]), exact(b.high[k])]));
    }
    return { headings: [state.by < 0 ? "cases" : column(state.by).name, Report.bands.percent ? "percent of cycle" : Report.time_name, "count", "mean", "sd", "median", "p5", "p95"], rows };
  }
  const cycleFigure = () => ({
    id: "cycle", title: (s) => `${statistic(s).title} over the cycle`, wide: true, build: cycle, table: cycleTable,
    caption: (s) => `Thick: mean${s.by < 0 ? "; dashed: median" : " of each group"}; band: 5 to 95 % of the cases; thin: ${Report.bands.all ? "each case" : `${s.lines.places.length} of the cases`}. ` +
      `${Report.bands.percent ? "The cases have different times: each cycle is taken from 0 to 100 %, linear between its states. " : ""}A case counts where its state is a solution with contact. ${Report.places[s.place].title}.`
  });

  // ---- distribution of all cases, and of groups ----
  // rows: [{ name, box, dots: [numbers] }]
  function boxes(rows, label, width, ink) {
    const full = rows.map((r, i) => ({ ...r.box, i, y: String(i) })).filter((r) => known(r.median)), colour = (d) => seriesStyle(d.i, ink).colour;
    const dots = rows.flatMap((r, i) => (r.dots || []).filter((d) => known(d.x)).map((d) => ({ ...d, i, y: String(i) })));
    return rowed(width, 66 + 46 * rows.length, ink, {
      names: rows.map((r) => r.name), room: Math.min(190, width * 0.34), padding: 0.42, across: { label, ticks: ticksIn(width, 110) },
      x: { nice: true, domain: domainOf([...full.flatMap((d) => [d.least, d.largest]), ...dots.map((d) => d.x)]) },
      marks: [
        Plot.dot(dots, { x: "x", y: "y", r: 1.6, fill: colour, fillOpacity: 0.35, dy: 14, title: (d) => d.title }),
        ...[["low", "q1"], ["q3", "high"]].map(([x1, x2]) => Plot.link(full, { x1, x2, y1: "y", y2: "y", stroke: colour, strokeWidth: 1.6 })),
        ...boxMarks(full, ["low", "q1", "q3", "high"], colour, ink),
        Plot.dot(full.flatMap((d) => (rows[d.i].box.outliers || []).map(([number, x]) => ({ i: d.i, y: d.y, x, number }))), { x: "x", y: "y", r: 2.4, stroke: colour, fill: "none", title: (d) => `case ${d.number}` })
      ]
    });
  }
  const boxWords = "Box: quartiles, line: median, diamond: mean, whiskers: the last values within 1.5 times the box, rings beyond.";
  const boxCells = (b) => [b.count, b.left_out, exact(b.least), exact(b.q1), exact(b.median), exact(b.q3), exact(b.largest), exact(b.mean), exact(b.sd)];
  const boxHeadings = ["n", "left out", "least", "q1", "median", "q3", "largest", "mean", "sd"];

  function groupRows(state) {
    const g = Report.groups, of = ofState(g.numbers, state);
    return column(g.column).levels.map((name, l) => {
      const dots = [];
      if (Study.count <= 600) for (let i = 0; i < Study.count; ++i) if (column(g.column).level[i] === l) dots.push({ x: Study.value(state, i), title: `case ${Study.numbers[i]}: ${Study.words(i)}` });
      return { name, box: of.boxes[l], dots };
    });
  }
  const groupFigure = () => ({
    id: "groups", title: (s) => `${statistic(s).title} by ${column(Report.groups.column).name}`, wide: true,
    build: (s, w, ink) => boxes(groupRows(s), axisOf(s), w, ink),
    table: (s) => ({ headings: [column(Report.groups.column).name, ...boxHeadings], rows: groupRows(s).map((r) => [r.name, ...boxCells(r.box)]) }),
    caption: (s) => `${boxWords} Small dots: the cases. ${where(s)}.`
  });

  // ---- pairs ----
  const pairNames = () => [Report.pairs.first, Report.pairs.second].map((l) => Study.said(column(Report.pairs.column), l));
  function pairValues(state) {
    return Report.pairs.cases.map(([a, b]) => ({ a, b, first: Study.value(state, a), second: Study.value(state, b) })).filter((p) => known(p.first) && known(p.second));
  }
  function paired(state, width, ink) {
    const p = ofState(Report.pairs.numbers, state), values = pairValues(state), every = Math.ceil(values.length / 300), names = pairNames();
    const drawn = values.filter((x, i) => i % every === 0), boxesOf = [p.first, p.second].map((b, i) => ({ ...b, x: i })).filter((b) => known(b.median));
    const chart = (w) => framed(w, 330, ink, { label: null, ticks: [0, 1], tickFormat: (i) => cut(names[i], 13, w / 2 - 20) }, { label: axisOf(state) }, {
      x: { domain: [-0.45, 1.45], label: null }, y: { nice: true, domain: domainOf(values.flatMap((v) => [v.first, v.second])) },
      marks: [
        Plot.link(drawn, { x1: () => 0, x2: () => 1, y1: "first", y2: "second", stroke: ink.soft, strokeWidth: 0.8, strokeOpacity: Math.max(0.2, Math.min(0.7, 20 / drawn.length)), title: (d) => `cases ${Study.numbers[d.a]} and ${Study.numbers[d.b]}` }),
        Plot.dot(drawn.flatMap((d) => [[0, d.first], [1, d.second]]), { x: (d) => d[0], y: (d) => d[1], r: 2, fill: (d) => seriesStyle(d[0], ink).colour }),
        Plot.rect(boxesOf, { x1: (b) => (b.x ? 1.12 : -0.28), x2: (b) => (b.x ? 1.28 : -0.12), y1: "q1", y2: "q3", fill: (b) => seriesStyle(b.x, ink).colour, fillOpacity: 0.3, stroke: (b) => seriesStyle(b.x, ink).colour }),
        Plot.link(boxesOf, { x1: (b) => (b.x ? 1.1 : -0.3), x2: (b) => (b.x ? 1.3 : -0.1), y1: "median", y2: "median", stroke: (b) => seriesStyle(b.x, ink).colour, strokeWidth: 2.6 })
      ]
    });
    return panels([chart], null, [], width, ink);
  }
  function blandAltman(state, width, ink) {
    const p = ofState(Report.pairs.numbers, state), dots = pairValues(state).map((v) => ({ x: (v.first + v.second) / 2, y: v.first - v.second, ...v }));
    const [least, most] = extent(dots.map((d) => d.x)), ends = [least - 0.05 * (most - least), most + 0.05 * (most - least)], lineAt = [{ y: p.mean, n: "mean" }, { y: p.limits[0], n: "lower" }, { y: p.limits[1], n: "upper" }].filter((l) => known(l.y));
    const bandsAt = [p.interval, p.lower_interval, p.upper_interval].filter((b) => known(b[0]));
    const values = [...dots.map((d) => d.y), ...lineAt.map((l) => l.y), ...bandsAt.flat(), 0], y = extent(values), colour = seriesStyle(0, ink).colour;
    const chart = (w) => framed(w, 330, ink, { label: `mean of both: ${axisOf(state)}`, ticks: 5 }, { label: cut(`${pairNames()[0]} less ${pairNames()[1]}`, 13, 240) }, {
      x: { domain: ends, label: null }, y: { domain: y, nice: true },
      marks: [
        Plot.rect(bandsAt, { x1: () => ends[0], x2: () => ends[1], y1: (b) => b[0], y2: (b) => b[1], fill: colour, fillOpacity: 0.13 }),
        Plot.ruleY([0], { stroke: ink.soft }),
        Plot.ruleY(lineAt.slice(0, 1), { y: "y", stroke: colour, strokeWidth: 2 }), Plot.ruleY(lineAt.slice(1), { y: "y", stroke: colour, strokeWidth: 1.6, strokeDasharray: "5,4" }),
        Plot.dot(dots.slice(0, 5000), { x: "x", y: "y", r: 2.4, fill: ink.ink, fillOpacity: 0.6, title: (d) => `cases ${Study.numbers[d.a]} and ${Study.numbers[d.b]}: ${Format.number(d.y)}` })
      ]
    });
    return panels([chart], null, [], width, ink);
  }
  function pairTable(state) {
    return { headings: ["case", "other case", ...pairNames(), "difference"], rows: pairValues(state).map((v) => [Study.numbers[v.a], Study.numbers[v.b], exact(v.first), exact(v.second), exact(v.first - v.second)]) };
  }
  const pairFigures = () => [
    { id: "pairs", title: (s) => `${statistic(s).title}, in pairs`, build: paired, table: pairTable,
      caption: (s) => `Each line is a pair of cases that ${Report.pairs.by ? `have the same ${Report.pairs.by} and differ in ${column(Report.pairs.column).name}` : `differ in ${column(Report.pairs.column).name} alone`}; boxes: quartiles, thick: median. ${where(s)}.` },
    { id: "bland-altman", title: (s) => `Agreement in ${statistic(s).title.toLowerCase()}`, build: blandAltman, table: pairTable,
      caption: (s) => `Bland and Altman (1986): difference, ${pairNames()[0]} less ${pairNames()[1]}, over the mean of both. Solid: mean; dashed: limits of agreement (mean ∓ 1.96 sd); bands: their 95 % intervals. ${where(s)}.` }];

  // ---- what matters ----
  function influenceRows(state) {
    const of = ofState(Report.influence.numbers, state);
    return [...of.factors].sort((a, b) => Math.max(Math.abs(b.coefficient ?? 0), Math.abs(b.rho ?? 0)) - Math.max(Math.abs(a.coefficient ?? 0), Math.abs(a.rho ?? 0)));
  }
  // A row per factor, two marks in each.
  function factorRows(rows, label, domain, names, marks, width, ink) {
    return rowed(width, 76 + 34 * rows.length, ink, {
      names: rows.map((r) => column(r.column).name), room: Math.min(150, width * 0.3), padding: 0.3, across: { label, ticks: 5 }, lines: 5, x: { domain, label },
      entries: names.map((name, i) => ({ name, colour: seriesStyle(i, ink).colour, box: true })), marks: [Plot.ruleX([0], { stroke: ink.soft }), ...marks]
    });
  }
  function regressionFigure(state, width, ink) {
    const rows = influenceRows(state).map((r, i) => ({ ...r, y: String(i) })), a = seriesStyle(0, ink).colour, b = seriesStyle(1, ink).colour;
    const most = Math.max(1, ...rows.map((r) => Math.abs(r.coefficient ?? 0)));
    return factorRows(rows, "no unit", [-most, most], ["standardised regression", "Spearman"], [
      Plot.link(rows.filter((r) => known(r.coefficient)), { x1: () => 0, x2: "coefficient", y1: "y", y2: "y", stroke: a, strokeWidth: 1.6, dy: -5 }),
      Plot.dot(rows.filter((r) => known(r.coefficient)), { x: "coefficient", y: "y", r: 4.5, fill: a, dy: -5 }),
      Plot.link(rows.filter((r) => known(r.rho)), { x1: () => 0, x2: "rho", y1: "y", y2: "y", stroke: b, strokeWidth: 1.6, dy: 5 }),
      Plot.dot(rows.filter((r) => known(r.rho)), { x: "rho", y: "y", symbol: "diamond", r: 5, fill: b, dy: 5 })], width, ink);
  }
  function sobolFigure(state, width, ink) {
    const rows = ofState(Report.influence.numbers, state).sobol.filter((r) => r.column >= 0).sort((p, q) => (q.total ?? 0) - (p.total ?? 0)).map((r, i) => ({ ...r, y: String(i) }));
    const a = seriesStyle(0, ink).colour, b = seriesStyle(1, ink).colour, all = rows.flatMap((r) => [...r.first_interval, ...r.total_interval, r.first, r.total]).filter(known);
    const domain = [Math.min(0, ...all), Math.max(1, ...all)], bars = (key, colour, dy) => [
      Plot.link(rows.filter((r) => known(r[key + "_interval"][0])), { x1: (r) => r[key + "_interval"][0], x2: (r) => r[key + "_interval"][1], y1: "y", y2: "y", stroke: colour, strokeWidth: 2, dy }),
      Plot.dot(rows.filter((r) => known(r[key])), { x: key, y: "y", r: 4.5, symbol: key === "first" ? "circle" : "diamond", fill: colour, dy })];
    return factorRows(rows, "share of the variance", domain, ["first order", "total"], [...bars("first", a, -6), ...bars("total", b, 6)], width, ink);
  }
  function influenceTable(state) {
    const of = ofState(Report.influence.numbers, state);
    return { headings: ["factor", "standardised regression", "Spearman", "R squared", "cases"], rows: influenceRows(state).map((r) => [column(r.column).name, exact(r.coefficient), exact(r.rho), exact(of.r_squared), of.cases]) };
  }
  function sobolTable(state) {
    const two = (i) => [exact(i[0]), exact(i[1])];
    return { headings: ["factor", "first", "first from", "first to", "total", "total from", "total to", "rows", "left out"],
      rows: ofState(Report.influence.numbers, state).sobol.filter((r) => r.column >= 0).map((r) => [column(r.column).name, exact(r.first), ...two(r.first_interval), exact(r.total), ...two(r.total_interval), r.rows, r.left_out]) };
  }
  function slopeTable(state) {
    const d = statistic(state).dimension, unit = Format.unit(d);
    return { headings: ["factor", "at", `slope${unit ? ` [${unit} per unit]` : ""}`, "difference", "percent per percent"],
      rows: ofState(Report.influence.numbers, state).slopes.map((s) => [column(s.column).name, exact(s.at), exact(s.slope), s.kind, exact(s.relative)]) };
  }
  const influenceFigures = () => {
    const out = [{ id: "regression", title: () => "Regression and rank correlation", build: regressionFigure, table: influenceTable,
      caption: (s) => { const of = ofState(Report.influence.numbers, s); return `Of ${of.cases} cases${of.left_out ? `, ${of.left_out} without a number left out` : ""}; ${of.r_squared == null ? "no regression: the number is the same in all of them but for rounding, or they are too few" : `R² of the regression ${Format.number(of.r_squared, 3)}: ${of.r_squared < 0.7 ? "below 0.7 the coefficients tell little, for the number does not follow straight lines" : "the share of the variance that straight lines have"}`}. Undetermined coefficients are left out. ${statistic(s).title}, ${where(s)}.`; } }];
    if (!Report.influence.no_sobol) out.push({ id: "sobol", title: () => "Sobol indices", build: sobolFigure, table: sobolTable,
      caption: (s) => { const rows = ofState(Report.influence.numbers, s).sobol; return `First order: the share of the variance that goes when this factor alone is fixed; total: the share that stays when all others are. Bars: 95 % of ${Report.influence.resamples} resamples of the design's rows. ${rows[0].rows} rows${rows[0].left_out ? `, ${rows[0].left_out} with a failed case left out` : ""}. ${statistic(s).title}, ${where(s)}.`; } });
    return out;
  };

  // ---- compartments and regions ----
  const siblings = (state) => Report.places.map((p, i) => ({ ...p, i })).filter((p) => p.contact === Report.places[state.place].contact && hasPlace(state.statistic, p.i));
  const placeFigure = () => ({
    id: "places", title: (s) => `${statistic(s).title} by region`, wide: true, when: (s) => siblings(s).length > 1,
    build: (s, w, ink) => boxes(siblings(s).map((p) => ({ name: p.part || "whole", box: Report.summary[s.statistic][p.i][s.choice] })), axisOf(s), w, ink),
    table: (s) => ({ headings: ["region", ...boxHeadings], rows: siblings(s).map((p) => [p.part || "whole", ...boxCells(Report.summary[s.statistic][p.i][s.choice])]) }),
    caption: (s) => `Over the cases. ${boxWords} ${Report.places[s.place].contact}, ${Report.choices[s.choice]}.`
  });

  // ---- dose ----
  const doseUnit = () => `${Report.units.pressure || "pressure"} × ${Report.maps.dose.years ? "years" : Report.maps.dose.cycle_seconds ? "s" : "the model's time"}`;
  function dose(state, width, ink) {
    const d = Report.maps.dose, every = Math.ceil(d.cases.length / 300), points = [], now = state.dosed;
    d.cases.forEach((c, n) => { if (n % every === 0 || c.number === now) d.levels.forEach((x, k) => points.push({ n, x, y: 100 * c.shares[k], number: c.number })); });
    const colour = seriesStyle(0, ink).colour, across = { label: `overpressure above ${Format.short(d.above)} [${doseUnit()}]`, ticks: 5 };
    const chart = (w) => framed(w, 300, ink, across, { label: "share of the area above [%]" }, {
      x: { domain: extent(d.levels), label: null }, y: { domain: [0, Math.max(1e-9, ...points.map((p) => p.y))], nice: true },
      marks: [
        Plot.line(points, { x: "x", y: "y", z: "n", stroke: ink.soft, strokeWidth: 0.8, strokeOpacity: 0.45, title: (p) => `case ${p.number}` }),
        Plot.line(points.filter((p) => p.number === now), { x: "x", y: "y", stroke: colour, strokeWidth: 2.6 })
      ]
    });
    return panels([chart], null, known(now) ? [{ name: `case ${now}, as in the maps`, colour, dash: null }] : [], width, ink);
  }
  const doseFigure = () => ({
    id: "dose", title: () => "Area above a dose", wide: true, build: dose,
    table: () => ({ headings: ["case", "largest overpressure", "mean where above 0", "largest exposure", ...Report.maps.dose.levels.map((l) => `share above ${exact(l)}`)],
      rows: Report.maps.dose.cases.map((c) => [c.number, exact(c.largest), exact(c.mean), exact(c.exposure), ...c.shares.map(exact)]) }),
    caption: () => { const d = Report.maps.dose; return `Overpressure is the integral of p − ${Format.short(d.above)} over the time in which p is above it, linear between states${d.years ? `, of ${Format.short(d.cycles_per_year)} cycles a year in ${Format.short(d.years)} years, each ${d.cycle_seconds ? `${Format.short(d.cycle_seconds)} s long` : "as long as the model's time in seconds"}` : `, of one cycle${d.cycle_seconds ? `, ${Format.short(d.cycle_seconds)} s long` : ""}`}. The threshold is an assumption about cartilage. ${d.left_out ? `${d.left_out} cases lack a state and have no dose.` : ""}`; }
  });

  return { gridded, isInside, hasPlace, responseFigure, cycleFigure, groupFigure, pairFigures, influenceFigures, placeFigure, doseFigure, canMap, response, ofState, statistic, where, column, boxCells, boxHeadings, slopeTable, siblings, doseUnit, exact };
})();
