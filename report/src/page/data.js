"use strict";
// What the page holds, and what its parts share.
const Windfall = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);

  /** Little-endian 32-bit floats from base64. */
  function floats(text) {
    const bytes = Uint8Array.from(atob(text || ""), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }
  const series = data.series.map(floats);
  for (const tracks of data.tracks) {
    for (const run of tracks.runs) {
      run.t = series[run.t];
      for (const c of run.channels) {
        for (const side of ["measured", "before", "after"]) c[side] = series[c[side]];
      }
    }
  }
  /** An element with attributes and children. */
  function make(tag, attributes = {}, ...children) {
    const e = document.createElement(tag);
    for (const [k, v] of Object.entries(attributes)) {
      if (k === "class") e.className = v;
      else if (k.startsWith("on")) e.addEventListener(k.slice(2), v);
      else if (v !== false && v !== undefined) e.setAttribute(k, v === true ? "" : v);
    }
    e.append(...children);
    return e;
  }
  /** A number in four digits. */
  function number(x) {
    if (x == null || !Number.isFinite(x)) return "–";
    const size = Math.abs(x);
    if (x !== 0 && (size < 1e-4 || size >= 1e5)) return x.toExponential(3);
    return String(Number(x.toPrecision(4))).replace("-", "−");
  }
  /** A colour of the style sheet. */
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  /** Called again when light becomes dark. */
  const themed = [];
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => themed.forEach((f) => f()));

  /** The view in the address: run, channels, range, time. */
  const view = {
    read() {
      const text = location.hash.slice(1);
      return text.includes("=") ? Object.fromEntries(new URLSearchParams(text)) : {};
    },
    write(id, state) {
      const words = new URLSearchParams({ of: id, ...state });
      history.replaceState(null, "", "#" + words);
    },
  };
  return { data, make, number, colour, themed, view, charts: 0 };
})();
