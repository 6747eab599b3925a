"use strict";
// Just enough WebGL: matrices, meshes, one shader.
Windfall.gl = (() => {
  /** Product of two 4 × 4 matrices, column by column. */
  const mul = (a, b) => {
    const c = new Float32Array(16);
    for (let j = 0; j < 4; j += 1) for (let i = 0; i < 4; i += 1) {
      let s = 0;
      for (let k = 0; k < 4; k += 1) s += a[i + 4 * k] * b[k + 4 * j];
      c[i + 4 * j] = s;
    }
    return c;
  };
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const norm = (a) => Math.hypot(a[0], a[1], a[2]) || 1;
  const unit = (a) => { const n = norm(a); return [a[0] / n, a[1] / n, a[2] / n]; };
  const perspective = (angle, aspect, near, far) => {
    const f = 1 / Math.tan(angle / 2);
    return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0]);
  };
  const look = (eye, at, up) => {
    const z = unit(sub(eye, at));
    const x = unit(cross(up, z));
    const y = cross(z, x);
    const d = (v) => -(v[0] * eye[0] + v[1] * eye[1] + v[2] * eye[2]);
    return new Float32Array([x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, d(x), d(y), d(z), 1]);
  };
  /** Columns and a place as a matrix. */
  const frame = (x, y, z, p) => new Float32Array([...x, 0, ...y, 0, ...z, 0, ...p, 1]);
  /** A frame whose first axis goes from a to b, as long as that; sideways of that width. */
  const along = (a, b, width) => {
    const x = sub(b, a);
    const u = unit(x);
    const side = unit(cross(u, Math.abs(u[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
    const third = cross(u, side);
    return frame(x, side.map((v) => v * width), third.map((v) => v * width), a);
  };
  /** A body of revolution about x: places and radii along it; places and normals of its triangles. */
  const turned = (outline, sides = 24) => {
    const out = [];
    for (let k = 0; k + 1 < outline.length; k += 1) {
      const [[xa, ra], [xb, rb]] = [outline[k], outline[k + 1]];
      const slope = [-(rb - ra), xb - xa];
      const s = Math.hypot(...slope) || 1;
      for (let j = 0; j < sides; j += 1) {
        const [a, b] = [j, j + 1].map((n) => (2 * Math.PI * n) / sides);
        const p = (x, r, w) => [x, r * Math.cos(w), r * Math.sin(w), slope[0] / s, (slope[1] / s) * Math.cos(w), (slope[1] / s) * Math.sin(w)];
        for (const v of [p(xa, ra, a), p(xb, rb, a), p(xb, rb, b), p(xa, ra, a), p(xb, rb, b), p(xa, ra, b)]) out.push(...v);
      }
    }
    return out;
  };
  const sphere = (r = 1, n = 16) => turned(Array.from({ length: n + 1 }, (_, k) => {
    const w = (Math.PI * k) / n;
    return [-r * Math.cos(w), r * Math.sin(w)];
  }));
  const VERTEX = "attribute vec3 p; attribute vec3 n; uniform mat4 view; uniform mat4 place; varying vec3 normal;" +
    "void main() { normal = mat3(place) * n; gl_Position = view * place * vec4(p, 1.0); }";
  const FRAGMENT = "precision mediump float; uniform vec4 colour; uniform float lit; varying vec3 normal;" +
    "void main() { float l = length(normal); float d = l > 0.0 ? abs(dot(normal / l, normalize(vec3(0.4, 0.5, 0.77)))) : 1.0;" +
    "gl_FragColor = vec4(colour.rgb * mix(1.0, 0.45 + 0.55 * d, lit), colour.a); }";
  class Painter {
    constructor(canvas) {
      const gl = canvas.getContext("webgl", { alpha: false, antialias: true, preserveDrawingBuffer: true });
      if (!gl) throw new Error("no WebGL");
      this.gl = gl;
      const program = gl.createProgram();
      for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const s = gl.createShader(kind);
        gl.shaderSource(s, text);
        gl.compileShader(s);
        if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
        gl.attachShader(program, s);
      }
      gl.linkProgram(program);
      gl.useProgram(program);
      gl.enable(gl.DEPTH_TEST);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      this.at = Object.fromEntries(["p", "n"].map((k) => [k, gl.getAttribLocation(program, k)]));
      this.u = Object.fromEntries(["view", "place", "colour", "lit"].map((k) => [k, gl.getUniformLocation(program, k)]));
    }
    mesh(numbers, kind = "TRIANGLES") {
      const { gl } = this;
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
      return { buffer, count: numbers.length / 6, kind };
    }
    refill(mesh, numbers) {
      const { gl } = this;
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
      mesh.count = numbers.length / 6;
    }
    draw(mesh, place, colour, lit = 1) {
      const { gl, u, at } = this;
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
      gl.enableVertexAttribArray(at.p);
      gl.enableVertexAttribArray(at.n);
      gl.vertexAttribPointer(at.p, 3, gl.FLOAT, false, 24, 0);
      gl.vertexAttribPointer(at.n, 3, gl.FLOAT, false, 24, 12);
      gl.uniformMatrix4fv(u.place, false, place);
      gl.uniform4fv(u.colour, colour);
      gl.uniform1f(u.lit, mesh.kind === "TRIANGLES" ? lit : 0);
      gl.drawArrays(gl[mesh.kind], 0, mesh.count);
    }
  }
  return { mul, sub, unit, norm, perspective, look, frame, along, turned, sphere, Painter };
})();
