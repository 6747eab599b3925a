"use strict";
// Signals over time: one run at a time, every channel with its residual, one time axis and one cursor for all.
(() => {
  const { make, number, colour, themed, view } = Windfall;
  const SIDES = ["measured", "before", "after"];
  /** Pixels a bucket while the view moves, and how long it rests before all is drawn, ms: without a graphics card wide lines take most of a
   *  frame (70 ms for 18 plots; hairlines of a quarter of the points 12 ms). */
  const COARSE_PX = 4;
  const REST_MS = 250;
  /** Time of a frame that drawing may take, ms (as much again goes into putting it on the screen), and plots that are drawn whatever it takes. */
  const FRAME_MS = 4;
  const LEAST = 6;
  /** Height of a channel with its residual, about. */
  const HEIGHT_PX = 330;
  /** A constant line. */
  const level = (y) => ({ level: y });

  /** Series between two times, at most so many points: of each of `buckets` spans the least and the largest value, in their order.
   *  A series is an array, or a difference of two; it ends where it ends. */
  function reduced(t, series, [a, b], buckets) {
    let from = 0;
    let to = t.length;
    // One sample beyond each end, so that lines run to the edge.
    for (let lo = 0, hi = t.length; lo < hi;) { const m = (lo + hi) >> 1; if (t[m] < a) lo = m + 1; else hi = m; from = Math.max(0, lo - 1); }
    for (let lo = 0, hi = t.length; lo < hi;) { const m = (lo + hi) >> 1; if (t[m] <= b) lo = m + 1; else hi = m; to = Math.min(t.length, lo + 1); }
    const per = Math.max(1, Math.ceil((to - from) / buckets));
    const n = per > 2 ? 2 * Math.ceil((to - from) / per) : to - from;
    const x = new Float64Array(n);
    for (let k = 0; k < n; k += 1) {
      const at = per > 2 ? from + (k >> 1) * per + (k & 1 ? per >> 1 : 0) : from + k;
      x[k] = t[Math.min(to - 1, at)];
      if (k && x[k] <= x[k - 1]) x[k] = x[k - 1] + 1e-9;
    }
    return [x, ...series.map((s) => one(s, from, to, per, n))];
  }
  function one(s, from, to, per, n) {
    if (s.level !== undefined) return new Float64Array(n).fill(s.level);
    const { of, less } = s;
    const end = Math.min(to, less ? Math.min(of.length, less.length) : of.length);
    const y = new Array(n).fill(null);
    if (per <= 2) {
      for (let i = from; i < end; i += 1) y[i - from] = less ? of[i] - less[i] : of[i];
      return y;
    }
    for (let k = 0, i = from; i < end; k += 2) {
      let [low, high, first] = [Infinity, -Infinity, true];
      for (const stop = Math.min(end, i + per); i < stop; i += 1) {
        const v = less ? of[i] - less[i] : of[i];
        if (v < low) { low = v; first = false; }
        if (v > high) { high = v; first = true; }
      }
      // `first`: the largest came last.
      y[k] = first ? low : high;
      y[k + 1] = first ? high : low;
    }
    return y;
  }

  /** A series of another clock at these times, on straight lines between its samples; it ends where it ends. */
  function onto(t, from, y) {
    const n = Math.min(from.length, y.length);
    const at = new Float32Array(t.length);
    let [k, count] = [0, 0];
    for (; count < t.length && n > 1 && t[count] <= from[n - 1]; count += 1) {
      while (k < n - 2 && from[k + 1] < t[count]) k += 1;
      at[count] = y[k] + ((y[k + 1] - y[k]) * (t[count] - from[k])) / (from[k + 1] - from[k]);
    }
    return at.subarray(0, count);
  }

  /** Range of ordinates: that of what is shown of the run's interior, where it has one; else of all that is shown. */
  const inside = (interior) => (u, least, most) => {
    let [low, high] = [Infinity, -Infinity];
    const [x, ...all] = u.data;
    for (let i = 0; interior && i < x.length; i += 1) {
      // Before the first drawing the span has no ends yet.
      if (x[i] < Math.max(interior[0], u.scales.x.min ?? -Infinity) || x[i] > Math.min(interior[1], u.scales.x.max ?? Infinity)) continue;
      for (const y of all) if (y[i] != null) { low = Math.min(low, y[i]); high = Math.max(high, y[i]); }
    }
    return low > high ? uPlot.rangeNum(least ?? 0, most ?? 1, 0.1, true) : uPlot.rangeNum(low, high, 0.1, true);
  };

  Windfall.Tracks = class {
    constructor(place, tracks) {
      Object.assign(this, { place, tracks, plots: [], range: null, t: 0, listeners: [], busy: false, last: -1 });
      const asked = view.read();
      const mine = asked.of === tracks.id ? asked : {};
      const held = tracks.runs.findIndex((r) => r.use === "hold-out");
      const named = tracks.runs.findIndex((r) => r.name === mine.run);
      this.run = named >= 0 ? named : Math.max(0, held);
      const names = tracks.runs[0].channels.map((c) => c.name);
      // Of a body in free flight all are shown: its rates and incidence are what its model is about.
      const first = tracks.body.free ? names : names.filter((n) => !["p", "q", "r", "airspeed", "tether pull"].includes(n));
      const shown = (mine.ch || "").split(",").filter((n) => names.includes(n));
      this.shown = new Set(shown.length ? shown : first);
      this.beside = tracks.runs.findIndex((r) => r.name === mine.with);
      if (this.beside === this.run) this.beside = -1;
      if (mine.x) this.range = mine.x.split("_").map(Number).slice(0, 2);
      if (this.range && !(this.range[1] > this.range[0])) this.range = null;
      if (mine.t) this.t = Number(mine.t) || 0;
      this.spectra = mine.as === "spectra";
      this.controls(names);
      const still = document.querySelector(`[data-still="${tracks.id}"]`);
      if (still) still.hidden = true;
      // Plots of a view that nobody has come near are not made: a page has hundreds of thousands of samples.
      this.grid.style.minHeight = `${HEIGHT_PX * Math.ceil(this.shown.size / Math.max(1, Math.floor(place.clientWidth / 440)))}px`;
      const near = new IntersectionObserver((all) => { if (all.some((e) => e.isIntersecting)) this.make(); }, { rootMargin: "600px" });
      near.observe(place);
      this.near = near;
      // To ask each plot for its place would lay the page out again between every two of them.
      this.sight = new IntersectionObserver((all) => all.forEach((e) => { e.target.plot.seen = e.isIntersecting; }));
      themed.push(() => this.draw());
      let last = innerWidth;
      let timer = 0;
      addEventListener("resize", () => {
        clearTimeout(timer);
        timer = setTimeout(() => { if (innerWidth !== last) { last = innerWidth; this.draw(); } }, 200);
      });
    }
    side(name) { return name === "measured" ? "measured" : this.tracks[name]; }
    controls(names) {
      const { tracks } = this;
      const options = tracks.runs.map((r, i) => make("option", { value: i, selected: i === this.run }, `${r.name} (${r.use})`));
      const pick = make("select", { "aria-label": "Run", onchange: (e) => this.choose(Number(e.target.value)) }, ...options);
      this.pick = pick;
      // A second run, dashed over the first.
      const others = tracks.runs.map((r, i) => make("option", { value: i, selected: i === this.beside }, r.name));
      this.second = make("select", { "aria-label": "Second run, dashed", onchange: (e) => this.compare(Number(e.target.value)) },
        make("option", { value: -1 }, "no other"), ...others);
      this.dashed = make("span", { class: "legend" });
      const boxes = names.map((n) => make("label", { class: "chip" },
        make("input", { type: "checkbox", checked: this.shown.has(n), onchange: (e) => {
          if (e.target.checked) this.shown.add(n); else this.shown.delete(n);
          this.draw();
          this.save();
        } }), " " + n));
      const keys = SIDES.filter((s) => s === "measured" || tracks[s])
        .map((s) => make("span", { class: "legend" }, make("span", { class: "key " + s }), this.side(s)));
      const all = make("button", { type: "button", onclick: () => this.zoom(null) }, "Whole run");
      const kinds = [["time", "over time"], ["spectra", "as spectra"]].map(([value, text]) => make("option", { value, selected: this.spectra === (value === "spectra") }, text));
      const as = make("select", { "aria-label": "Over time, or as spectra of the span shown", onchange: (e) => {
        this.spectra = e.target.value === "spectra";
        this.draw();
        this.save();
      } }, ...kinds);
      this.said = make("output", { class: "said", "aria-live": "off" });
      this.grid = make("div", { class: "channels", tabindex: 0, role: "group",
        "aria-label": "Signals over time. Arrow keys move the cursor, plus and minus zoom, brackets move the span, zero shows the whole run." });
      this.grid.addEventListener("keydown", (e) => this.key(e));
      const row = make("div", { class: "controls" }, make("label", {}, "Run ", pick),
        ...(tracks.runs.length > 1 ? [make("label", {}, "beside ", this.second)] : []), as, all, ...keys, this.dashed, this.said);
      const chips = make("fieldset", { class: "chips" }, make("legend", {}, "Channels"), ...boxes);
      this.place.replaceChildren(row, chips, this.grid);
    }
    /** Shift and drag moves the span. */
    hand(u) {
      u.over.addEventListener("mousedown", (e) => {
        if (!e.shiftKey || e.button || !this.range) return;
        e.stopImmediatePropagation();
        e.preventDefault();
        let x = e.clientX;
        let asked = null;
        const move = (m) => {
          if (asked !== null) cancelAnimationFrame(asked);
          asked = requestAnimationFrame(() => { asked = null; this.pan(u.posToVal(0, "x") - u.posToVal(m.clientX - x, "x")); x = m.clientX; });
        };
        addEventListener("mousemove", move);
        addEventListener("mouseup", () => removeEventListener("mousemove", move), { once: true });
      }, { capture: true });
    }
    key(e) {
      const [a, b] = this.shownRange();
      const step = (b - a) / (e.shiftKey ? 10 : 100);
      const at = Math.min(b, Math.max(a, this.t));
      const zoomed = (f) => this.zoom([at - (at - a) * f, at + (b - at) * f]);
      const act = { ArrowLeft: () => this.at(at - step), ArrowRight: () => this.at(at + step), "+": () => zoomed(0.5), "=": () => zoomed(0.5),
        "-": () => zoomed(2), "[": () => this.pan(-10 * step), "]": () => this.pan(10 * step), 0: () => this.zoom(null) }[e.key];
      if (!act) return;
      e.preventDefault();
      this.said.setAttribute("aria-live", "polite");
      act();
    }
    runNow() { return this.tracks.runs[this.run]; }
    end() { const t = this.runNow().t; return t[t.length - 1] || 1; }
    shownRange() { return this.range || [0, this.end()]; }
    other() { return this.tracks.runs[this.beside]; }
    compare(run) {
      this.beside = run === this.run ? -1 : run;
      this.second.value = this.beside;
      this.draw();
      this.save();
    }
    choose(run) {
      this.run = run;
      if (this.beside === run) this.second.value = this.beside = -1;
      this.pick.value = run;
      this.range = null;
      this.draw();
      this.save();
      this.listeners.forEach((f) => f("run"));
    }
    /** The view as an address, once it rests: browsers allow few changes a second. */
    save() {
      clearTimeout(this.saving);
      this.saving = setTimeout(() => {
        const [a, b] = this.range || [];
        view.write(this.tracks.id, { run: this.runNow().name, ...(this.other() ? { with: this.other().name } : {}), ch: [...this.shown].join(","),
          ...(this.range ? { x: `${a.toFixed(3)}_${b.toFixed(3)}` } : {}), ...(this.spectra ? { as: "spectra" } : {}), t: this.t.toFixed(3) });
      }, 120);
    }
    /** The same range on every plot. */
    zoom(range) {
      const spectra = this.spectra && this.made;
      if (range) {
        const a = Math.max(0, range[0]);
        const b = Math.min(this.end(), range[1]);
        this.range = b - a > 1e-3 && (a > 0 || b < this.end()) ? [a, b] : null;
      } else this.range = null;
      this.moved = performance.now();
      for (const u of this.plots) u.stale = true;
      this.follow();
      if (spectra) this.draw();
      this.save();
    }
    /** Draws the plots whose range is not the view's: those in sight in hairlines while the view moves, all of them as they are once it rests.
     *  A frame has so many of them as its time holds; the next goes on where it stopped. */
    follow() {
      if (this.following) return;
      this.following = true;
      requestAnimationFrame((now) => {
        this.following = false;
        const moving = performance.now() - this.moved < REST_MS;
        const due = this.plots.filter((u) => (u.stale && (u.seen || !moving)) || (u.coarse && !moving));
        const range = this.shownRange();
        this.busy = true;
        const next = [...due.filter((u) => u.order > this.last), ...due.filter((u) => u.order <= this.last)];
        next.every((u, k) => {
          this.show(u, range, moving);
          this.last = u.order;
          return k + 1 < LEAST || performance.now() - now < FRAME_MS;
        });
        this.busy = false;
        if (this.plots.some((u) => u.stale || u.coarse)) this.follow();
      });
    }
    /** A plot between two times; `moving`: in hairlines, and a bucket for some pixels. */
    show(u, [a, b], moving) {
      u.series.forEach((s, k) => { if (k) s.width = moving ? 1 : u.strokes[k - 1]; });
      Object.assign(u, { stale: false, coarse: moving });
      u.batch(() => {
        u.setData(reduced(u.full.t, u.full.series, [a, b], moving ? u.width / COARSE_PX : u.width), false);
        u.setScale("x", { min: a, max: b });
      });
    }
    /** The same span, earlier or later; stops at the run's ends. */
    pan(by) {
      if (!this.range) return;
      const [a, b] = this.range;
      const shift = Math.min(this.end() - b, Math.max(-a, by));
      this.zoom([a + shift, b + shift]);
    }
    /** Time of the cursor: plots, words and replay follow. */
    at(t, from) {
      this.t = Math.min(this.end(), Math.max(0, t));
      this.busy = true;
      for (const u of this.plots) if (u !== from) u.setCursor({ left: u.valToPos(this.t, "x"), top: 10 }, false);
      this.busy = false;
      this.words();
      if (from !== "replay") this.listeners.forEach((f) => f("time"));
    }
    words() {
      const t = this.runNow().t;
      let i = Math.round((this.t / this.end()) * (t.length - 1));
      while (i > 0 && t[i] > this.t) i -= 1;
      while (i < t.length - 1 && t[i + 1] <= this.t) i += 1;
      this.said.textContent = `t = ${this.t.toFixed(2)} s`;
      for (const { c, out } of this.cells) {
        const words = SIDES.filter((s) => c[s].length).map((s) => `${this.side(s)} ${number(c[s][i])}`);
        out.textContent = `${words.join(", ")}${c.unit ? " " + c.unit : ""}`;
      }
    }
    /** Draws for the first time. */
    make() {
      if (this.made) return;
      this.made = true;
      this.near.disconnect();
      this.draw();
      this.grid.style.minHeight = "";
    }
    draw() {
      if (!this.made) return;
      this.sight.disconnect();
      this.plots.concat(this.still || []).forEach((u) => u.destroy());
      Object.assign(this, { plots: [], cells: [], still: [] });
      const run = this.runNow();
      const other = this.spectra ? null : this.other();
      this.dashed.replaceChildren(...(other ? [make("span", { class: "key noise" }), `dashed: ${other.name}`] : []));
      const channels = run.channels.filter((c) => this.shown.has(c.name));
      const places = channels.map((c) => {
        const out = make("span", { class: "values" });
        const place = make("div", { class: "channel" }, make("h3", {}, c.unit ? `${c.name} (${c.unit})` : c.name), out);
        this.cells.push({ c, out });
        return [c, place];
      });
      this.grid.replaceChildren(...places.map(([, p]) => p));
      if (this.spectra) {
        this.cells = [];
        for (const [c, place] of places) this.densities(run, c, place);
        const [a, b] = this.shownRange();
        this.said.textContent = `spectra of ${a.toFixed(2)} to ${b.toFixed(2)} s`;
        return;
      }
      for (const [c, place] of places) this.channel(run, c, place);
      this.at(this.t, "replay");
    }
    channel(run, c, place) {
      const sides = SIDES.filter((s) => c[s].length);
      const lines = sides.map((s) => ({ ...Windfall.stroke(s), width: s === "measured" ? 3 : 1.4 }));
      const d = this.besideOf(run, c);
      const dashes = d.sides.map((s) => ({ ...Windfall.stroke(s), width: 1.4, dash: [6, 4] }));
      const models = sides.filter((s) => s !== "measured");
      const alone = !c.measured.length || !models.length;
      const drawn = [...sides.map((s) => ({ of: c[s] })), ...d.sides.map((s) => ({ of: d[s] }))];
      this.plot(place, c.name, alone ? 172 : 150, run.t, drawn, [...lines, ...dashes], alone ? "time in the run (s)" : "", c.unit);
      if (alone) return;
      const pairs = [[c, models], [d, d.measured ? d.sides.filter((s) => s !== "measured") : []]];
      const left = pairs.flatMap(([of, all]) => all.map((s) => ({ of: of.measured, less: of[s] })));
      const noise = c.noise ? [-2, 2].map((k) => level(k * c.noise)) : [];
      const strokes = [...pairs.flatMap(([of, all]) => all.map((s) => ({ ...Windfall.stroke(s), width: 1.1, dash: of === d ? [6, 4] : undefined }))), ...noise.map(() => Windfall.stroke("noise"))];
      const unit = `residual${c.unit ? ` (${c.unit})` : ""}`;
      this.plot(place, `residual of ${c.name}`, 130, run.t, [...left, ...noise], strokes, "time in the run (s)", unit);
    }
    /** The same channel of the second run, on the first one's clock. */
    besideOf(run, c) {
      const other = this.other();
      const own = other?.channels.find((k) => k.name === c.name);
      const sides = own ? SIDES.filter((s) => own[s].length) : [];
      return { sides, ...Object.fromEntries(sides.map((s) => [s, onto(run.t, other.t, own[s])])) };
    }
    /** Amplitude spectra of a channel and of its residuals, of the span shown. */
    densities(run, c, place) {
      const sides = SIDES.filter((s) => c[s].length);
      const models = sides.filter((s) => s !== "measured");
      const less = (s) => Float64Array.from(run.t, (_, i) => c.measured[i] - c[s][i]);
      const unit = `(${c.unit || "1"}/√Hz)`;
      this.density(place, `spectrum of ${c.name}`, 160, sides.map((s) => [s, c[s]]), "", unit);
      if (c.measured.length && models.length) this.density(place, `spectrum of the residual of ${c.name}`, 165, models.map((s) => [s, less(s)]), "frequency (Hz)", `residual ${unit}`, c.noise);
    }
    density(place, title, height, series, x, y, noise) {
      const { t } = this.runNow();
      const all = series.map(([s, values]) => [s, Windfall.spectrum.density(t, values, this.shownRange())]).filter(([, d]) => d);
      if (!all.length) {
        if (x) place.append(make("p", { class: "note" }, "Fewer than sixteen samples in this span."));
        return;
      }
      const holder = make("div", { role: "img", "aria-label": title });
      place.append(holder);
      const tables = all.map(([, d]) => d);
      const lines = all.map(([s]) => ({ ...Windfall.stroke(s), width: s === "measured" ? 3 : 1.4, spanGaps: true }));
      if (noise) {
        // White noise as declared.
        const f = tables[0][0];
        tables.push([[f[0], f[f.length - 1]], [0, 0].map(() => noise * Math.sqrt((2 * (t[t.length - 1] - t[0])) / (t.length - 1)))]);
        lines.push({ ...Windfall.stroke("noise"), spanGaps: true });
      }
      const options = { width: Math.max(240, place.clientWidth), height, series: [{}, ...lines], legend: { show: false }, axes: Windfall.axes(x, y, true, true),
        scales: { x: { time: false, distr: 3 }, y: { distr: 3 } }, cursor: { drag: { x: true, y: false } } };
      if (!x) Object.assign(options.axes[0], { values: (u, ticks) => ticks.map(() => ""), size: 8 });
      this.still.push(new uPlot(options, uPlot.join(tables), holder));
      Windfall.charts += 1;
    }
    plot(place, title, height, t, series, lines, x, y) {
      const holder = make("div", { role: "img", "aria-label": `${title} over time` });
      place.append(holder);
      const [a, b] = this.shownRange();
      const options = {
        width: Math.max(240, place.clientWidth), height, series: [{}, ...lines.map((l) => ({ ...l, spanGaps: false }))],
        scales: { x: { time: false, min: a, max: b, range: (u, min, max) => [min, max] }, ...(this.runNow().interior ? { y: { range: inside(this.runNow().interior) } } : {}) }, axes: Windfall.axes(x, y), legend: { show: false },
        cursor: { drag: { x: true, y: false, setScale: false }, y: false, points: { size: 5 }, bind: { dblclick: () => () => { this.zoom(null); return null; } } },
        hooks: {
          setSelect: [(u) => {
            if (u.select.width > 4) this.zoom([u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]);
            u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
          }],
          setCursor: [(u) => {
            if (this.busy || u.cursor.left < 0 || !u.cursor.event) return;
            this.pending = { t: u.posToVal(u.cursor.left, "x"), u };
            if (!this.asked) {
              this.asked = true;
              requestAnimationFrame(() => { this.asked = false; this.at(this.pending.t, this.pending.u); });
            }
          }],
        },
      };
      if (!x) Object.assign(options.axes[0], { values: (u, all) => all.map(() => ""), size: 8 });
      options.axes[1].space = 18;
      const u = new uPlot(options, reduced(t, series, [a, b], options.width), holder);
      u.full = { t, series };
      u.order = this.plots.length;
      u.root.plot = u;
      this.sight.observe(u.root);
      u.strokes = lines.map((l) => l.width);
      this.hand(u);
      this.plots.push(u);
      Windfall.charts += 1;
    }
  };
})();
