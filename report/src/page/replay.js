"use strict";
// The replay: measured and simulated body side by side, on the clock of the plots. Tunnel axes have X down; here the third axis points up.
(() => {
  const { make, colour, gl } = Windfall;
  const RAD = Math.PI / 180;
  /** Half the width of the tunnel across flats, m: twenty feet between opposite walls. */
  const TUNNEL_M = 3.048;
  /** Trail, s. */
  const TRAIL_S = 3;
  /** Lengths of arrows: m for a m/s, and m for the largest pull. */
  const AIR_M = 0.035;
  const PULL_M = 0.3;
  /** Tunnel axes to the picture's: Y right, Z into it, X down; a rotation, so that nothing is mirrored. */
  const picture = ([x, y, z]) => [y, -z, -x];
  const ONE = gl.frame([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]);

  /** Body to tunnel, Rx·Ry·Rz, as columns in the picture's axes. */
  function columns(rx, ry, rz) {
    const [a, b, c] = [rx, ry, rz].map((v) => [Math.cos(v * RAD), Math.sin(v * RAD)]);
    const t = [
      [b[0] * c[0], -b[0] * c[1], b[1]],
      [a[0] * c[1] + a[1] * b[1] * c[0], a[0] * c[0] - a[1] * b[1] * c[1], -a[1] * b[0]],
      [a[1] * c[1] - a[0] * b[1] * c[0], a[1] * c[0] + a[0] * b[1] * c[1], a[0] * b[0]],
    ];
    return [0, 1, 2].map((k) => picture([t[0][k], t[1][k], t[2][k]]));
  }

  /** Body to the picture's axes from roll, pitch and heading (deg): north to the right, east out of it, up. */
  function columnsOfNed(roll, pitch, heading) {
    const [[cf, sf], [ct, st], [cp, sp]] = [roll, pitch, heading].map((v) => [Math.cos(v * RAD), Math.sin(v * RAD)]);
    const ned = [
      [cp * ct, sp * ct, -st],
      [cp * st * sf - sp * cf, sp * st * sf + cp * cf, ct * sf],
      [cp * st * cf + sp * sf, sp * st * cf - cp * sf, ct * cf],
    ];
    return ned.map(([n, e, d]) => [n, -e, -d]);
  }
  /** A box about the origin with these half widths. */
  function box(hx, hy, hz) {
    const out = [];
    const faces = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
    const half = [hx, hy, hz];
    for (const [n, u, v] of faces) for (const side of [-1, 1]) {
      const corner = (a, b) => { const p = [0, 0, 0]; p[n] = side * half[n]; p[u] = a * half[u]; p[v] = b * half[v]; return p; };
      const normal = [0, 0, 0];
      normal[n] = side;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) out.push(...corner(a, b), ...normal);
    }
    return out;
  }

  Windfall.Replay = class {
    constructor(place, view) {
      this.view = view;
      this.body = view.tracks.body;
      this.camera = { turn: 0.6, lift: 0.25, far: 1 };
      this.speed = 1;
      this.canvas = make("canvas", { tabindex: 0, role: "img",
        "aria-label": "Replay in three dimensions. Space plays, arrow keys turn the camera, plus and minus move it, zero resets it." });
      this.painter = new gl.Painter(this.canvas);
      this.meshes();
      this.controls(place);
      this.reset();
      view.listeners.push((what) => { if (what === "run") this.reset(); this.ask(); });
      addEventListener("resize", () => this.ask());
      Windfall.themed.push(() => this.ask());
      this.seen = true;
      new IntersectionObserver(([e]) => { this.seen = e.isIntersecting; this.ask(); }).observe(this.canvas);
      this.ask();
    }
    controls(place) {
      this.button = make("button", { type: "button", class: "play", onclick: () => this.toggle() }, "Play");
      this.slider = make("input", { type: "range", min: 0, max: 1000, step: 1, value: 0, "aria-label": "Time in the run",
        oninput: (e) => this.seek((Number(e.target.value) / 1000) * this.view.end()) });
      const speeds = [0.1, 0.25, 0.5, 1, 2, 4].map((s) => make("option", { value: s, selected: s === 1 }, `× ${s}`));
      const speed = make("select", { "aria-label": "Speed", onchange: (e) => { this.speed = Number(e.target.value); } }, ...speeds);
      const near = make("button", { type: "button", onclick: () => { this.reset(); this.ask(); } }, "Near");
      const whole = make("button", { type: "button", onclick: () => { this.whole(); this.ask(); } }, "Whole tunnel");
      this.clock = make("output", { class: "clock" }, "0.00 s");
      const sides = this.sides().map((s) => make("span", { class: "side" }, make("span", { class: "key " + s }), this.view.side(s)));
      const stage = make("div", { class: "stage" }, this.canvas, make("div", { class: "sides" }, ...sides));
      this.stage = stage;
      const vectors = this.body.rigid ? "Arrows: green the air past the body, orange the tether's pull (of the model). " : "";
      const note = make("p", { class: "note" }, `${vectors}Line: the last ${TRAIL_S} s. Drag or arrow keys turn, wheel or + and − move, 0 resets, space plays. ` +
        (this.body.rigid ? "The body is drawn to its reference diameter; its shape is schematic."
          : this.body.free ? "Its shape is schematic, as wide as a disc of its reference area: dark nose, fin upward; larger where it would be too small to see. The faint line is the whole path."
            : "The body is drawn larger than it is where it would be too small to see. The faint line is the whole path."));
      const row = make("div", { class: "controls" }, this.button, this.slider, this.clock, speed, near, ...(this.body.rigid ? [whole] : []));
      place.replaceChildren(row, stage, note);
      this.hands();
    }
    hands() {
      const { canvas, camera } = this;
      let from = null;
      canvas.addEventListener("pointerdown", (e) => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
      canvas.addEventListener("pointermove", (e) => {
        if (!from) return;
        this.turn((from[0] - e.clientX) * 0.008, (e.clientY - from[1]) * 0.008);
        from = [e.clientX, e.clientY];
      });
      canvas.addEventListener("pointerup", () => { from = null; });
      canvas.addEventListener("wheel", (e) => { e.preventDefault(); camera.far *= Math.exp(e.deltaY * 0.001); this.ask(); }, { passive: false });
      canvas.addEventListener("keydown", (e) => {
        const act = { ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0), ArrowUp: () => this.turn(0, 0.1),
          ArrowDown: () => this.turn(0, -0.1), "+": () => { camera.far *= 0.85; }, "=": () => { camera.far *= 0.85; },
          "-": () => { camera.far /= 0.85; }, 0: () => this.reset(), " ": () => this.toggle() }[e.key];
        if (!act) return;
        e.preventDefault();
        act();
        this.ask();
      });
    }
    turn(by, up) {
      this.camera.turn += by;
      this.camera.lift = Math.max(-1.5, Math.min(1.5, this.camera.lift + up));
      this.ask();
    }
    sides() {
      const { tracks } = this.view;
      return ["measured", tracks.after ? "after" : "before"];
    }
    toggle() {
      this.playing = !this.playing;
      this.button.textContent = this.playing ? "Pause" : "Play";
      if (this.playing && this.view.t >= this.view.end() - 0.01) this.view.at(0, "replay");
      this.last = performance.now();
      this.ask();
    }
    seek(t) { this.view.at(t, "replay"); this.ask(); }
    series(name, side) {
      const c = this.view.runNow().channels.find((k) => k.name === name || k.name.startsWith(name + " "));
      return c && c[side].length ? c[side] : null;
    }
    /** Values of a side at a time, between its samples; none beyond its end. */
    read(names, side, t) {
      const times = this.view.runNow().t;
      let i = Math.floor((t / this.view.end()) * (times.length - 1));
      i = Math.max(0, Math.min(times.length - 2, i));
      while (i > 0 && times[i] > t) i -= 1;
      while (i < times.length - 2 && times[i + 1] <= t) i += 1;
      const f = (t - times[i]) / (times[i + 1] - times[i]);
      const all = names.map((n) => this.series(n, side));
      if (all.some((s) => s && s.length < i + 2)) return null;
      return all.map((s) => (s ? s[i] + f * (s[i + 1] - s[i]) : 0));
    }
    position(side, t) {
      const p = this.read(["X", "Y", "Z"], side, t);
      return p && picture(p);
    }
    reset() {
      const run = this.view.runNow();
      const low = [Infinity, Infinity, Infinity];
      const high = [-Infinity, -Infinity, -Infinity];
      for (let k = 0; k <= 100; k += 1) {
        const p = this.position("measured", (k / 100) * run.t[run.t.length - 1]);
        for (let a = 0; p && a < 3; a += 1) { low[a] = Math.min(low[a], p[a]); high[a] = Math.max(high[a], p[a]); }
      }
      const size = Math.max(...high.map((h, a) => h - low[a]), 1e-3);
      this.size = size;
      const d = this.body.diameter_m || 0.1;
      this.radius = this.body.rigid ? d / 2 : Math.max(d / 2, size / (this.body.free ? 24 : 60));
      Object.assign(this.camera, { turn: this.body.rigid ? 0.6 : 1.2, lift: 0.25, at: low.map((l, a) => 0.5 * (l + high[a])),
        far: 1.6 * size + 8 * this.radius });
    }
    whole() { Object.assign(this.camera, { far: 9.5, lift: 0.35, at: [0, 0, 0.8] }); }
    meshes() {
      const { painter, body } = this;
      const d = body.diameter_m || 0.1;
      const disc = (x, r, thick) => gl.turned([[x - thick, 0], [x - thick, r], [x + thick, r], [x + thick, 0]], 36);
      this.parts = body.rigid ? [
        { mesh: painter.mesh(gl.sphere(0.3 * d)), tint: 1 },
        { mesh: painter.mesh(disc(-0.32 * d, 0.5 * d, 0.02 * d)), tint: 0.8 },
      ] : body.free ? [
        { mesh: painter.mesh(box(1, 0.5, 0.3)), tint: 1 },
        { mesh: painter.mesh(gl.turned([[1, 0.3], [1.4, 0]], 16)), tint: 0.45 },
        { mesh: painter.mesh(box(0.3, 0.03, 0.3).map((v, i) => (i % 6 === 0 ? v - 0.7 : i % 6 === 2 ? v - 0.6 : v))), tint: 0.45 },
      ] : [{ mesh: painter.mesh(gl.sphere(1)), tint: 1 }];
      this.whole_path = painter.mesh([], "LINE_STRIP");
      this.rod = painter.mesh(gl.turned([[0, 0], [0, 1], [1, 1], [1, 0]], 8));
      this.head = painter.mesh(gl.turned([[0, 0], [0, 2.4], [1, 0]], 12));
      this.ball = painter.mesh(gl.sphere(1, 10));
      this.lines = painter.mesh([], "LINES");
      this.trail = painter.mesh([], "LINE_STRIP");
      const walls = [];
      const push = (a, b) => walls.push(...a, 0, 0, 0, ...b, 0, 0, 0);
      const corner = (k, up) => [TUNNEL_M / Math.cos(Math.PI / 12) * Math.cos((k + 0.5) * Math.PI / 6), TUNNEL_M / Math.cos(Math.PI / 12) * Math.sin((k + 0.5) * Math.PI / 6), up];
      for (let k = 0; k < 12; k += 1) {
        push(corner(k, -1.5), corner(k, 3.4));
        for (const up of [-1.5, 0, 1.7, 3.4]) push(corner(k, up), corner(k + 1, up));
      }
      if (!body.rigid) walls.length = 0;
      this.walls = painter.mesh(walls, "LINES");
      const ring = [];
      for (let k = 0; k < 24; k += 1) for (const n of [k, k + 1]) ring.push(0.06 * Math.cos(n * Math.PI / 12), 0.06 * Math.sin(n * Math.PI / 12), 0, 0, 0, 0);
      this.ring = painter.mesh(ring, "LINES");
    }
    ask() {
      if (this.asked) return;
      this.asked = true;
      requestAnimationFrame((now) => { this.asked = false; this.step(now); });
    }
    step(now) {
      if (this.playing) {
        const t = this.view.t + (this.speed * Math.min(200, now - this.last)) / 1000;
        this.last = now;
        this.view.at(t, "replay");
        if (t >= this.view.end()) this.toggle();
        this.ask();
      }
      this.slider.value = Math.round((this.view.t / this.view.end()) * 1000);
      this.slider.setAttribute("aria-valuetext", `${this.view.t.toFixed(2)} s`);
      this.clock.textContent = `${this.view.t.toFixed(2)} s of ${this.view.end().toFixed(2)} s`;
      // Out of sight it is not painted.
      if (this.seen) this.paint();
      Windfall.frames = (Windfall.frames || 0) + 1;
    }
    paint() {
      const { canvas, painter } = this;
      const g = painter.gl;
      const [w, h] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * Math.min(2, devicePixelRatio)));
      if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
      const tall = canvas.clientWidth < 560;
      this.stage.classList.toggle("tall", tall);
      const ground = this.rgb("shade");
      g.clearColor(ground[0], ground[1], ground[2], 1);
      g.viewport(0, 0, w, h);
      g.disable(g.SCISSOR_TEST);
      g.clear(g.COLOR_BUFFER_BIT | g.DEPTH_BUFFER_BIT);
      this.sides().forEach((side, k) => {
        const [pw, ph] = tall ? [w, h / 2] : [w / 2, h];
        g.viewport(tall ? 0 : k * pw, tall ? (1 - k) * ph : 0, pw, ph);
        this.scene(side, pw / ph);
      });
    }
    rgb(name, alpha = 1) {
      const text = colour(name).replace("#", "");
      return [0, 2, 4].map((k) => parseInt(text.slice(k, k + 2), 16) / 255).concat(alpha);
    }
    scene(side, aspect) {
      const { camera: c, painter } = this;
      const out = [Math.cos(c.lift) * Math.sin(c.turn), -Math.cos(c.lift) * Math.cos(c.turn), Math.sin(c.lift)];
      const eye = c.at.map((v, k) => v + c.far * out[k]);
      const eyeView = gl.mul(gl.perspective(0.75, aspect, 0.02 * c.far, 40 * c.far + 20), gl.look(eye, c.at, [0, 0, 1]));
      painter.gl.uniformMatrix4fv(painter.u.view, false, eyeView);
      painter.draw(this.walls, ONE, this.rgb("soft", 0.45));
      this.grid(c);
      const t = this.view.t;
      if (!this.body.rigid) this.wholePath(side);
      this.path(side, t);
      const p = this.position(side, t);
      if (!p) return;
      if (this.body.rigid) this.lander(side, t, p);
      else if (this.body.free) this.flyer(side, t, p);
      else painter.draw(this.parts[0].mesh, gl.frame([this.radius, 0, 0], [0, this.radius, 0], [0, 0, this.radius], p), this.rgb(side));
    }
    /** A level grid below the motion, a metre or a tenth of it a square. */
    grid(c) {
      const square = this.body.rigid ? 0.5 : 10 ** Math.floor(Math.log10(this.size));
      const [x, y] = c.at.map((v) => Math.round(v / square) * square);
      const level = this.body.rigid ? -1.5 : c.at[2] - 0.6 * this.size;
      const all = [];
      for (let k = -6; k <= 6; k += 1) {
        all.push(x + k * square, y - 6 * square, level, 0, 0, 0, x + k * square, y + 6 * square, level, 0, 0, 0);
        all.push(x - 6 * square, y + k * square, level, 0, 0, 0, x + 6 * square, y + k * square, level, 0, 0, 0);
      }
      this.painter.refill(this.lines, all);
      this.painter.draw(this.lines, ONE, this.rgb("soft", 0.3));
    }
    /** The path of the whole run. */
    wholePath(side) {
      const all = [];
      for (let k = 0; k <= 150; k += 1) {
        const p = this.position(side, (this.view.end() * k) / 150);
        if (p) all.push(...p, 0, 0, 0);
      }
      if (all.length < 12) return;
      this.painter.refill(this.whole_path, all);
      this.painter.draw(this.whole_path, ONE, this.rgb(side, 0.45));
    }
    /** A rigid body in free flight. */
    flyer(side, t, p) {
      const angles = this.read(["roll", "pitch", "heading"], side, t);
      if (!angles) return;
      const axes = columnsOfNed(...angles).map((a) => a.map((v) => v * this.radius));
      const base = this.rgb(side);
      for (const part of this.parts) this.painter.draw(part.mesh, gl.frame(...axes, p), [...base.slice(0, 3).map((v) => v * part.tint), 1]);
    }
    path(side, t) {
      const all = [];
      for (let k = 0; k <= 90; k += 1) {
        const s = t - TRAIL_S * (1 - k / 90);
        const p = s >= 0 ? this.position(side, s) : null;
        if (p) all.push(...p, 0, 0, 0);
      }
      if (all.length < 12) return;
      this.painter.refill(this.trail, all);
      this.painter.draw(this.trail, ONE, this.rgb(side, 0.9));
    }
    lander(side, t, p) {
      const { painter, body } = this;
      const angles = this.read(["Rx", "Ry", "Rz"], side, t);
      if (!angles) return;
      const axes = columns(...angles);
      const point = (b) => [0, 1, 2].map((k) => p[k] + b[0] * axes[0][k] + b[1] * axes[1][k] + b[2] * axes[2][k]);
      const place = gl.frame(...axes, p);
      const base = this.rgb(side);
      for (const part of this.parts) painter.draw(part.mesh, place, [...base.slice(0, 3).map((v) => v * part.tint), 1]);
      const d = body.diameter_m;
      for (let k = 0; k < 4; k += 1) {
        const [co, si] = [Math.cos(k * Math.PI / 2), Math.sin(k * Math.PI / 2)];
        const [a, b] = [[0.12 * d, 0.28 * d * co, 0.28 * d * si], [0.3 * d, 0.62 * d * co, 0.62 * d * si]].map(point);
        // One outrigger is dark, so that roll can be seen.
        const tint = k === 0 ? this.rgb("ink") : base;
        painter.draw(this.rod, gl.along(a, b, 0.02 * d), tint);
        painter.draw(this.ball, gl.frame([0.05 * d, 0, 0], [0, 0.05 * d, 0], [0, 0, 0.05 * d], b), tint);
      }
      if (body.attachment_m && body.ring_m) this.tether(side, t, point);
      this.air(side, t, p);
    }
    tether(side, t, point) {
      const { painter, body } = this;
      const [hook, ring] = [point(body.attachment_m), picture(body.ring_m)];
      painter.draw(this.rod, gl.along(hook, ring, 0.004), this.rgb("soft"));
      painter.draw(this.rod, gl.along(point([0, 0, 0]), hook, 0.006), this.rgb("soft"));
      painter.draw(this.ring, gl.frame([1, 0, 0], [0, 1, 0], [0, 0, 1], ring), this.rgb("ink"));
      const pull = this.series("tether", side) && this.read(["tether"], side, t);
      if (!pull) return;
      const all = this.series("tether", side);
      const most = this.most?.of === all ? this.most.value : Math.max(...all.map(Math.abs));
      this.most = { of: all, value: most };
      const u = gl.unit(gl.sub(ring, hook));
      const length = PULL_M * (pull[0] / (most || 1));
      this.arrow(hook, hook.map((v, k) => v + u[k] * length), this.rgb("pull"));
    }
    air(side, t, p) {
      const dt = 0.04;
      const [a, b] = [this.position(side, t - dt), this.position(side, t + dt)];
      const wind = this.read(["V_W"], "measured", t);
      if (!a || !b || !wind) return;
      // The tunnel's air goes up.
      const past = [0, 1, 2].map((k) => (k === 2 ? wind[0] : 0) - (b[k] - a[k]) / (2 * dt));
      const from = p.map((v, k) => v - AIR_M * past[k] - 0.06 * past[k] / gl.norm(past));
      this.arrow(from, p.map((v, k) => v - 0.12 * past[k] / gl.norm(past)), this.rgb("air"));
    }
    arrow(a, b, tint) {
      const long = gl.norm(gl.sub(b, a));
      if (long < 1e-3) return;
      const thin = 0.012;
      const u = gl.unit(gl.sub(b, a));
      const neck = b.map((v, k) => v - u[k] * Math.min(0.05, 0.4 * long));
      this.painter.draw(this.rod, gl.along(a, neck, thin / 2), tint);
      this.painter.draw(this.head, gl.along(neck, b, thin / 1.4), tint);
    }
  };
})();
