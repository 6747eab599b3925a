// Opens pages of results from disk in a headless Chromium and looks at them as a reader would: no request, no error, every figure drawn,
// linked zoom, replay, keys, three widths, dark and light, axe-core's rules. Usage: node pages.mjs PAGE.html… [--shots DIR]
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const chromium = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const skip = (why) => { console.log(`skipped: ${why}`); process.exit(0); };
if (!chromium) skip("no Chromium");
let playwright;
try { playwright = require("playwright-core"); } catch { skip("playwright-core is not installed: npm ci in tests/browser"); }
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const words = process.argv.slice(2);
const at = words.indexOf("--shots");
const shots = at >= 0 ? words.splice(at, 2)[1] : null;
if (shots) mkdirSync(shots, { recursive: true });
if (!words.length) skip("no page given");

let failed = 0;
const hold = (what, ok, found = "") => {
  if (!ok) failed += 1;
  if (!ok || process.env.VERBOSE) console.log(`${ok ? "ok  " : "FAIL"} ${what} ${ok ? "" : JSON.stringify(found)}`);
};

/** Opens a page and keeps all that goes wrong in it. */
async function open(browser, file, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1000, height: 900 }, ...options });
  const page = await context.newPage();
  const wrong = [];
  const asked = [];
  page.on("pageerror", (e) => wrong.push(String(e)));
  page.on("console", (m) => { if (["error", "warning"].includes(m.type()) && !/GPU|GL Driver|WebGL/.test(m.text())) wrong.push(m.text()); });
  page.on("request", (r) => { if (!r.url().startsWith("file:") && !r.url().startsWith("data:")) asked.push(r.url()); });
  await page.goto("file://" + resolve(file) + (options.hash ?? ""));
  return { page, context, wrong, asked };
}

