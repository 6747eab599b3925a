"use strict";
// Every still figure that is a chart becomes one to zoom and to read values from, when it comes into sight.
(() => {
  const { data, make, number, colour, themed } = Windfall;
  const names = { measured: "measured", before: "declared model", after: "model", noise: "noise" };
  /** What a role is called in a figure: as the section's key says, where it has one. */
  function named(figure, role) {
    const mark = figure.closest("section")?.querySelector(`.key.${role}`);
    if (role === "point" && !mark) return "measured points";
    return mark?.nextSibling?.textContent.split(",")[0] || names[role];
  }
  /** Labels of a logarithmic axis, short: 1e−5. */
  const decades = (u, all) => all.map((v) => (v == null ? "" : v !== 0 && (v < 1e-3 || v >= 1e5) ? v.toExponential(0).replace("e-", "e−").replace("e+", "e") : number(v)));
  /** Labels of an even axis with the digits that its step needs, small and large ones with their power of ten. */
  const even = (u, all, axis, space, step) => {
    const most = Math.max(...all.map((v) => Math.abs(v ?? 0)));
    // Of a step of 2.5 one place.
    const places = (x) => { let n = 0; while (n < 12 && Math.abs(x * 10 ** n - Math.round(x * 10 ** n)) > 1e-6 * x * 10 ** n) n += 1; return n; };
    const power = Math.floor(Math.log10(most || 1));
    const one = most && (most < 1e-3 || most >= 1e6)
      ? (v) => (v === 0 ? "0" : `${(v / 10 ** power).toFixed(places(step / 10 ** power))}e${power}`)
      : (v) => v.toFixed(places(step));
    return all.map((v) => (v == null ? "" : one(Math.abs(v) < 1e-9 * step ? 0 : v).replaceAll("-", "−")));
  };
  /** Lines of a grid at powers of ten alone. */
  const powers = (u, all) => all.map((v) => (v != null && Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-6 ? v : null));
  const strokes = { measured: 3, before: 1.5, after: 1.5, noise: 1.2 };
  /** How a series of that role is drawn. */
  Windfall.stroke = (role) => ({
    stroke: colour(role), width: strokes[role], dash: role === "noise" ? [5, 4] : undefined, points: { show: false },
  });
  Windfall.axes = (x, y, log, logX) => {
    const common = { stroke: colour("soft"), grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("line"), width: 1 },
      font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif", labelSize: 16, labelGap: 0 };
    const grid = (is) => (is ? { grid: { ...common.grid, filter: powers }, ticks: { ...common.ticks, filter: powers } } : {});
    return [{ ...common, ...grid(logX), label: x || undefined, size: 30, labelSize: 20, space: 60, values: logX ? decades : even }, { ...common, ...grid(log), label: y || undefined, size: 58, labelSize: 18, space: 24, values: log ? decades : even }];
  };

  /** All abscissae of some series, ascending, and each series on them, joined over what it lacks. */
  function joined(series) {
    const same = series.every((s) => s.x.length === series[0].x.length && s.x.every((v, i) => v === series[0].x[i]));
    const flat = series.flatMap((s) => [s.y, ...(s.band || [])].map((y) => [Float64Array.from(s.x), y]));
    if (same) return [Float64Array.from(series[0].x), ...flat.map(([, y]) => y)];
    return uPlot.join(flat);
  }
  /** Steps of a histogram: each abscissa once, the bin's value to its right. */
  function steps(s) {
    if (s.points) {
      // Several points may have one abscissa, and the plot's table has each once.
      const tiny = ((s.x[s.x.length - 1] - s.x[0]) || 1) * 1e-9;
      const x = [];
      s.x.forEach((v, i) => x.push(i && v <= x[i - 1] ? x[i - 1] + tiny : v));
      return { ...s, x };
    }
    const twice = s.x.length > 3 && s.x[1] === s.x[2];
    return twice ? { ...s, x: s.x.map((v, i) => v + (i % 2 ? -1e-6 : 1e-6)) } : s;
  }

  /** Dashed lines at these abscissae. */
  function upright(u, marks) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.strokeStyle = colour("noise");
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([4, 4].map((n) => n * devicePixelRatio));
    for (const mark of marks.filter((m) => m >= u.scales.x.min && m <= u.scales.x.max)) {
      const x = Math.round(u.valToPos(mark, "x", true));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }

  /** Error bars of points. */
  function bars(u, series) {
    const { ctx } = u;
    ctx.save();
    ctx.lineWidth = devicePixelRatio;
    for (const s of series.filter((s) => s.points && s.band)) {
      ctx.strokeStyle = colour(s.role === "measured" ? "ink" : s.role);
      s.x.forEach((v, i) => {
        if (v < u.scales.x.min || v > u.scales.x.max) return;
        const x = u.valToPos(v, "x", true);
        ctx.beginPath();
        ctx.moveTo(x, u.valToPos(s.band[0][i], "y", true));
        ctx.lineTo(x, u.valToPos(s.band[1][i], "y", true));
        ctx.stroke();
      });
    }
    ctx.restore();
  }
  /** Discs in place of a line. */
  const discs = (s) => {
    const ink = colour(s.role === "measured" ? "ink" : s.role);
    return { stroke: ink, width: 0, paths: () => null, points: { show: true, size: s.x.length > 60 ? 4 : 6, stroke: ink, fill: ink, width: 0 } };
  };

  function build(figure, plot) {
    const series = plot.series.map(steps);
    const table = joined(series);
    const value = (u, v) => number(v);
    const lines = [{ label: plot.x_label.replace(/ \(.*/, ""), value }];
    const bands = [];
    const used = {};
    for (const s of series) {
      const kind = s.points && s.role === "measured" ? "point" : s.role;
      const name = named(figure, kind) + (used[kind] ? " " + (used[kind] + 1) : "");
      used[kind] = (used[kind] || 0) + 1;
      lines.push({ label: name, value, spanGaps: true, ...(s.points ? discs(s) : Windfall.stroke(s.role)) });
      if (s.band) {
        const at = lines.length;
        for (const end of ["lower end", "upper end"]) lines.push({ label: end, value, width: 0, points: { show: false }, spanGaps: true, class: s.points ? "bar-end" : null });
        if (!s.points) bands.push({ series: [at + 1, at], fill: colour(s.role) + "38" });
      }
    }
    const svg = figure.querySelector("svg");
    const place = make("div", { class: "live", role: "img", "aria-label": plot.title });
    const width = Math.max(240, figure.clientWidth);
    const options = {
      width, height: Math.round(Math.min(300, Math.max(190, width * 0.56))), series: lines, bands,
      // Points at the ends lie inside.
      scales: { x: { time: false, distr: plot.log_x ? 3 : 1, ...(series.some((s) => s.points) && !plot.log_x ? { range: (u, a, b) => [a - 0.04 * (b - a || 1), b + 0.04 * (b - a || 1)] } : {}) }, y: { distr: plot.log_y ? 3 : 1 } },
      axes: Windfall.axes(plot.x_label, plot.y_label, plot.log_y, plot.log_x), cursor: { drag: { x: true, y: false } }, legend: { live: true },
      hooks: { drawAxes: [(u) => upright(u, plot.marks || [])], draw: [(u) => bars(u, series)] },
    };
    const old = figure.querySelector(".live");
    if (old) { old.uplot.destroy(); old.remove(); }
    figure.append(place);
    if (svg) svg.classList.add("replaced");
    place.uplot = new uPlot(options, table, place);
    figure.uplot = place.uplot;
    Windfall.charts += 1;
  }
  function show(figure) {
    const plot = data.plots[Number(figure.dataset.plot)];
    try { build(figure, plot); } catch (e) { console.error(plot.title, e); figure.querySelector("svg")?.classList.remove("replaced"); }
  }
  Windfall.upgrade = () => {
    const figures = [...document.querySelectorAll("figure[data-plot]")];
    const seen = new IntersectionObserver((all) => {
      for (const e of all) if (e.isIntersecting && !e.target.uplot) show(e.target);
    }, { rootMargin: "300px" });
    figures.forEach((f) => seen.observe(f));
    const again = () => figures.filter((f) => f.uplot).forEach(show);
    themed.push(again);
    let last = innerWidth;
    let timer = 0;
    addEventListener("resize", () => {
      clearTimeout(timer);
      timer = setTimeout(() => { if (innerWidth !== last) { last = innerWidth; again(); } }, 200);
    });
    Windfall.showAll = () => {
      figures.filter((f) => !f.uplot).forEach(show);
      Object.values(Windfall.views).forEach((v) => v?.make());
    };
  };
})();
