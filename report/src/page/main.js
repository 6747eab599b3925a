"use strict";
// The page's parts, each by itself: what fails leaves its still figures.
(() => {
  const { data, make } = Windfall;
  const attempt = (what, f) => { try { return f(); } catch (e) { console.warn(what, e); return null; } };
  document.documentElement.classList.add("js");
  const views = {};
  for (const tracks of data.tracks) {
    const place = document.querySelector(`[data-tracks="${tracks.id}"]`);
    if (!place || !tracks.runs.length) continue;
    views[tracks.id] = attempt("signals", () => new Windfall.Tracks(place, tracks));
    const stage = document.querySelector(`[data-replay="${tracks.id}"]`);
    if (!stage || !views[tracks.id]) continue;
    const replay = attempt("replay", () => new Windfall.Replay(stage, views[tracks.id]));
    if (!replay) stage.replaceChildren(make("p", { class: "note" }, "No replay: this browser has no WebGL. The figures below show the same runs."));
    views[tracks.id].replay = replay;
  }
  Windfall.views = views;
  attempt("figures", () => Windfall.upgrade());
  attempt("tables", () => Windfall.tables());
  // Paper has all figures, whatever was in sight.
  addEventListener("beforeprint", () => Windfall.showAll?.());
  const here = [...document.querySelectorAll("nav a")];
  const seen = new IntersectionObserver((all) => {
    for (const e of all) if (e.isIntersecting) here.forEach((a) => a.classList.toggle("here", a.hash === "#" + e.target.id));
  }, { rootMargin: "-20% 0px -70% 0px" });
  document.querySelectorAll("section[id]").forEach((s) => seen.observe(s));
  Windfall.ready = true;
})();