async function interaction(page, name) {
  const id = await page.evaluate(() => Object.keys(Windfall.views)[0]);
  if (!id) return;
  const range = async () => {
    // Plots follow a few a frame.
    await page.waitForFunction((k) => { const v = Windfall.views[k]; return v.plots.every((u) => !u.stale && !u.coarse); }, id, { timeout: 10000 });
    return page.evaluate((k) => Windfall.views[k].plots.map((u) => [u.scales.x.min, u.scales.x.max]), id);
  };
  const plot = page.locator(`[data-tracks="${id}"] .channel .u-over`).first();
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox();
  await page.mouse.move(box.x + 0.2 * box.width, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 40, { steps: 4 });
  await page.mouse.up();
  const zoomed = await range();
  const whole = await page.evaluate((k) => Windfall.views[k].end(), id);
  hold(`${name}: a drag zooms`, zoomed[0][1] - zoomed[0][0] < 0.3 * whole, zoomed[0]);
  hold(`${name}: all axes follow`, zoomed.every((r) => Math.abs(r[0] - zoomed[0][0]) < 1e-9 && Math.abs(r[1] - zoomed[0][1]) < 1e-9), zoomed);
  await page.keyboard.down("Shift");
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 40, { steps: 4 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  const moved = (await range())[0];
  const span = zoomed[0][1] - zoomed[0][0];
  hold(`${name}: shift and drag moves the span`, Math.abs(moved[1] - moved[0] - span) < 1e-6 * span && Math.abs(moved[0] - zoomed[0][0] - 0.2 * span) < 0.02 * span, [zoomed[0], moved]);
  const link = await page.evaluate(() => location.href);
  hold(`${name}: the address holds the view`, link.includes("x=") && link.includes("run="), link);
  await page.locator(".values").first().waitFor();
  hold(`${name}: values are read`, /\d/.test(await page.locator(".values").first().textContent()));
  await page.locator(`[data-tracks="${id}"] .channels`).focus();
  await page.keyboard.press("0");
  hold(`${name}: a key shows all`, (await range()).every((r) => Math.abs(r[1] - r[0] - whole) < 1e-3));
  await spectra(page, name, id);
  const before = await page.evaluate((k) => Windfall.views[k].t, id);
  await page.keyboard.press("ArrowRight");
  hold(`${name}: keys move the cursor`, (await page.evaluate((k) => Windfall.views[k].t, id)) !== before);
  const runs = await page.locator(`.tracks[data-tracks="${id}"] select`).first().locator("option").count();
  if (runs > 1) {
    await page.locator(`.tracks[data-tracks="${id}"] select`).first().selectOption(String(runs - 1));
    hold(`${name}: another run`, (await page.evaluate((k) => Windfall.views[k].run, id)) === runs - 1);
  }
  if (runs > 1) {
    const lines = () => page.evaluate((k) => Windfall.views[k].plots[0].series.length, id);
    const alone = await lines();
    await page.getByLabel("Second run, dashed").first().selectOption("0");
    const both = await page.evaluate((k) => {
      const { plots, beside } = Windfall.views[k];
      return [beside, plots[0].series.length, plots[0].data.slice(1).every((y) => y.some((v) => Number.isFinite(v)))];
    }, id);
    hold(`${name}: a second run lies over the first`, both[0] === 0 && both[1] > alone && both[2], [alone, both]);
    hold(`${name}: the address holds the second run`, await page.waitForFunction(() => location.href.includes("with="), null, { timeout: 10000 }).then(() => true, () => false));
    await page.getByLabel("Second run, dashed").first().selectOption("-1");
    hold(`${name}: and is taken away`, (await lines()) === alone);
  }
  await replay(page, name, id);
  return link;
}

/** The view as spectra: every channel draws, and the line of a swing that is put in stands at its frequency. */
async function spectra(page, name, id) {
  const pick = page.locator(`.tracks[data-tracks="${id}"]`).getByLabel("Over time, or as spectra");
  await pick.selectOption("spectra");
  const drawn = await page.evaluate((k) => [Windfall.views[k].still.length, Windfall.views[k].shown.size], id);
  hold(`${name}: spectra of every channel`, drawn[0] >= drawn[1] && drawn[1] > 0, drawn);
  const peak = await page.evaluate(() => {
    const t = Array.from({ length: 4000 }, (_, i) => 0.01 * i);
    const [f, a] = Windfall.spectrum.density(t, t.map((v) => 0.3 * v + Math.sin(2 * Math.PI * 3 * v)), [0, 40]);
    return f[a.indexOf(Math.max(...a))];
  });
  hold(`${name}: a swing of 3 Hz stands at 3 Hz`, Math.abs(peak - 3) < 0.15, peak);
  hold(`${name}: the address holds spectra`, await page.waitForFunction(() => location.href.includes("as=spectra"), null, { timeout: 10000 }).then(() => true, () => false));
  await pick.selectOption("time");
}

/** A table with a filter: words leave rows out, heads sort. */
async function filter(page, name) {
  const place = page.locator("[data-filter]").first();
  if (!(await place.count())) return;
  const rows = () => place.locator("tbody tr:visible").count();
  const all = await rows();
  await place.locator("input").fill("no such words");
  hold(`${name}: the filter leaves rows out`, all > 0 && (await rows()) === 0, all);
  await place.locator("input").fill("");
  await place.locator("thead button").first().click();
  hold(`${name}: heads sort`, (await place.locator("th[aria-sort=ascending]").count()) === 1 && (await rows()) === all);
  const link = await place.locator("tbody a").first().getAttribute("href");
  hold(`${name}: a campaign's page is there`, !!link && existsSync(join(dirname(resolve(page.url().replace("file://", ""))), decodeURIComponent(link))), link);
}

/** The picture is made of more than one colour, and changes with time. */
async function replay(page, name, id) {
  const stage = page.locator(`.replay[data-replay="${id}"] canvas`);
  if (!(await stage.count())) {
    hold(`${name}: a replay where there are tracks`, (await page.locator(`[data-replay="${id}"]`).count()) === 0);
    return;
  }
  await stage.scrollIntoViewIfNeeded();
  const shown = () => page.evaluate((k) => {
    const r = Windfall.views[k].replay;
    r.paint();
    const g = r.painter.gl;
    const [w, h] = [g.drawingBufferWidth, g.drawingBufferHeight];
    const all = new Uint8Array(4 * w * h);
    g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, all);
    let sum = 0;
    const colours = new Set();
    for (let i = 0; i < all.length; i += 4) { sum = (sum * 31 + all[i] + 256 * all[i + 1]) % 4294967291; colours.add((all[i] << 16) | (all[i + 1] << 8) | all[i + 2]); }
    return { sum, colours: colours.size };
  }, id);
  const first = await shown();
  hold(`${name}: the replay draws`, first.colours > 8, first);
  const slider = page.locator(`[data-replay="${id}"] input[type=range]`);
  await slider.fill("500");
  const t = await page.evaluate((k) => [Windfall.views[k].t, Windfall.views[k].end()], id);
  hold(`${name}: the replay seeks`, Math.abs(t[0] - 0.5 * t[1]) < 0.01 * t[1], t);
  hold(`${name}: the picture moves`, (await shown()).sum !== first.sum);
  await page.locator(`[data-replay="${id}"] button.play`).click();
  await page.waitForFunction(([k, from]) => Windfall.views[k].t > from, [id, t[0]], { timeout: 10000 });
  await page.locator(`[data-replay="${id}"] button.play`).click();
  hold(`${name}: the replay plays`, true);
}

