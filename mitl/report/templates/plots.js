"use strict";
/* The plots of one run, stacked on one time axis, drawn by uPlot. Invariant: setTime moves the cursor of all of them, and nothing is redrawn for it. */
const mitl = {};

/** Gives a packed column (columns.py) as an array of numbers, null for a gap. */
mitl.unpack = function (column) {
  const bytes = Uint8Array.from(atob(column.q), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const out = new Array(bytes.length / 2);
  for (let i = 0; i < out.length; i++) {
    const step = view.getUint16(2 * i, true);
    out[i] = step === 65535 ? null : column.low + column.step * step;
  }
  return out;
};

/** Gives the index of the last time that is not after t, or -1. */
mitl.indexAt = function (times, t) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1; else high = middle;
  }
  return low - 1;
};

/** Gives a number for people. */
mitl.number = function (value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return (Math.abs(value) >= 10 ** digits ? value.toFixed(0) : value === 0 ? "0" : value.toPrecision(digits)).replace("-", "−");
};

/** Gives the theme's colours, resolved, because a canvas knows no CSS variables. */
mitl.palette = function () {
  const probe = document.createElement("i");
  document.body.append(probe);
  const names = ["ink", "muted", "grid", "oracle", "measured", "limit", "card", "signal", "fail", "ok0", "ok1", "ok2", "ok3", "ok4", "bad"];
  const found = Object.fromEntries(names.map((name) => [name, (probe.style.color = `var(--${name})`, getComputedStyle(probe).color)]));
  probe.remove();
  return found;
};

/** Gives what the stack shows of a run, a panel each. others: further runs to show faintly, for the comparison from run to run. */
mitl.panelsOf = function (run, others) {
  const panels = run.checks.slice(0, 5).map((check) => ({
    name: check.name, unit: check.unit, limit: check.limit, guard: check.guard, atLeast: check.atLeast, fill: true,
    lines: [{ t: check.t, v: check.v, colour: "measured", width: 1.5, main: true }],
  }));
  const path = run.path;
  const has = (name) => path && path[name].some((value) => value !== null);
  const faint = (name) => others.filter((other) => other.path && other.path[name].some((v) => v !== null))
    .map((other) => ({ t: other.path.t, v: other.path[name], colour: "muted", width: 0.8 }));
  if (has("d") && (others.length || !run.checks.some((check) => check.unit === "mm")))
    panels.push({ name: "distance from the oracle's path", unit: "mm", limit: run.limit, guard: 0, fill: true,
      lines: [...faint("d"), { t: path.t, v: path.d, colour: "measured", width: 1.5, main: true }] });
  if (has("sm") || has("so")) {
    const lines = faint("sm");
    if (has("so")) lines.push({ t: path.t, v: path.so, colour: "oracle", width: 4, label: "oracle" });
    if (has("sm")) lines.push({ t: path.t, v: path.sm, colour: "measured", width: 1.3, main: true, label: "recorded" });
    if (!has("sm")) lines[lines.length - 1].main = true;
    panels.push({ name: "speed", unit: "mm/s", lines });
  }
  if (run.signals.length) panels.push(signalPanel(run));
  return panels;

  function signalPanel(of) {
    const end = mitl.span(of)[1];
    const shown = of.signals.slice(0, 8);
    const top = shown.map((signal) => Math.max(1, ...signal.at.map(([, value]) => Math.abs(value))));
    const lines = shown.map((signal, row) => {
      const t = signal.at.map(([time]) => time), v = signal.at.map(([, value]) => shown.length - 1 - row + 0.7 * value / top[row]);
      if (t.length && t[t.length - 1] < end) { t.push(end); v.push(v[v.length - 1]); }
      return { t, v, colour: "signal", width: 1.6, stepped: true };
    });
    return { name: "outputs that the oracle expects", unit: "", lines, signals: shown };
  }
};

/** Gives the first and last time of a run. */
mitl.span = function (run) {
  const times = [...(run.path ? [run.path.t] : []), ...run.checks.map((check) => check.t)].filter((t) => t.length);
  if (!times.length) return [0, 1];
  return [Math.min(...times.map((t) => t[0])), Math.max(...times.map((t) => t[t.length - 1]))];
};

