"use strict";
/* The path in space, drawn by Zdog on a canvas: oracle, recording coloured by its deviation, and where both are at the cursor's time.
   Robot x, y, z (right-handed, z up) is Zdog's x, -z, -y. */

/** Makes the view in `box`. setTime(t) moves the two points; view(name) turns it; exaggerate(k) draws deviations k times as large. */
mitl.space = function (box, run, scaleText) {
  const canvas = document.createElement("canvas"), labels = ["x", "y", "z"].map((axis) => Object.assign(document.createElement("span"), { className: "axis-label", textContent: axis }));
  canvas.setAttribute("aria-hidden", "true");
  box.append(canvas, ...labels);
  const path = run.path, count = path.t.length;
  const point = (i, of) => (path[`${of}x`][i] === null ? null : [path[`${of}x`][i], path[`${of}y`][i], path[`${of}z`][i]]);
  const oracle = Array.from({ length: count }, (_, i) => point(i, "o")), measured = Array.from({ length: count }, (_, i) => point(i, "m"));
  const all = [...oracle, ...measured].filter(Boolean);
  const low = [0, 1, 2].map((k) => all.reduce((a, p) => Math.min(a, p[k]), Infinity)), high = [0, 1, 2].map((k) => all.reduce((a, p) => Math.max(a, p[k]), -Infinity));
  const middle = low.map((a, k) => (a + high[k]) / 2), size = Math.max(20, Math.hypot(...low.map((a, k) => high[k] - a)));
  const full = run.limit || Math.max(1e-9, ...path.d.filter((d) => d !== null));
  const gain = { value: 1 };
  let illo = null, dots = null, tips = [], now = path.t[0], colours = mitl.palette(), turn = { x: -0.42, y: 0.6 }, zoom = 1;
  build();
  return { setTime, resize: build, redraw() { colours = mitl.palette(); build(); }, view, exaggerate(k) { gain.value = k; build(); }, zoomBy(k) { zoom = Math.min(20, Math.max(0.4, zoom * k)); build(); } };

  function build() {
    const width = box.clientWidth, height = box.clientHeight;
    if (!width || !height) return;
    if (illo) turn = { x: illo.rotate.x, y: illo.rotate.y };
    canvas.style.width = `${width}px`; canvas.style.height = `${height}px`;
    const unit = zoom * 0.9 * Math.min(width, height * 1.25) / size;
    const to = (p) => ({ x: (p[0] - middle[0]) * unit, y: -(p[2] - middle[2]) * unit, z: -(p[1] - middle[1]) * unit });
    if (!illo) {
      illo = new Zdog.Illustration({ element: canvas, rotate: turn, dragRotate: true, onDragMove: draw });
      illo.isTouchAction = false;
    }
    illo.setSize(width, height);
    illo.children.slice().forEach((child) => child.remove());
    floor(to, unit);
    pieces(oracle, () => 0).forEach(([, points]) => shape(points.map(to), colours.oracle, 5, -1));
    const shown = gain.value === 1 ? measured : measured.map((p, i) => (p ? enlarged(p) : null));
    pieces(shown, (i) => shade(path.d[i])).forEach(([kind, points]) => shape(points.map(to), colours[kind], 2.2));
    const start = oracle.find(Boolean) || measured.find(Boolean);
    new Zdog.Ellipse({ addTo: illo, diameter: 11, stroke: 2, color: colours.ink, translate: to(start) });
    dots = { to, shown, o: dot(colours.muted, 11), m: dot(colours.ink, 9) };
    setTime(now);
  }

  function dot(color, stroke) { return layered(new Zdog.Shape({ addTo: illo, stroke, color, visible: false }), 1); }
  function shape(points, color, stroke, layer = 0) { if (points.length > 1) layered(new Zdog.Shape({ addTo: illo, path: points, closed: false, stroke, color }), layer); }
  /** Draws a shape before (-) or after (+) all of layer 0, which is sorted by depth: the recording must not vanish within the wide oracle. */
  function layered(item, layer) {
    if (layer) item.updateSortValue = () => { item.sortValue = layer * 1e9; };
    return item;
  }
  function shade(d) { return d === null ? "measured" : d > full && run.limit ? "bad" : `ok${Math.min(4, Math.floor(5 * d / full))}`; }

  /** Gives [kind, points] of unbroken stretches of one kind; neighbours share their end, so that there is no gap between colours. */
  function pieces(points, kind) {
    const out = [];
    let piece = null;
    points.forEach((p, i) => {
      if (!p) { piece = null; return; }
      const name = kind(i);
      if (piece) piece[1].push(p);
      if (!piece || piece[0] !== name) out.push(piece = [name, [p]]);
    });
    return out;
  }

  /** Gives a recorded point moved away from the nearest oracle point by `gain`. */
  function enlarged(p) {
    let best = null, least = Infinity, before = null;
    for (const o of oracle) {
      if (!o) { before = null; continue; }
      const from = before || o, way = o.map((v, k) => v - from[k]), square = way.reduce((a, v) => a + v * v, 0);
      const share = square ? Math.min(1, Math.max(0, p.reduce((a, v, k) => a + (v - from[k]) * way[k], 0) / square)) : 0;
      const foot = from.map((v, k) => v + share * way[k]), far = p.reduce((a, v, k) => a + (v - foot[k]) ** 2, 0);
      if (far < least) { least = far; best = foot; }
      before = o;
    }
    return best ? p.map((v, k) => best[k] + gain.value * (v - best[k])) : p;
  }

  /** Draws a grid below the path with a round spacing, and the axes at its corner. */
  function floor(to, unit) {
    const raw = size / 6, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= raw);
    const [x0, y0] = [0, 1].map((k) => Math.floor(low[k] / step) * step), [x1, y1] = [0, 1].map((k) => Math.max(Math.ceil(high[k] / step) * step, Math.floor(low[k] / step) * step + step)), z = low[2] - size * 0.04;
    for (let x = x0; x <= x1 + step / 2; x += step) shape([[x, y0, z], [x, y1, z]].map(to), colours.grid, 1, -2);
    for (let y = y0; y <= y1 + step / 2; y += step) shape([[x0, y, z], [x1, y, z]].map(to), colours.grid, 1, -2);
    const corner = [x0, y0, z], length = 46 / unit * Math.min(zoom, 1.5);
    tips = [0, 1, 2].map((k) => {
      const end = corner.map((v, j) => v + (j === k ? length : 0));
      shape([corner, end].map(to), colours.muted, 2);
      return new Zdog.Anchor({ addTo: illo, translate: to(corner.map((v, j) => v + (j === k ? length * 1.22 : 0))) });
    });
    scaleText.textContent = `grid ${step} mm${gain.value === 1 ? "" : `, deviation ×${gain.value}`}`;
  }

  function setTime(t) {
    now = t;
    if (!dots) return;
    const at = Math.max(0, mitl.indexAt(path.t, t));
    for (const [dotted, p] of [[dots.o, oracle[at]], [dots.m, dots.shown[at]]]) {
      dotted.visible = Boolean(p);
      if (p) Object.assign(dotted.translate, dots.to(p));
    }
    draw();
  }

  function draw() {
    illo.updateRenderGraph();
    tips.forEach((tip, k) => { labels[k].style.transform = `translate(${box.clientWidth / 2 + tip.renderOrigin.x}px, ${box.clientHeight / 2 + tip.renderOrigin.y}px) translate(-50%, -50%)`; });
  }

  function view(name) {
    const turns = { oblique: [-0.42, 0.6], top: [-Math.PI / 2, 0], front: [0, Math.PI / 2], side: [0, 0] };
    [illo.rotate.x, illo.rotate.y] = turns[name];
    draw();
  }
};
