"use strict";
/* The replay: three.js draws robot, oracle and recording; one time moves them, the RAPID line and the read-outs. Without WebGL it draws by SVG. */
(() => {
  const { takes, robots, programs } = JSON.parse(document.getElementById("data").textContent);
  const get = (id) => document.getElementById(id);
  const stage = get("stage"), slider = get("slider"), play = get("play"), choice = get("take");
  let colours = mitl.palette();
  const webgl = Boolean(document.createElement("canvas").getContext("webgl2"));
  const renderer = webgl ? new THREE.WebGLRenderer({ antialias: true, alpha: true }) : new THREE.SVGRenderer();
  if (webgl) renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  else renderer.setClearColor(new THREE.Color(0xffffff), 0);
  stage.append(renderer.domElement);
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, stage);
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(1.5, -2, 3);
  scene.add(sun, new THREE.HemisphereLight(0xffffff, 0x8090a0, 1.5));
  let take = null, drawn = null, now = 0, span = [0, 1], playing = 0, wanted = false, showRobot = true, lines = [];

  controls.addEventListener("change", render);
  new ResizeObserver(resize).observe(stage);
  takes.forEach((each, index) => choice.append(new Option(each.title, index)));
  choice.disabled = takes.length < 2;
  choice.addEventListener("change", () => choose(takes[choice.value]));
  slider.addEventListener("input", () => { stop(); setTime(span[0] + (span[1] - span[0]) * slider.value / slider.max); });
  play.addEventListener("click", () => (playing ? stop() : start()));
  document.querySelectorAll("button[data-view]").forEach((button) => button.addEventListener("click", () => look(button.dataset.view)));
  get("robot").addEventListener("click", (event) => { showRobot = !showRobot; event.target.setAttribute("aria-pressed", String(showRobot)); if (drawn.robot) drawn.robot.root.visible = showRobot; render(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { colours = mitl.palette(); const t = now; choose(take, false); setTime(t); });
  stage.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08] }[event.key];
    if (turn) orbit(turn[0], turn[1], 1);
    else if (event.key === "+") orbit(0, 0, 0.85);
    else if (event.key === "-") orbit(0, 0, 1.18);
    else if (event.key === " ") (playing ? stop : start)();
    else return;
    event.preventDefault();
  });
  choose(takes.find((each) => each.key && `#${each.key}` === location.hash) || takes[0]);

  function choose(chosen, move = true) {
    stop();
    take = chosen;
    choice.value = takes.indexOf(take);
    if (!take.c) take.c = Object.fromEntries(Object.entries(take.columns).map(([name, column]) => [name, mitl.unpack(column)]));
    if (drawn) scene.remove(drawn.root);
    drawn = draw();
    scene.add(drawn.root);
    span = [take.c.t[0], take.c.t[take.c.t.length - 1]];
    get("robot").hidden = !drawn.robot;
    get("limit").textContent = take.limit ? `${mitl.number(take.limit)} mm` : `${mitl.number(drawn.full)} mm`;
    document.querySelectorAll(".recorded").forEach((element) => { element.hidden = take.c.mx.every((v) => v === null); });
    get("signals-box").hidden = !take.signals.length;
    program(take.program === null ? null : programs[take.program]);
    if (move) look("oblique");
    setTime(span[0]);
  }

  // --- what stands in space ------------------------------------------------------------------------------------------------------
  function draw() {
    const root = new THREE.Group(), c = take.c;
    const points = (of) => c.t.map((_, i) => (c[`${of}x`][i] === null ? null : [c[`${of}x`][i], c[`${of}y`][i], c[`${of}z`][i]]));
    const measured = points("m"), oracle = points("o");
    const found = c.d.filter((d) => d !== null);
    const full = take.limit || (found.length ? found.reduce((a, d) => Math.max(a, d), 1e-6) : 1);
    const shade = (i) => { const d = c.d[i]; return d === null ? "measured" : take.limit && d > full ? "bad" : `ok${Math.min(4, Math.floor(5 * d / full))}`; };
    const box = new THREE.Box3();
    [...measured, ...oracle].forEach((p) => { if (p) box.expandByPoint(new THREE.Vector3(...p)); });
    pieces(oracle, () => "oracle").forEach(([, p]) => root.add(line(p, colours.oracle, 7, -1)));
    for (const [kind, pairs] of segments(measured, shade)) root.add(line(pairs, colours[kind], 3, 0, true));
    const size = Math.max(0.02, box.getSize(new THREE.Vector3()).length());
    const dots = { o: ball(colours.muted, size * 0.012), m: ball(colours.ink, size * 0.014) };
    root.add(dots.o, dots.m);
    const shape = take.robot ? robots[take.robot] : null;
    const robot = shape ? build(shape) : null;
    if (robot) root.add(robot.root);
    const reach = robot ? 1 : Math.max(0.2, Math.ceil(size * 10) / 10), floor = grid(reach, reach / 10);
    const middle = box.getCenter(new THREE.Vector3());
    if (!robot) floor.position.set(middle.x, middle.y, box.min.z - 0.03 * size);
    root.add(floor);
    if (take.object) { const frame = axes(0.12); place(frame, take.object); root.add(frame); }
    return { root, robot, dots, measured, oracle, box, size, middle, full };
  }

  function pieces(points, kind) {
    const out = [];
    let piece = null;
    points.forEach((p, i) => {
      if (!p) { piece = null; return; }
      const name = kind(i);
      if (piece) piece[1].push(p);
      if (!piece || piece[0] !== name) out.push(piece = [name, [p]]);
    });
    return out.filter(([, p]) => p.length > 1);
  }

  /** Gives for every kind the ends of its segments in a row, so that a recording is a handful of objects however often its colour changes. */
  function segments(points, kind) {
    const found = new Map();
    for (const [name, piece] of pieces(points, kind)) {
      if (!found.has(name)) found.set(name, []);
      for (let i = 1; i < piece.length; i++) found.get(name).push(piece[i - 1], piece[i]);
    }
    return found;
  }

  /** Gives a line through points, or segments between pairs of them; one with a negative order is drawn first and hides nothing, so that the recording is seen on the wide oracle. */
  function line(points, colour, width, order = 0, paired = false) {
    if (webgl) {
      const material = new THREE.LineMaterial({ color: new THREE.Color(colour).getHex(), linewidth: width, depthWrite: order >= 0 });
      const geometry = new THREE.LineGeometry();
      if (paired) Object.getPrototypeOf(THREE.LineGeometry.prototype).setPositions.call(geometry, points.flat()); // as LineSegmentsGeometry takes them
      else geometry.setPositions(points.flat());
      return Object.assign(new THREE.Line2(geometry, material), { renderOrder: order });
    }
    const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
    const kind = paired ? THREE.LineSegments : THREE.Line;
    return Object.assign(new kind(geometry, new THREE.LineBasicMaterial({ color: colour, linewidth: width })), { renderOrder: order });
  }
  function ball(colour, radius) { return new THREE.Mesh(new THREE.SphereGeometry(radius, webgl ? 24 : 8, webgl ? 16 : 6), new THREE.MeshBasicMaterial({ color: colour })); }
  function grid(reach, step) {
    const group = new THREE.Group(), lines = { fine: [], middle: [] };
    for (let k = -10; k <= 10; k++) (k ? lines.fine : lines.middle).push([k * step, -reach, 0], [k * step, reach, 0], [-reach, k * step, 0], [reach, k * step, 0]);
    for (const [points, colour] of [[lines.fine, colours.grid], [lines.middle, colours.oracle]]) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
      group.add(Object.assign(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour, linewidth: 1 })), { renderOrder: -2 }));
    }
    return group;
  }
  function axes(length) {
    const group = new THREE.Group();
    [["#d43a2f", [length, 0, 0]], ["#2f9e44", [0, length, 0]], ["#2f6fd4", [0, 0, length]]].forEach(([colour, end]) => group.add(line([[0, 0, 0], end], colour, 3)));
    return group;
  }
  function place(object, [x, y, z, qx, qy, qz, qw]) { object.position.set(x, y, z); object.quaternion.set(qx, qy, qz, qw); }

  function build(shape) {
    const root = new THREE.Group(), joints = [];
    let at = root;
    for (const link of shape) {
      const fixed = new THREE.Group(), turning = new THREE.Group();
      place(fixed, link.origin);
      at.add(fixed);
      fixed.add(turning);
      if (link.axis) joints.push({ group: turning, axis: new THREE.Vector3(...link.axis).normalize() });
      for (const visual of link.visuals) {
        const [a, b] = visual.size, round = webgl ? 40 : 12;
        const geometry = visual.kind === "box" ? new THREE.BoxGeometry(...visual.size) : visual.kind === "cylinder" ? new THREE.CylinderGeometry(a, a, b, round).rotateX(Math.PI / 2) : new THREE.SphereGeometry(a, round, round / 2);
        const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: new THREE.Color().setRGB(...visual.colour, "srgb") }));
        place(mesh, visual.origin);
        turning.add(mesh);
      }
      at = turning;
    }
    if (take.tool) {
      const end = new THREE.Vector3(...take.tool), length = end.length();
      if (length > 1e-3) {
        const tool = new THREE.Mesh(new THREE.CylinderGeometry(0.002, 0.012, length, webgl ? 24 : 8), new THREE.MeshLambertMaterial({ color: colours.signal }));
        tool.position.copy(end).multiplyScalar(0.5);
        tool.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), end.clone().normalize());
        at.add(tool);
      }
    }
    return { root, joints };
  }

  // --- time ----------------------------------------------------------------------------------------------------------------------
  function setTime(t) {
    now = Math.min(span[1], Math.max(span[0], t));
    const c = take.c, at = Math.max(0, mitl.indexAt(c.t, now)), next = Math.min(at + 1, c.t.length - 1);
    const share = next > at ? (now - c.t[at]) / (c.t[next] - c.t[at]) : 0;
    const between = (a, b) => (a === null ? b : b === null ? a : a + share * (b - a));
    for (const [name, points] of [["o", drawn.oracle], ["m", drawn.measured]]) {
      const dot = drawn.dots[name], p = points[at], q = points[next] || p;
      dot.visible = Boolean(p);
      if (p) dot.position.set(...p.map((v, k) => between(v, q[k])));
    }
    if (drawn.robot) drawn.robot.joints.forEach(({ group, axis }, k) => group.quaternion.setFromAxisAngle(axis, between(c[`j${k + 1}`][at], c[`j${k + 1}`][next]) || 0));
    const p = drawn.measured[at] || drawn.oracle[at];
    get("time").textContent = `${now.toFixed(3)} s`;
    get("distance").textContent = c.d[at] === null ? "–" : `${mitl.number(between(c.d[at], c.d[next]))} mm`;
    get("tcp").textContent = p ? p.map((v) => (1000 * v).toFixed(1).replace("-", "−")).join("  ") : "–";
    get("signals").textContent = take.signals.map(({ name, at: changes }) => { const k = mitl.indexAt(changes.map(([time]) => time), now); return `${name} ${k < 0 ? "–" : mitl.number(changes[k][1])}`; }).join(", ");
    const move = mitl.indexAt(take.moves.map(([time]) => time), now), number = move < 0 ? 0 : take.moves[move][1];
    const text = mark(number);
    const said = take.events.filter(([time]) => time <= now && time > now - 3).pop();
    const words = said ? `${said[0].toFixed(2)} s  ${said[3] ? `${said[3]}: ` : ""}${said[2]}` : "";
    if (get("event").textContent !== words) get("event").textContent = words;
    slider.value = Math.round(slider.max * (now - span[0]) / (span[1] - span[0] || 1));
    slider.setAttribute("aria-valuetext", `${now.toFixed(2)} seconds${number ? `, RAPID line ${number}: ${text}` : ""}`);
    render();
  }
  function start() {
    const from = now >= span[1] - 1e-3 ? span[0] : now;
    let began = performance.now(), base = from, speed = Number(get("speed").value);
    play.textContent = "❚❚"; play.setAttribute("aria-label", "Pause");
    const step = (at) => {
      const chosen = Number(get("speed").value);
      if (chosen !== speed) { base = now; began = at; speed = chosen; }
      const t = base + speed * (at - began) / 1000;
      setTime(t);
      if (t >= span[1]) stop(); else playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  }
  function stop() { cancelAnimationFrame(playing); playing = 0; play.textContent = "▶"; play.setAttribute("aria-label", "Play"); }

  // --- the program ---------------------------------------------------------------------------------------------------------------
  function program(source) {
    const box = get("rapid");
    box.hidden = source === null;
    lines = (source || "").split(/\r\n|\r|\n/).map((text, index) => Object.assign(document.createElement("span"), { textContent: text.slice(0, 500) }));
    lines.forEach((element, index) => { element.dataset.line = index + 1; });
    box.replaceChildren(...lines);
  }
  function mark(number) {
    const box = get("rapid"), element = lines[number - 1], before = box.querySelector(".now");
    if (before === (element || null)) return element ? element.textContent.trim() : "";
    if (before) before.classList.remove("now");
    if (!element) return "";
    element.classList.add("now");
    box.scrollTop = element.offsetTop - (box.clientHeight - element.offsetHeight) / 2;
    return element.textContent.trim();
  }

  // --- the view ------------------------------------------------------------------------------------------------------------------
  function look(name) {
    const robot = drawn.robot && name !== "path";
    const target = robot ? new THREE.Vector3(drawn.middle.x * 0.6, drawn.middle.y * 0.6, Math.max(0.3, drawn.middle.z * 0.72)) : drawn.middle.clone();
    const far = robot ? 1.45 + drawn.size : Math.max(0.15, 1.55 * drawn.size);
    const way = { oblique: [0.85, -1, 0.62], top: [0, -0.001, 1.4], front: [1.4, 0, 0.05], side: [0, -1.4, 0.05], path: [0.85, -1, 0.62] }[name];
    camera.position.copy(target).add(new THREE.Vector3(...way).multiplyScalar(far / Math.hypot(...way) * Math.max(1, 1.25 / camera.aspect)));
    controls.target.copy(target);
    controls.update();
    render();
  }
  function orbit(turn, lift, nearer) {
    const offset = camera.position.clone().sub(controls.target).applyAxisAngle(new THREE.Vector3(0, 0, 1), turn);
    const side = new THREE.Vector3(0, 0, 1).cross(offset).normalize();
    camera.position.copy(controls.target).add(offset.applyAxisAngle(side, -lift).multiplyScalar(nearer));
    controls.update();
    render();
  }
  function resize() {
    const width = stage.clientWidth, height = stage.clientHeight;
    if (!width || !height) return;
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    render();
  }
  function render() {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(() => { wanted = false; renderer.render(scene, camera); });
  }
})();
