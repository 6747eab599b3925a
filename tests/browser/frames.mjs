// Frame rate of the interaction with 16,000 samples of 12 channels, three curves and a residual each, in a headless Chromium: cursor, drag,
// zoom, pan. Held: no plot is drawn while the cursor moves and none out of sight while the range does (how many of those in sight fit into a
// frame's time is the machine's); and processor time of the page's main thread a frame, which is that of a frame or, where the machine is
// slow, a multiple of a peer's in the same run, bare lines moving over the same plots. Rates by the clock are printed beside it.
// Usage: node frames.mjs CLOSING_PAGE.html [--size WIDTHxHEIGHT]
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const require = createRequire(import.meta.url);
const chromium = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const skip = (why) => { console.log(`skipped: ${why}`); process.exit(0); };
if (!chromium) skip("no Chromium");
let playwright;
try { playwright = require("playwright-core"); } catch { skip("playwright-core is not installed: npm ci in tests/browser"); }

/** Processor time a frame, ms: of 60 frames a second, or as a multiple of the peer's; 1.2 to 2.3 are measured. */
const FRAME_MS = 1000 / 60;
const PEER = 4;
/** Plots drawn a frame while only the cursor moves. */
const STILL = 0.1;
const [SAMPLES, CHANNELS, SPAN_S] = [16000, 12, 109];

const words = process.argv.slice(2);
const sized = words.indexOf("--size");
const [width, height] = sized >= 0 ? words.splice(sized, 2)[1].split("x").map(Number) : [1600, 1000];
if (!words.length) skip("no page given");

/** Little-endian 32-bit floats in base64. */
const packed = (f) => Buffer.from(Float32Array.from({ length: SAMPLES }, (_, i) => f(i)).buffer).toString("base64");

/** The page's own data with one run of that size: swings with noise, and models beside them. */
function large(page) {
  const text = readFileSync(page, "utf8");
  const mark = '<script type="application/json" id="data">';
  const from = text.indexOf(mark) + mark.length;
  const to = text.indexOf("</script>", from);
  const data = JSON.parse(text.slice(from, to));
  const kept = data.tracks[0].runs[0].channels.slice(0, CHANNELS);
  const put = (f) => data.series.push(packed(f)) - 1;
  if (kept.length < CHANNELS) throw new Error(`${page} has ${kept.length} channels`);
  let seed = 1;
  const noise = () => { seed = (seed * 16807) % 2147483647; return seed / 2147483647 - 0.5; };
  const t = (i) => (SPAN_S * i) / (SAMPLES - 1);
  const channels = kept.map((c, k) => {
    const wave = (i, d) => Math.sin((2 + 0.3 * k) * t(i) + d) * Math.exp(-t(i) / 60);
    return { ...c, noise: c.noise ?? 0.02, measured: put((i) => wave(i, 0) + 0.1 * noise()), before: put((i) => wave(i, 0.2)), after: put((i) => wave(i, 0.01)) };
  });
  const run = { name: "large", kind: "perturbed", use: "hold-out", t: put(t), channels };
  data.tracks = [{ ...data.tracks[0], before: "declared model", after: "with the effects added", runs: [run] }];
  const folder = mkdtempSync(join(tmpdir(), "frames-"));
  const file = join(folder, "large.html");
  writeFileSync(file, text.slice(0, from) + JSON.stringify(data).replaceAll("<", "\\u003c") + text.slice(to));
  return { folder, file };
}

/** Frames while `act` is called once a frame, `n` times: processor time of the main thread and clock time of each. */
async function measured(page, session, name, n, act) {
  await page.evaluate(() => {
    window.frames = [];
    window.drawn = 0;
    const tick = (t) => { window.frames.push(t); window.ticking = requestAnimationFrame(tick); };
    window.ticking = requestAnimationFrame(tick);
  });
  const of = async () => Object.fromEntries((await session.send("Performance.getMetrics")).metrics.map((m) => [m.name, m.value]));
  const before = await of();
  for (let k = 0; k < n; k += 1) await act(k, n);
  const after = await of();
  const [times, drawn] = await page.evaluate(() => { cancelAnimationFrame(window.ticking); return [window.frames, window.drawn]; });
  const steps = times.slice(1).map((t, i) => t - times[i]).sort((a, b) => a - b);
  const frames = steps.length;
  const busy = (1000 * (after.TaskDuration - before.TaskDuration)) / frames;
  const script = (1000 * (after.ScriptDuration - before.ScriptDuration)) / frames;
  const at = (p) => steps[Math.min(frames - 1, Math.floor(p * frames))];
  const rate = (1000 * frames) / (times[times.length - 1] - times[0]);
  console.log(`${name.padEnd(8)} ${String(frames).padStart(4)} frames  ${busy.toFixed(1).padStart(5)} ms of processor a frame (script ${script.toFixed(1)}), ${(drawn / frames).toFixed(1)} plots drawn` +
    `  ${rate.toFixed(0).padStart(3)} frames/s by the clock, step median ${at(0.5).toFixed(1)} ms, 95 % ${at(0.95).toFixed(1)} ms`);
  return { name, busy, drawn: drawn / frames };
}

