"use strict";
// Turns the deformed surface of a drive: drag to rotate, wheel or two fingers to zoom. Needs WebGL 2.
(function () {
  const root = document.getElementById("scene"), canvas = root.querySelector("canvas");
  const data = JSON.parse(document.getElementById("scene-data").textContent);
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) { root.querySelector(".note").textContent = "This browser has no WebGL 2: the view cannot be shown."; return; }
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  const compile = (kind, text) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text); gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, `#version 300 es
    in vec3 place, shift; in float value; uniform mat3 turn; uniform vec3 low, span, reach, view; uniform vec2 pan;
    uniform vec2 image; uniform float factor, zoom, aspect; out vec3 seen; out float v;
    void main() {
      vec3 p = low + span * place + factor * reach * shift;
      p.xy = mat2(image, -image.y, image.x) * p.xy; seen = turn * (p - view); v = value;
      gl_Position = vec4((seen.xy * zoom + pan) * vec2(min(1.0, 1.0 / aspect), min(1.0, aspect)), -seen.z * zoom * 0.2, 1.0);
    }`));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float; in vec3 seen; in float v; out vec4 colour;
    vec3 turbo(float x) {
      const vec4 r = vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234), g = vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333),
        b = vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771);
      const vec2 r2 = vec2(-152.94239396, 59.28637943), g2 = vec2(4.27729857, 2.82956604), b2 = vec2(-89.90310912, 27.34824973);
      vec4 a = vec4(1.0, x, x * x, x * x * x); vec2 c = a.zw * a.z;
      return vec3(dot(a, r) + dot(c, r2), dot(a, g) + dot(c, g2), dot(a, b) + dot(c, b2));
    }
    void main() {
      vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      colour = vec4(clamp(turbo(clamp(v, 0.0, 1.0)), 0.0, 1.0) * (0.45 + 0.55 * abs(n.z)), 1.0);
    }`));
  gl.linkProgram(program); gl.useProgram(program); gl.enable(gl.DEPTH_TEST);
  const uniform = name => gl.getUniformLocation(program, name);
  const bodies = data.bodies.map(body => {
    const array = gl.createVertexArray(), sector = new Uint32Array(bytes(body.faces)), all = new Uint32Array(sector.length * body.sectors);
    for (let k = 0; k < body.sectors; k++) for (let i = 0; i < sector.length; i++) all[k * sector.length + i] = sector[i] + k * body.stride;
    gl.bindVertexArray(array);
    [["place", body.points, Uint16Array, gl.UNSIGNED_SHORT, 3], ["shift", body.shifts, Int16Array, gl.SHORT, 3], ["value", body.values, Uint8Array, gl.UNSIGNED_BYTE, 1]]
      .forEach(([name, text, Kind, type, size]) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, new Kind(bytes(text)), gl.STATIC_DRAW);
        const where = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(where); gl.vertexAttribPointer(where, size, type, true, 0, 0);
      });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, all, gl.STATIC_DRAW);
    return { array, count: all.length, low: body.low, span: body.span, reach: body.reach, shown: true };
  });
  let turn = data.plane ? [1, 0, 0, 0, 1, 0, 0, 0, 1] : multiply(about(0, -0.5), about(1, Math.PI - 0.6)), zoom = 0.9 / data.radius, pan = [0, 0], factor = 1;
  function about(axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle);
    return axis === 0 ? [1, 0, 0, 0, c, -s, 0, s, c] : [c, 0, s, 0, 1, 0, -s, 0, c];
  }
  function multiply(a, b) {
    const m = [];
    for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) m.push(a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]);
    return m;
  }
  function draw() {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio; canvas.height = canvas.clientHeight * ratio;
    gl.viewport(0, 0, canvas.width, canvas.height); gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(uniform("turn"), true, turn); gl.uniform1f(uniform("zoom"), zoom); gl.uniform2fv(uniform("pan"), pan);
    gl.uniform1f(uniform("aspect"), canvas.width / canvas.height); gl.uniform1f(uniform("factor"), factor);
    gl.uniform3fv(uniform("view"), data.centre);
    for (const body of bodies) if (body.shown) {
      gl.bindVertexArray(body.array);
      for (const name of ["low", "span", "reach"]) gl.uniform3fv(uniform(name), body[name]);
      for (let copy = 0; copy < data.copies; copy++) {
        const angle = 2 * Math.PI * copy / data.copies; gl.uniform2f(uniform("image"), Math.cos(angle), Math.sin(angle)); gl.drawElements(gl.TRIANGLES, body.count, gl.UNSIGNED_INT, 0);
      }
    }
  }
  const held = new Map();
  let apart = 0;
  const spread = () => { const [a, b] = [...held.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.addEventListener("pointerdown", e => { held.set(e.pointerId, [e.clientX, e.clientY]); canvas.setPointerCapture(e.pointerId); if (held.size === 2) apart = spread(); });
  canvas.addEventListener("pointermove", e => {
    if (!held.has(e.pointerId)) return;
    const [x, y] = held.get(e.pointerId), dx = e.clientX - x, dy = e.clientY - y;
    held.set(e.pointerId, [e.clientX, e.clientY]);
    if (held.size === 2) { const d = spread(); zoom *= d / apart; apart = d; }
    else if (e.shiftKey || data.plane) { const w = 2 / Math.min(canvas.clientWidth, canvas.clientHeight); pan = [pan[0] + dx * w, pan[1] - dy * w]; }
    else turn = multiply(multiply(about(0, dy * 0.008), about(1, dx * 0.008)), turn);
    draw();
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, e => held.delete(e.pointerId));
  canvas.addEventListener("wheel", e => { e.preventDefault(); const by = Math.exp(-0.0015 * e.deltaY); zoom *= by; pan = [pan[0] * by, pan[1] * by]; draw(); }, { passive: false });
  root.querySelectorAll("input[type=checkbox]").forEach((box, k) => box.addEventListener("change", () => { bodies[k].shown = box.checked; draw(); }));
  const slider = root.querySelector("input[type=range]");
  slider.addEventListener("input", () => { factor = Number(slider.value); root.querySelector("output").textContent = "× " + factor; draw(); });
  window.addEventListener("resize", draw);
  draw();
})();
