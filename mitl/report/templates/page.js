"use strict";
/* The page: filters, and in every opened case one time that plots, space, RAPID line, event log, slider and read-out share. */
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const make = (tag, attributes = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), attributes);
    element.append(...children);
    return element;
  };
  const explorers = new Map();

  // --- theme ---------------------------------------------------------------------------------------------------------------------
  const redraw = () => explorers.forEach((explorer) => explorer.redraw());
  const themes = ["auto", "light", "dark"];
  const themeButton = document.getElementById("theme");
  themeButton.addEventListener("click", () => {
    const next = themes[(themes.indexOf(document.documentElement.dataset.theme) + 1) % themes.length];
    document.documentElement.dataset.theme = next;
    themeButton.textContent = `Theme: ${next}`;
    redraw();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

  // --- filters -------------------------------------------------------------------------------------------------------------------
  const articles = all("article[data-outcome]"), rows = all("tr[data-outcome]"), search = document.getElementById("search"), told = document.getElementById("told");
  const buttons = all("button[data-show]");
  function filter() {
    const wanted = buttons.filter((button) => button.getAttribute("aria-pressed") === "true").map((button) => button.dataset.show);
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const shows = (element) => (!wanted.length || wanted.includes(element.dataset.outcome)) && words.every((word) => element.dataset.words.includes(word));
    let count = 0;
    articles.forEach((article) => { article.hidden = !shows(article); count += !article.hidden; });
    rows.forEach((row) => { row.hidden = !shows(row); });
    told.textContent = wanted.length || words.length ? `${count} of ${articles.length} cases shown` : "";
  }
  buttons.forEach((button) => button.addEventListener("click", () => {
    button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
    filter();
  }));
  if (search) search.addEventListener("input", filter);

  // --- opening cases -------------------------------------------------------------------------------------------------------------
  const detailsOf = (article) => article.querySelector("details.case");
  articles.forEach((article) => {
    const details = detailsOf(article);
    details.addEventListener("toggle", () => { if (details.open) explore(article); });
    if (details.open) explore(article);
  });
  all("button[data-open]").forEach((button) => button.addEventListener("click", () => articles.forEach((article) => { if (!article.hidden) detailsOf(article).open = button.dataset.open === "all"; })));
  function follow() {
    const target = location.hash.length > 1 ? document.getElementById(decodeURIComponent(location.hash.slice(1))) : null;
    if (!target || !target.matches("article")) return;
    target.hidden = false;
    detailsOf(target).open = true;
    explore(target);
    target.scrollIntoView();
  }
  addEventListener("hashchange", follow);
  all("a[href^='#case-']").forEach((link) => link.addEventListener("click", () => { if (link.hash === location.hash) follow(); }));

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input, textarea, select")) return;
    if (event.key === "/" && search) { event.preventDefault(); search.focus(); }
    if (event.key !== "j" && event.key !== "k") return;
    const shown = articles.filter((article) => !article.hidden);
    const tops = shown.map((article) => article.getBoundingClientRect().top);
    const next = event.key === "j" ? tops.findIndex((top) => top > 60) : tops.findLastIndex((top) => top < -10);
    if (next >= 0) { shown[next].scrollIntoView(); detailsOf(shown[next]).querySelector("summary").focus({ preventScroll: true }); }
  });

  // --- printing ------------------------------------------------------------------------------------------------------------------
  let closed = [];
  addEventListener("beforeprint", () => {
    document.documentElement.classList.add("printing");
    closed = articles.filter((article) => !article.hidden && !detailsOf(article).open);
    if (articles.length <= 60) closed.forEach((article) => { detailsOf(article).open = true; explore(article); });
    redraw();
  });
  addEventListener("afterprint", () => {
    document.documentElement.classList.remove("printing");
    closed.forEach((article) => { detailsOf(article).open = false; });
    redraw();
  });

  // --- one case ------------------------------------------------------------------------------------------------------------------
  function explore(article) {
    const box = article.querySelector(".explorer");
    if (!box || explorers.has(article)) return;
    explorers.set(article, explorer(box));
  }

  function explorer(box) {
    const data = JSON.parse(document.getElementById(box.dataset.source).textContent);
    for (const run of data.runs) {
      if (run.path) for (const name of Object.keys(run.path)) run.path[name] = mitl.unpack(run.path[name]);
      for (const check of run.checks) { check.t = mitl.unpack(check.t); check.v = mitl.unpack(check.v); }
    }
    const find = (name) => box.querySelector(`.${name}`);
    const charts = find("charts"), slider = find("slider"), readout = find("readout"), play = find("play"), rapid = rapidPanel(find("rapid"), box.dataset.program);
    let run = data.runs[0], overlay = false, plots = null, space = null, span = [0, 1], now = 0, playing = 0, events = null;

    const runBar = find("run-bar");
    if (data.runs.length > 1) {
      const choices = data.runs.map((each, index) => make("button", { type: "button", textContent: each.name || `run ${index + 1}`, onclick: () => choose(each) }));
      const compare = make("button", { type: "button", className: "toggle", textContent: "compare runs", onclick: () => { overlay = !overlay; choose(run); } });
      runBar.append(make("span", { className: "quiet", textContent: "Run" }), ...choices, compare);
      runBar.mark = () => { choices.forEach((button, index) => button.setAttribute("aria-pressed", String(data.runs[index] === run))); compare.setAttribute("aria-pressed", String(overlay)); };
    }
    find("views").addEventListener("click", (event) => {
      const button = event.target.closest("button");
      if (!button || !space) return;
      if (button.dataset.view) space.view(button.dataset.view);
      if (button.dataset.zoom) space.zoomBy(Number(button.dataset.zoom));
      if (button.dataset.gain) {
        space.exaggerate(Number(button.dataset.gain));
        all("button[data-gain]", event.currentTarget).forEach((each) => each.setAttribute("aria-pressed", String(each === button)));
      }
    });
    slider.addEventListener("input", () => setTime(span[0] + (span[1] - span[0]) * slider.value / slider.max));
    play.addEventListener("click", () => (playing ? stop() : start()));
    let width = box.clientWidth;
    new ResizeObserver(() => { if (box.clientWidth && box.clientWidth !== width) { width = box.clientWidth; plots.resize(); if (space) space.resize(); setTime(now); } }).observe(box);
    choose(run);
    return { redraw() { plots.redraw(); if (space) space.redraw(); setTime(now); } };

    function choose(chosen) {
      stop();
      const again = run === chosen && plots;
      run = chosen;
      if (runBar.mark) runBar.mark();
      if (plots) plots.destroy();
      span = mitl.span(run);
      plots = mitl.plots(charts, run, overlay ? data.runs.filter((other) => other !== run) : [], setTime);
      const spaceBox = find("space");
      spaceBox.replaceChildren();
      const drawn = run.path && (run.path.mx.some((v) => v !== null) || run.path.ox.some((v) => v !== null));
      space = drawn ? mitl.space(spaceBox, run, find("scale")) : null;
      events = eventPanel(find("events"), run, setTime);
      setTime(again ? now : worstTime());
    }

    /** Gives the time of the worst value of the first check that is not passed, or else of the first. */
    function worstTime() {
      const check = run.checks.find((each) => each.outcome !== "pass") || run.checks[0];
      if (!check) return span[0];
      let worst = 0;
      check.v.forEach((value, i) => { if (value !== null && Math.abs(value) > Math.abs(check.v[worst] ?? 0)) worst = i; });
      return check.t[worst];
    }

    function setTime(t) {
      now = Math.min(span[1], Math.max(span[0], t));
      plots.setTime(now);
      if (space) space.setTime(now);
      const move = mitl.indexAt(run.moves.map(([time]) => time), now);
      const line = move < 0 ? 0 : run.moves[move][1];
      const text = rapid(line);
      events(now);
      slider.value = Math.round(slider.max * (now - span[0]) / (span[1] - span[0] || 1));
      readout.textContent = `${now.toFixed(3)} s${line ? ` · line ${line}` : ""}`;
      slider.setAttribute("aria-valuetext", `${now.toFixed(2)} seconds${line ? `, RAPID line ${line}: ${text}` : ""}`);
    }

    function start() {
      const from = now >= span[1] - 1e-3 ? span[0] : now, began = performance.now();
      play.textContent = "❚❚"; play.setAttribute("aria-label", "Pause");
      const step = (at) => {
        const t = from + (at - began) / 1000;
        setTime(t);
        if (t >= span[1]) stop(); else playing = requestAnimationFrame(step);
      };
      playing = requestAnimationFrame(step);
    }
    function stop() {
      if (playing) cancelAnimationFrame(playing);
      playing = 0;
      play.textContent = "▶"; play.setAttribute("aria-label", "Play");
    }
  }

  /** Shows a program; gives a function that marks a line, shows it in the middle and gives its text. */
  function rapidPanel(box, program) {
    const source = program === "" ? null : document.getElementById(`program-${program}`);
    if (!source) { box.textContent = "The record holds no program."; return () => ""; }
    const lines = source.textContent.replace(/\n$/, "").split("\n").map((text) => text.replace(/\r$/, ""));
    const elements = lines.map((text) => make("span", { className: "line" }, ...coloured(text), "\n"));
    box.replaceChildren(...elements);
    let marked = null;
    return (number) => {
      const element = elements[number - 1] || null;
      if (element !== marked) {
        if (marked) marked.classList.remove("now");
        if (element) {
          element.classList.add("now");
          box.scrollTop = element.offsetTop - (box.clientHeight - element.offsetHeight) / 2;
          box.scrollLeft = 0;
        }
        marked = element;
      }
      return element ? lines[number - 1].trim() : "";
    };
  }

  /** Gives a line of RAPID as text and coloured spans. */
  function coloured(text) {
    if (text.length > 2000) return [text];
    const parts = text.split(/("(?:[^"]|"")*"|!.*$|\b(?:Move(?:L|J|C|AbsJ)\w*|Trigg\w+|Set\w*|Reset|WaitTime|WaitUntil|WaitDI|Conf[LJ]|SingArea)\b|\b(?:MODULE|ENDMODULE|PROC|ENDPROC|FUNC|ENDFUNC|TRAP|ENDTRAP|RECORD|ENDRECORD|PERS|CONST|VAR|LOCAL|TASK|IF|THEN|ELSEIF|ELSE|ENDIF|TEST|CASE|DEFAULT|ENDTEST|WHILE|DO|ENDWHILE|FOR|FROM|TO|STEP|ENDFOR|RETURN|TRUE|FALSE|AND|OR|NOT|DIV|MOD|ERROR|GOTO)\b)/);
    return parts.filter(Boolean).map((part) => {
      const kind = part[0] === "!" ? "comment" : part[0] === '"' ? "string" : /^(Move|Trigg)/.test(part) ? "motion" : /^[A-Z]+$/.test(part) ? "keyword" : /^(Set|Reset|Wait|Conf|Sing)/.test(part) && parts.length > 1 ? "instruction" : "";
      return kind ? make("span", { className: kind, textContent: part }) : part;
    });
  }

  /** Shows the run's events; gives a function that marks the last one before a time. */
  function eventPanel(box, run, onTime) {
    if (!run.events.length) { box.replaceChildren(make("li", { className: "quiet", textContent: "Nothing was logged during this run." })); return () => {}; }
    const items = run.events.map(([time, level, text, source]) => {
      const button = make("button", { type: "button", onclick: () => onTime(time) }, make("time", { textContent: `${time.toFixed(2)} s` }), make("bdi", { textContent: source ? `${source}: ${text}` : text }));
      return make("li", { className: level }, button);
    });
    box.replaceChildren(...items);
    return (t) => {
      const at = run.events.reduce((found, [time], index) => (time <= t ? index : found), -1);
      items.forEach((item, index) => item.classList.toggle("now", index === at));
    };
  }

  follow();
})();