const { folder, file } = large(words[0]);
const browser = await playwright.chromium.launch({ executablePath: chromium,
  args: ["--no-sandbox", "--enable-unsafe-swiftshader"] });
let failed = 0;
try {
  const page = await browser.newPage({ viewport: { width, height } });
  await page.goto("file://" + file);
  await page.waitForFunction(() => Windfall.ready);
  // Every channel is shown.
  for (const box of await page.locator(".tracks .chip input").all()) await box.check();
  const curves = await page.evaluate(() => Object.values(Windfall.views)[0].plots.length);
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const plot = page.locator(".channel .u-over").first();
  await plot.evaluate((e) => e.scrollIntoView({ block: "start" }));
  await page.evaluate(() => scrollBy(0, -60));
  await page.waitForTimeout(800);
  const box = await plot.boundingBox();
  const seen = await page.evaluate(() => Object.values(Windfall.views)[0].plots.filter((u) => { const b = u.root.getBoundingClientRect(); return b.bottom > 0 && b.top < innerHeight; }).length);
  console.log(`${SAMPLES} samples x ${CHANNELS} channels, ${curves} plots, ${seen} in sight at ${width} x ${height}`);
  const at = (f) => box.x + f * box.width;
  const y = box.y + 60;
  const frame = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => done())));
  await page.evaluate(() => Object.values(Windfall.views)[0].plots.forEach((u) => { (u.hooks.draw ??= []).push(() => { window.drawn += 1; }); }));
  const peers = await page.evaluateHandle(() => Object.values(Windfall.views)[0].plots.map((u) => {
    const line = u.over.appendChild(document.createElement("div"));
    line.style.cssText = "position:absolute;top:0;left:0;width:1px;height:100%;background:#888";
    return line;
  }));
  const peer = await measured(page, session, "peer", 90, (k, n) => page.evaluate(([lines, f]) => new Promise((done) => requestAnimationFrame(() => {
    for (const l of lines) l.style.transform = `translateX(${(f * l.parentNode.clientWidth).toFixed(0)}px)`;
    done();
  })), [peers, 0.05 + (0.9 * k) / n, k]));
  await page.evaluate((lines) => { for (const l of lines) l.remove(); }, peers);
  const all = [];
  all.push(await measured(page, session, "cursor", 90, async (k, n) => { await page.mouse.move(at(0.05 + (0.9 * k) / n), y); await frame(); }));
  await page.mouse.move(at(0.3), y);
  await page.mouse.down();
  all.push(await measured(page, session, "drag", 60, async (k, n) => { await page.mouse.move(at(0.3 + (0.4 * k) / n), y); await frame(); }));
  await page.mouse.up();
  const zoom = (a, b) => page.evaluate(([a, b]) => new Promise((done) => requestAnimationFrame(() => { Object.values(Windfall.views)[0].zoom([a, b]); done(); })), [a, b]);
  all.push(await measured(page, session, "zoom", 60, (k, n) => zoom((50 * k) / n, 109 - (50 * k) / n)));
  all.push(await measured(page, session, "pan", 90, (k, n) => zoom((60 * k) / n, 40 + (60 * k) / n)));
  const hold = (ok, words) => { if (!ok) { failed += 1; console.log(`FAIL ${words}`); } };
  for (const m of all) {
    const times = (m.busy / peer.busy).toFixed(1);
    hold(m.busy <= Math.max(FRAME_MS, PEER * peer.busy), `${m.name}: ${m.busy.toFixed(1)} ms of processor a frame, ${times} times the peer's; at most a frame's or ${PEER} times`);
    const most = ["cursor", "drag"].includes(m.name) ? STILL : seen;
    hold(m.drawn <= most, `${m.name}: ${m.drawn.toFixed(1)} plots drawn a frame, at most ${most}`);
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
process.exit(failed ? 1 : 0);