async function look(browser, file) {
  const name = basename(dirname(resolve(file))) + "/" + basename(file);
  const { page, context, wrong, asked } = await open(browser, file);
  const ready = await page.waitForFunction(() => Windfall.ready, null, { timeout: 20000 }).then(() => true, () => false);
  hold(`${name}: the page's program runs`, ready);
  await page.evaluate(() => Windfall.showAll());
  const figures = await page.evaluate(() => [...document.querySelectorAll("figure[data-plot]")].map((f) => [f.querySelector("figcaption")?.textContent,
    !!f.querySelector("canvas")?.width]));
  hold(`${name}: every figure draws (${figures.length})`, figures.every((f) => f[1]), figures.filter((f) => !f[1]));
  // Labels of even axes say the places that they stand at.
  const labels = await page.evaluate(() => [...document.querySelectorAll("figure[data-plot]")].flatMap((f) => f.uplot.axes.flatMap((axis, k) => {
    const even = f.uplot.scales[k ? "y" : "x"].distr !== 3 && axis._splits?.length > 1;
    const step = even ? axis._splits[1] - axis._splits[0] : 0;
    return even ? axis._splits.map((at, i) => [axis._values[i], at, step]) : [];
  })));
  const off = labels.filter(([label, at, step]) => !(Math.abs(Number(label.replaceAll("−", "-")) - at) < 1e-3 * step));
  hold(`${name}: labels of axes are right (${labels.length})`, (labels.length > 0 || figures.length === 0) && off.length === 0, off.slice(0, 5));
  const records = await page.evaluate(() => [Windfall.data.tracks.some((t) => t.body.rigid), "smoothing" in Windfall.views,
    Windfall.data.plots.filter((p) => p?.log_x && p.marks?.length).length]);
  hold(`${name}: tunnel records have spectra with their cut-off, others none`, records[0] ? records[1] && records[2] === 7 : !records[1] && !records[2], records);
  const told = await page.evaluate(() => Object.keys(Windfall.views).map((k) => [k, Windfall.views[k].plots.length]));
  hold(`${name}: every view over time draws`, told.every(([, n]) => n > 0), told);
  await filter(page, name);
  const link = await interaction(page, name);
  await page.evaluate(axe);
  const found = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
  const serious = found.violations.filter((v) => ["serious", "critical"].includes(v.impact));
  hold(`${name}: no serious finding of axe`, serious.length === 0, serious.map((v) => [v.id, v.nodes.length, v.nodes[0].html.slice(0, 120), v.nodes[0].failureSummary]));
  hold(`${name}: no error`, wrong.length === 0, wrong);
  hold(`${name}: no request`, asked.length === 0, asked);
  await context.close();
  if (link) {
    const again = await open(browser, file, { hash: "#" + link.split("#")[1] });
    await again.page.waitForFunction(() => Windfall.ready);
    const range = await again.page.evaluate(() => Object.values(Windfall.views)[0].range);
    hold(`${name}: a link opens its view`, range && range[1] > range[0], range);
    await again.context.close();
  }
  await still(browser, file, name);
  await widths(browser, file, name);
}

/** Without JavaScript the still figures are there. */
async function still(browser, file, name) {
  const { page, context } = await open(browser, file, { javaScriptEnabled: false });
  const drawn = await page.locator("figure svg").count();
  const canvases = await page.locator("canvas").count();
  hold(`${name}: figures without JavaScript`, drawn > 0 && canvases === 0, { drawn, canvases });
  await context.close();
}

/** Nothing wider than the window, in either light; pictures are kept. */
async function widths(browser, file, name) {
  for (const width of [400, 1000, 1600]) {
    for (const colorScheme of ["light", "dark"]) {
      const { page, context } = await open(browser, file, { viewport: { width, height: 900 }, colorScheme });
      await page.waitForFunction(() => Windfall.ready);
      await page.evaluate(() => Windfall.showAll());
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      hold(`${name}: ${width} px hold it`, wide <= width, wide);
      if (shots) await page.screenshot({ path: join(shots, `${name.replace(/\W+/g, "-")}-${width}-${colorScheme}.png`), fullPage: true });
      await context.close();
    }
  }
}

const browser = await playwright.chromium.launch({ executablePath: chromium,
  // WebGL in software, the page itself without: to put a hundred plots on the screen by a software card takes seconds a frame.
  args: ["--no-sandbox", "--disable-gpu-sandbox", "--enable-unsafe-swiftshader"] });
for (const file of words) await look(browser, file);
await browser.close();
console.log(failed ? `${failed} failed` : `${words.length} pages: all hold`);
process.exit(failed ? 1 : 0);
