"use strict";
/* The trend page: a chart is drawn when its check is opened. */
(() => {
  const { runs, trends, calibration } = JSON.parse(document.getElementById("data").textContent);
  const drawn = [];
  const font = '12px system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';

  function chart(box, x, series, unit) {
    const colours = mitl.palette();
    const legend = document.createElement("p");
    legend.className = "panel-head";
    const value = document.createElement("b"), name = document.createElement("span");
    name.textContent = unit;
    legend.append(name, value);
    box.replaceChildren(legend);
    const axis = { stroke: colours.muted, font, grid: { stroke: colours.grid, width: 1 }, ticks: { show: false } };
    const low = x[0] - 0.5, high = x[x.length - 1] + 0.5;
    const all = series.flatMap((each) => each.v).filter((v) => v !== null), top = Math.max(1e-9, ...all) * 1.1;
    return new uPlot({
      width: box.clientWidth, height: 170, padding: [6, 12, 0, 0], legend: { show: false }, cursor: { y: false, drag: { x: true, y: false } },
      scales: { x: { time: false, range: (u, a, b) => (b - a < 1 ? [low, high] : [Math.max(low, a - 0.5), Math.min(high, b + 0.5)]) }, y: { range: () => [Math.min(0, ...all), top] } },
      axes: [
        { ...axis, size: 26, gap: 3, incrs: [1, 2, 5, 10, 20, 50, 100], space: 110, values: (u, at) => at.map((k) => (Number.isInteger(k) && runs[k] ? runs[k][1].slice(5) : "")) },
        { ...axis, size: 58, gap: 4, values: (u, at) => at.map((v) => `${+v.toFixed(6)}`) },
      ],
      series: [{}, ...series.map((each) => ({ stroke: colours[each.colour], width: each.width ?? 1.5, dash: each.dash, points: { show: Boolean(each.points), size: 7, fill: colours[each.colour] } }))],
      bands: series.some((each) => each.band) ? [{ series: series.map((each, k) => (each.band ? k + 1 : 0)).filter(Boolean), fill: colours.limit.replace(/^rgb\(([^)]*)\)$/, "rgba($1, 0.12)") }] : [],
      hooks: { setCursor: [(u) => {
        const at = u.cursor.idx;
        value.textContent = at === null || at === undefined ? "" : `run ${runs[x[at]][0]}, ${runs[x[at]][1]}, seed ${runs[x[at]][2]}: ${series.filter((each) => each.points).map((each) => mitl.number(each.v[at])).join(", ")}`;
      }] },
    }, [x, ...series.map((each) => each.v)], box);
  }

  function draw(details) {
    const box = details.querySelector(".trend-chart");
    if (!details.open || !box.clientWidth || box.children.length) return;
    const { x, v, limit, guard, unit } = trends[details.dataset.trend];
    const series = [
      { v: limit.map((l, k) => l + guard[k]), colour: "grid", width: 0, band: true }, { v: limit.map((l, k) => l - guard[k]), colour: "grid", width: 0, band: true },
      { v: limit, colour: "limit", dash: [6, 4], width: 1.2 }, { v, colour: "measured", points: true },
    ];
    drawn.push([details, chart(box, x, series, unit)]);
  }

  const articles = [...document.querySelectorAll("article")], search = document.getElementById("search"), only = document.getElementById("only"), told = document.getElementById("told");
  document.querySelectorAll("details[data-trend]").forEach((details) => { details.addEventListener("toggle", () => draw(details)); draw(details); });
  function filter() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    articles.forEach((article) => { article.hidden = !(words.every((word) => article.dataset.words.includes(word)) && (!only.checked || "odd" in article.dataset)); count += !article.hidden; });
    told.textContent = words.length || only.checked ? `${count} of ${articles.length} checks shown` : "";
  }
  search.addEventListener("input", filter);
  only.addEventListener("change", filter);

  const units = ["", "residual of the held-out poses, mm (rms)", "move of the tracker's base since the run before, mm"];
  const all = () => document.querySelectorAll("[data-calibration]").forEach((box) => {
    const column = Number(box.dataset.calibration);
    if (calibration.length) chart(box, calibration.map(([k]) => k), [{ v: calibration.map((row) => row[column]), colour: "measured", points: true }], units[column]);
    else box.textContent = "No run in the history has a calibration.";
  });
  all();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { all(); drawn.splice(0).forEach(([details, u]) => { u.destroy(); details.querySelector(".trend-chart").replaceChildren(); draw(details); }); });
})();
