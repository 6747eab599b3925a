"use strict";
// Every still figure that is a chart becomes one to zoom and to read values from, when it comes into sight.
(() => {
  const { data, make, number, colour, themed } = Windfall;
  const names = { measured: "measured", before: "declared model", after: "with effects", noise: "noise" };
  /** What a role is called in a figure: as the section's key says, where it has one. */
  function named(figure, role) {
    const mark = figure.closest("section")?.querySelector(`.key.${role}`);
    return mark?.nextSibling?.textContent.split(",")[0] || names[role];
  }
  const strokes = { measured: 3, before: 1.5, after: 1.5, noise: 1.2 };
  /** How a series of that role is drawn. */
  Windfall.stroke = (role) => ({
    stroke: colour(role), width: strokes[role], dash: role === "noise" ? [5, 4] : undefined, points: { show: false },
  });
  Windfall.axes = (x, y, log) => {
    const common = { stroke: colour("soft"), grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("line"), width: 1 },
      font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif", labelSize: 16, labelGap: 0 };
    return [{ ...common, label: x || undefined, size: 30, labelSize: 20, space: 60 }, { ...common, label: y || undefined, size: 58, labelSize: 18, space: 24, values: log ? (u, all) => all.map((v) => (v == null ? "" : number(v))) : undefined }];
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
    const twice = s.x.length > 3 && s.x[1] === s.x[2];
    return twice ? { ...s, x: s.x.map((v, i) => v + (i % 2 ? -1e-6 : 1e-6)) } : s;
  }

  function build(figure, plot) {
    const series = plot.series.map(steps);
    const table = joined(series);
    const value = (u, v) => number(v);
    const lines = [{ label: plot.x_label.replace(/ \(.*/, ""), value }];
    const bands = [];
    const used = {};
    for (const s of series) {
      const name = named(figure, s.role) + (used[s.role] ? " " + (used[s.role] + 1) : "");
      used[s.role] = (used[s.role] || 0) + 1;
      lines.push({ label: name, value, spanGaps: true, ...Windfall.stroke(s.role) });
      if (s.band) {
        const at = lines.length;
        for (const end of ["lower 95 %", "upper 95 %"]) lines.push({ label: end, value, width: 0, points: { show: false }, spanGaps: true });
        bands.push({ series: [at + 1, at], fill: colour(s.role) + "38" });
      }
    }
    const svg = figure.querySelector("svg");
    const place = make("div", { class: "live", role: "img", "aria-label": plot.title });
    const width = Math.max(240, figure.clientWidth);
    const options = {
      width, height: Math.round(Math.min(300, Math.max(190, width * 0.56))), series: lines, bands,
      scales: { x: { time: false }, y: { distr: plot.log_y ? 3 : 1 } },
      axes: Windfall.axes(plot.x_label, plot.y_label, plot.log_y), cursor: { drag: { x: true, y: false } }, legend: { live: true },
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
    Windfall.showAll = () => figures.filter((f) => !f.uplot).forEach(show);
  };
})();
