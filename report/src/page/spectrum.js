"use strict";
// Amplitude spectra of what is shown of a run: sine taper, straight line taken out, means over bands even on a logarithmic axis.
Windfall.spectrum = (() => {
  const BANDS = 90;
  /** Fourier transform in place, length a power of two. */
  function transform(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i += 1) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) { [re[i], re[j]] = [re[j], re[i]]; [im[i], im[j]] = [im[j], im[i]]; }
    }
    for (let size = 2; size <= n; size *= 2) {
      const angle = (-2 * Math.PI) / size;
      for (let k = 0; k < size / 2; k += 1) {
        const [c, s] = [Math.cos(angle * k), Math.sin(angle * k)];
        for (let i = k; i < n; i += size) {
          const j = i + size / 2;
          const [x, y] = [re[j] * c - im[j] * s, re[j] * s + im[j] * c];
          [re[j], im[j]] = [re[i] - x, im[i] - y];
          re[i] += x;
          im[i] += y;
        }
      }
    }
  }
  /** Values between two times on an even clock: as recorded where the clock is even, otherwise on straight lines between samples. */
  function even(t, y, [a, b]) {
    const at = [];
    const values = [];
    for (let i = 0; i < Math.min(t.length, y.length); i += 1) {
      if (t[i] >= a && t[i] <= b && Number.isFinite(y[i])) { at.push(t[i]); values.push(y[i]); }
    }
    const n = values.length;
    if (n < 16) return null;
    const dt = (at[n - 1] - at[0]) / (n - 1);
    if (at.every((v, i) => Math.abs(v - at[0] - i * dt) < 0.1 * dt)) return { values, dt };
    let k = 0;
    const on = values.map((_, i) => {
      const when = at[0] + i * dt;
      while (k < n - 2 && at[k + 1] < when) k += 1;
      return values[k] + ((values[k + 1] - values[k]) * (when - at[k])) / (at[k + 1] - at[k]);
    });
    return { values: on, dt };
  }
  /** Frequencies (Hz) and amplitude spectral density (unit per √Hz), one-sided. */
  function density(t, y, range) {
    const record = even(t, y, range);
    if (!record) return null;
    const { values, dt } = record;
    const n = values.length;
    const middle = (n - 1) / 2;
    const mean = values.reduce((s, v) => s + v, 0) / n;
    let [across, along] = [0, 0];
    values.forEach((v, i) => { across += (i - middle) * (v - mean); along += (i - middle) ** 2; });
    const size = 2 ** Math.ceil(Math.log2(n));
    const [re, im] = [new Float64Array(size), new Float64Array(size)];
    let power = 0;
    values.forEach((v, i) => {
      const w = Math.sin((Math.PI * (i + 0.5)) / n);
      power += w * w;
      re[i] = w * (v - mean - (across / along) * (i - middle));
    });
    transform(re, im);
    const low = 1 / (n * dt);
    const ratio = Math.log(0.5 / dt / low);
    const sums = Array.from({ length: BANDS }, () => [0, 0, 0]);
    for (let k = 1; k <= size / 2; k += 1) {
      const f = k / (size * dt);
      if (f < low) continue;
      const band = Math.min(BANDS - 1, Math.floor((Math.log(f / low) / ratio) * BANDS));
      const s = sums[band];
      s[0] += f;
      s[1] += (2 * dt * (re[k] * re[k] + im[k] * im[k])) / power;
      s[2] += 1;
    }
    const filled = sums.filter((s) => s[2]);
    return [filled.map((s) => s[0] / s[2]), filled.map((s) => Math.sqrt(s[1] / s[2]))];
  }
  return { density };
})();