/** Makes the stack in `box`. onTime(t) is called where the pointer asks for a time. */
mitl.plots = function (box, run, others, onTime) {
  const panels = mitl.panelsOf(run, others);
  const [first, last] = mitl.span(run);
  let colours = mitl.palette(), charts = [], now = first;
  const key = `sync-${mitl.plots.count = (mitl.plots.count || 0) + 1}`;
  build();
  return { setTime, resize: rebuild, redraw() { colours = mitl.palette(); rebuild(); }, destroy, count: panels.length };

  function destroy() { for (const chart of charts) chart.u.destroy(); charts = []; box.replaceChildren(); }
  function rebuild() { destroy(); build(); setTime(now); }

  function build() {
    const head = 24, bottom = 26;
    const height = Math.max(64, Math.floor((box.clientHeight - bottom) / Math.max(1, panels.length)) - head);
    panels.forEach((panel, index) => {
      const isLast = index === panels.length - 1;
      const holder = document.createElement("div"), title = document.createElement("div"), value = document.createElement("b");
      title.className = "panel-head";
      const name = document.createElement("bdi");
      name.textContent = panel.unit ? `${panel.name}, ${panel.unit}` : panel.name;
      title.append(name, value);
      holder.append(title);
      box.append(holder);
      const tables = panel.lines.map((line) => [line.t, line.v]);
      const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
      const u = new uPlot(options(panel, box.clientWidth, height + (isLast ? bottom : 0), isLast), data, holder);
      const playhead = document.createElement("div");
      playhead.className = "playhead";
      u.over.append(playhead);
      charts.push({ u, panel, playhead, value });
    });
  }

  function options(panel, width, height, isLast) {
    const font = '12px system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';
    const axis = { stroke: colours.muted, font, grid: { stroke: colours.grid, width: 1 }, ticks: { show: false } };
    return {
      width, height, padding: [4, 12, 0, 0], legend: { show: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: false }, sync: { key, setSeries: false } },
      scales: { x: { time: false, range: (u, low, high) => (low === high ? [low, low + 1] : [low, high]), min: first, max: last },
        y: { range: (u, low, high) => yRange(panel, low, high) } },
      axes: [
        { ...axis, size: isLast ? 26 : 4, gap: 3, values: isLast ? (u, ticks) => ticks.map((t) => `${+t.toFixed(3)} s`) : (u, ticks) => ticks.map(() => "") },
        { ...axis, size: 58, gap: 4, space: 26, ...(panel.signals ? rowNames(panel) : { values: (u, ticks) => ticks.map((v) => `${+v.toFixed(6)}`) }) },
      ],
      series: [{}, ...panel.lines.map((line) => ({
        stroke: line.main && panel.limit !== undefined && panel.limit !== null ? (u) => beyond(u, panel, colours[line.colour]) : colours[line.colour],
        width: line.width, points: { show: false }, spanGaps: false,
        paths: line.stepped ? uPlot.paths.stepped({ align: 1 }) : undefined,
        fill: line.main && panel.fill ? faded(colours.measured, 0.09) : undefined,
      }))],
      hooks: {
        drawAxes: [(u) => drawLimit(u, panel)],
        setScale: [(u, scale) => { if (scale === "x") place(); }],
        setCursor: [(u) => { if (u.cursor.event && u.cursor.left >= 0) onTime(u.posToVal(u.cursor.left, "x")); }],
      },
    };
  }

  function yRange(panel, low, high) {
    if (panel.signals) return [-0.25, panel.signals.length - 0.05];
    if (low === null || high === null) return [0, 1];
    const edge = panel.limit === undefined || panel.limit === null ? 0 : panel.limit + panel.guard;
    const top = Math.max(high, edge, 1e-9), base = low < 0 ? Math.min(low, -edge) : 0;
    return [base * 1.08, top * 1.1];
  }

  function rowNames(panel) {
    const names = panel.signals.map((signal) => signal.name), count = names.length;
    return { splits: () => names.map((_, row) => count - 1 - row + 0.35), values: () => names.map((name) => (name.length > 9 ? `${name.slice(0, 8)}…` : name)), grid: { show: false } };
  }

  function faded(colour, share) { return colour.replace(/^rgb\(([^)]*)\)$/, (_, parts) => `rgba(${parts}, ${share})`); }

  /** Gives a stroke that is the limit's colour where the value is beyond the limit. */
  function beyond(u, panel, colour) {
    const y = u.valToPos(panel.limit, "y", true), top = u.bbox.top, height = u.bbox.height;
    const share = Math.min(1, Math.max(0, (y - top) / height));
    if (!Number.isFinite(share)) return colour;
    const gradient = u.ctx.createLinearGradient(0, top, 0, top + height);
    const [above, below] = panel.atLeast ? [colour, colours.fail] : [colours.fail, colour];
    gradient.addColorStop(0, above); gradient.addColorStop(share, above); gradient.addColorStop(share, below); gradient.addColorStop(1, below);
    return gradient;
  }

  function drawLimit(u, panel) {
    if (panel.limit === undefined || panel.limit === null || panel.signals) return;
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
    for (const level of u.scales.y.min < 0 && !panel.atLeast ? [panel.limit, -panel.limit] : [panel.limit]) {
      const y = u.valToPos(level, "y", true);
      if (panel.guard > 0) {
        const high = u.valToPos(level + panel.guard, "y", true), low = u.valToPos(level - panel.guard, "y", true);
        ctx.fillStyle = faded(colours.limit, 0.13);
        ctx.fillRect(bbox.left, high, bbox.width, low - high);
      }
      ctx.strokeStyle = colours.limit; ctx.lineWidth = 1.3 * devicePixelRatio; ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
      ctx.beginPath(); ctx.moveTo(bbox.left, y); ctx.lineTo(bbox.left + bbox.width, y); ctx.stroke();
    }
    ctx.restore();
  }

  function setTime(t) {
    now = t;
    for (const { panel, value } of charts) {
      const main = panel.lines.find((line) => line.main);
      if (panel.signals) value.textContent = panel.signals.map((signal) => { const at = mitl.indexAt(signal.at.map(([time]) => time), t); return `${signal.name} ${at < 0 ? "–" : mitl.number(signal.at[at][1])}`; }).join("  ");
      else if (main) {
        const at = mitl.indexAt(main.t, t), outside = at < 0 || t > main.t[main.t.length - 1] + 0.05;
        value.textContent = outside ? "" : `${mitl.number(main.v[at])} ${panel.unit}`;
      }
    }
    place();
  }

  function place() {
    for (const { u, playhead } of charts) {
      const x = u.valToPos(now, "x");
      playhead.style.transform = `translateX(${x}px)`;
      playhead.hidden = !(x >= -0.5 && x <= u.over.clientWidth + 0.5);
    }
  }
};
