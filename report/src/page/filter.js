"use strict";
// Long tables: rows by words, and in the order of a column.
Windfall.tables = () => {
  const { make } = Windfall;
  const clean = (cell) => cell.textContent.trim();
  /** A number as the tables write it; none of words. */
  const amount = (text) => {
    const x = parseFloat(text.replace("−", "-").replace("< ", "").replace("> ", ""));
    return Number.isFinite(x) ? x : null;
  };
  for (const place of document.querySelectorAll("[data-filter]")) {
    const body = place.querySelector("tbody");
    if (!body) continue;
    const rows = [...body.rows];
    const texts = rows.map((r) => r.textContent.toLowerCase());
    const said = make("output", { class: "said", "aria-live": "polite" });
    const apply = (asked) => {
      const words = asked.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      rows.forEach((r, i) => {
        r.hidden = !words.every((w) => (w.startsWith("-") && w.length > 1 ? !texts[i].includes(w.slice(1)) : texts[i].includes(w)));
        shown += r.hidden ? 0 : 1;
      });
      said.textContent = `${shown} of ${rows.length}`;
    };
    const field = make("input", { type: "search", placeholder: "words; -word leaves out", "aria-label": `Rows of ${place.dataset.filter} that have these words`, oninput: (e) => apply(e.target.value) });
    place.prepend(make("div", { class: "controls" }, make("label", {}, "Filter ", field), said));
    apply("");
    const heads = [...place.querySelectorAll("thead th")];
    heads.forEach((th, k) => {
      const button = make("button", { type: "button", class: "sort", onclick: () => {
        const down = th.getAttribute("aria-sort") === "ascending";
        heads.forEach((h) => h.removeAttribute("aria-sort"));
        th.setAttribute("aria-sort", down ? "descending" : "ascending");
        const key = (r) => clean(r.cells[k]);
        const numbers = rows.every((r) => amount(key(r)) !== null || key(r) === "–");
        const order = [...rows].sort((a, b) => {
          const [x, y] = [key(a), key(b)];
          if (!numbers) return x.localeCompare(y);
          const [p, q] = [amount(x), amount(y)];
          return p === null || q === null ? (p === null) - (q === null) : p - q;
        });
        body.append(...(down ? order.reverse() : order));
      } }, th.textContent);
      th.replaceChildren(button);
    });
  }
};
