"use strict";
// The deformed drive in WebGL 2, with sections, increments and the value under the pointer.
(function () {
  const root = document.getElementById("scene"), canvas = root.querySelector("canvas");
  const data = JSON.parse(document.getElementById("scene-data").textContent);
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  const find = name => root.querySelector("." + name);
  if (!gl) {
    find("note").textContent = "This browser has no WebGL 2: the view cannot be shown.";
    return;
  }
  const hasFloats = gl.getExtension("EXT_color_buffer_float");

  // ---- numbers of the page
  const decode = (text, Kind) => new Kind(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
  const GREY = 1e30; // value of a body that has none
  const bodies = data.bodies.map((given, index) => {
    const points = given.points && decode(given.points, Float32Array);
    const faces = decode(given.faces, Uint32Array), cells = decode(given.cells, Uint32Array);
    const stride = points ? points.length / 3 : 0;
    return { ...given, index, points, faces, cells, stride, shown: true, cuts: [] };
  });
  const middle = 0.5 * (data.ends[0] + data.ends[1]);
  const state = { factor: 1, increment: data.increments.length - 1, colour: 0, section: "none" };
  let turn, zoom, pan;

  // Undeformed places of all sectors: those of the first one, turned about the axis.
  function allSectors(body) {
    const places = new Float32Array(3 * body.stride * body.sectors);
    for (let k = 0; k < body.sectors; k++) {
      const angle = 2 * Math.PI * k / (body.sectors * body.copies);
      const c = Math.cos(angle), s = Math.sin(angle);
      for (let i = 0; i < body.points.length; i += 3) {
        const [x, y, z] = body.points.subarray(i, i + 3), at = k * body.points.length + i;
        places[at] = c * x - s * y; places[at + 1] = s * x + c * y; places[at + 2] = z;
      }
    }
    return places;
  }

  function place(body, given) { // deformed places (mm) of all nodes at the increment
    if (given.points) return decode(given.points, Float32Array);
    body.still ||= allSectors(body);
    const shifts = decode(given.shifts, Int16Array), places = Float32Array.from(body.still);
    const scale = given.reach.map(reach => state.factor * reach / 32767);
    for (let i = 0; i < places.length; i++) places[i] += scale[i % 3] * shifts[i];
    return places;
  }

  function value(body, given) {
    const field = given.values && given.values[state.colour];
    if (!field) return new Float32Array(body.places.length / 3).fill(GREY);
    return Float32Array.from(decode(field.values, Uint16Array), v => v * field.most / 65535);
  }

  // ---- drawing
  const compile = (kind, text) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text); gl.compileShader(shader);
    const done = gl.getShaderParameter(shader, gl.COMPILE_STATUS);
    if (!done) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, `#version 300 es
    layout(location = 0) in vec3 place; layout(location = 1) in float value;
    uniform mat3 turn; uniform vec2 image, pan, aspect; uniform float zoom, reach, middle;
    out vec3 seen, whole; out float v;
    void main() {
      whole = vec3(mat2(image, -image.y, image.x) * place.xy, place.z);
      seen = turn * (whole - vec3(0.0, 0.0, middle)); v = value;
      // the depth does not depend on the zoom: nothing is cut off
      gl_Position = vec4((seen.xy * zoom + pan) * aspect, -seen.z / reach, 1.0);
    }`));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float; in vec3 seen, whole; in float v; out vec4 colour;
    uniform vec4 plane; uniform float limit, part; uniform bool cut, pick;
    vec3 turbo(float x) {
      const vec4 r = vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234),
        g = vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333),
        b = vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771);
      const vec2 r2 = vec2(-152.94239396, 59.28637943), g2 = vec2(4.27729857, 2.82956604),
        b2 = vec2(-89.90310912, 27.34824973);
      vec4 a = vec4(1.0, x, x * x, x * x * x); vec2 c = a.zw * a.z;
      return vec3(dot(a, r) + dot(c, r2), dot(a, g) + dot(c, g2), dot(a, b) + dot(c, b2));
    }
    void main() {
      if (cut && dot(whole, plane.xyz) > plane.w) discard;
      if (pick) { colour = vec4(v, seen.z, part, 1.0); return; }
      vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      vec3 base = v > 1e29 ? vec3(0.82) : clamp(turbo(clamp(v / limit, 0.0, 1.0)), 0.0, 1.0);
      colour = vec4(base * (0.45 + 0.55 * abs(n.z)), 1.0);
    }`));
  gl.linkProgram(program); gl.useProgram(program); gl.enable(gl.DEPTH_TEST);
  const uniforms = new Map();
  const uniform = name => {
    if (!uniforms.has(name)) uniforms.set(name, gl.getUniformLocation(program, name));
    return uniforms.get(name);
  };

  function fill(mesh, places, values, faces) { // hands a mesh to the graphics card
    mesh.array ||= gl.createVertexArray(); gl.bindVertexArray(mesh.array);
    [places, values].forEach((numbers, k) => {
      mesh.buffers ||= [gl.createBuffer(), gl.createBuffer(), gl.createBuffer()];
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffers[k]);
      gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, k === 0 ? 3 : 1, gl.FLOAT, false, 0, 0);
    });
    if (faces) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.buffers[2]);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
      mesh.count = faces.length;
    }
  }

  function allFaces(body) {
    const faces = new Uint32Array(body.faces.length * body.sectors);
    for (let k = 0; k < faces.length; k++) {
      const sector = Math.floor(k / body.faces.length);
      faces[k] = body.faces[k % body.faces.length] + sector * body.stride;
    }
    return faces;
  }

  // The plane of the section: what lies on the side of its normal is left out.
  function plane() {
    const slider = find("at"), share = Number(slider.value);
    if (state.section === "across") {
      const z = data.ends[0] + share * (data.ends[1] - data.ends[0]);
      return { normal: [0, 0, -1], at: -z, text: `z = ${z.toFixed(2)} mm` };
    }
    const angle = 2 * Math.PI * share + data.increments[state.increment].turn;
    const text = `${(360 * share).toFixed(0)}° from the major axis`;
    return { normal: [-Math.cos(angle), -Math.sin(angle), 0], at: 0, text };
  }

  function image(body, copy) {
    const angle = 2 * Math.PI * copy / body.copies;
    return [Math.cos(angle), Math.sin(angle)];
  }

  function cut() { // the faces of the bodies in the plane of the section
    const { normal, at, text } = plane();
    find("where").textContent = state.section === "none" ? "" : text;
    for (const body of bodies) for (let copy = 0; copy < body.copies; copy++) {
      const mesh = body.cuts[copy] ||= {};
      mesh.count = 0;
      if (state.section === "none" || !body.places || !body.shown) continue;
      const [c, s] = image(body, copy), places = body.places, count = places.length / 3;
      const nx = c * normal[0] + s * normal[1], ny = c * normal[1] - s * normal[0];
      const distance = new Float32Array(count);
      for (let i = 0; i < count; i++) {
        const [x, y, z] = places.subarray(3 * i, 3 * i + 3);
        distance[i] = nx * x + ny * y + normal[2] * z - at;
      }
      const { ends, share } = cutCells(body.cells, body.sectors, body.stride, distance);
      const between = (values, width) => {
        const found = new Float32Array(width * share.length);
        for (let k = 0; k < found.length; k++) {
          const corner = Math.floor(k / width), i = k % width;
          const a = values[width * ends[2 * corner] + i];
          found[k] = a + share[corner] * (values[width * ends[2 * corner + 1] + i] - a);
        }
        return found;
      };
      fill(mesh, between(places, 3), between(body.values, 1));
      mesh.count = share.length;
    }
    draw();
  }

  function update() { // after another increment, field or magnification
    const now = data.increments[state.increment], colour = data.colours[state.colour];
    bodies.forEach((body, k) => {
      const given = now.bodies[k];
      body.places = given && place(body, given);
      if (!given) return;
      body.values = value(body, given);
      fill(body, body.places, body.values, body.count ? null : allFaces(body));
    });
    find("increment").textContent = now.label;
    find("factor").textContent = "× " + state.factor;
    find("title").textContent = colour.title;
    find("limit").textContent = colour.limit.toPrecision(4) + " and more";
    cut();
  }

  const size = () => data.radius + Math.max(0, state.factor - 1) * data.moved;
  const aspect = () => {
    const wide = canvas.width / canvas.height;
    return [Math.min(1, 1 / wide), Math.min(1, wide)];
  };

  function render(pick) {
    const clip = plane();
    gl.uniformMatrix3fv(uniform("turn"), true, turn); gl.uniform2fv(uniform("pan"), pan);
    gl.uniform1f(uniform("zoom"), zoom); gl.uniform2fv(uniform("aspect"), aspect());
    gl.uniform1f(uniform("reach"), 2 * size()); gl.uniform1f(uniform("middle"), middle);
    gl.uniform1f(uniform("limit"), data.colours[state.colour].limit);
    gl.uniform4f(uniform("plane"), ...clip.normal, clip.at); gl.uniform1i(uniform("pick"), pick);
    for (const body of bodies) if (body.shown && body.places) {
      gl.uniform1f(uniform("part"), body.index + 1);
      for (let copy = 0; copy < body.copies; copy++) {
        gl.uniform2fv(uniform("image"), image(body, copy));
        gl.uniform1i(uniform("cut"), state.section !== "none"); gl.bindVertexArray(body.array);
        gl.drawElements(gl.TRIANGLES, body.count, gl.UNSIGNED_INT, 0);
        const mesh = body.cuts[copy];
        if (!mesh.count) continue;
        gl.uniform1i(uniform("cut"), false); gl.bindVertexArray(mesh.array);
        gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
      }
    }
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio; canvas.height = canvas.clientHeight * ratio;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height); gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    render(false);
  }

  // ---- the value under the pointer: one pixel of a second picture that holds numbers
  let picked;
  function read(x, y) {
    const width = canvas.width, height = canvas.height;
    if (!picked || picked.width !== width || picked.height !== height) {
      picked = { width, height, frame: gl.createFramebuffer() };
      gl.bindFramebuffer(gl.FRAMEBUFFER, picked.frame);
      for (const [attachment, kind] of [
        [gl.COLOR_ATTACHMENT0, gl.RGBA32F], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24],
      ]) {
        const buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, kind, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
      }
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, picked.frame);
    gl.enable(gl.SCISSOR_TEST); gl.scissor(x, y, 1, 1); gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    render(true);
    const found = new Float32Array(4);
    gl.readPixels(x, y, 1, 1, gl.RGBA, gl.FLOAT, found);
    gl.disable(gl.SCISSOR_TEST); gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return found;
  }

  function tell(event) {
    const box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
    const x = Math.floor((event.clientX - box.left) * ratio);
    const y = Math.floor((box.bottom - event.clientY) * ratio);
    const [v, depth, part] = hasFloats ? read(x, y) : [0, 0, 0];
    if (!part) { find("value").textContent = "\u00a0"; return; }
    const wide = aspect(), body = bodies[part - 1];
    const seen = [2 * (x + 0.5) / canvas.width - 1, 2 * (y + 0.5) / canvas.height - 1]
      .map((ndc, i) => (ndc / wide[i] - pan[i]) / zoom);
    seen.push(depth);
    const along = i => seen.reduce((sum, s, k) => sum + turn[3 * k + i] * s, 0);
    const px = along(0), py = along(1), z = (along(2) + middle).toFixed(2);
    let angle = (Math.atan2(-px, py) - data.increments[state.increment].turn) * 180 / Math.PI;
    angle -= 360 * Math.round(angle / 360);
    const number = v > 1e29 ? "" : ` ${v.toPrecision(4)} MPa,`;
    const where = `${angle.toFixed(1)}° from the major axis` + (data.plane ? "" : `, z ${z} mm`);
    find("value").textContent =
      `${body.name}:${number} radius ${Math.hypot(px, py).toFixed(2)} mm, ${where}`;
  }

  // ---- the pointer
  function rotation(axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle);
    return axis === 0 ? [1, 0, 0, 0, c, -s, 0, s, c] : [c, 0, s, 0, 1, 0, -s, 0, c];
  }
  function multiply(a, b) {
    return a.map((_, k) => {
      const row = 3 * Math.floor(k / 3), column = k % 3;
      return a[row] * b[column] + a[row + 1] * b[column + 3] + a[row + 2] * b[column + 6];
    });
  }
  function reset() {
    turn = data.plane ? [1, 0, 0, 0, 1, 0, 0, 0, 1]
      : multiply(rotation(0, -0.5), rotation(1, Math.PI - 0.6));
    zoom = 0.97 / size(); pan = [0, 0];
  }
  function zoomBy(by, event) { // what is under the pointer stays there
    const box = canvas.getBoundingClientRect(), half = 0.5 * Math.min(box.width, box.height);
    const x = event.clientX - box.left - 0.5 * box.width;
    const y = box.top + 0.5 * box.height - event.clientY, at = [x / half, y / half];
    pan = pan.map((p, i) => at[i] + (p - at[i]) * by); zoom *= by;
  }
  const held = new Map();
  const spread = () => {
    const [a, b] = [...held.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  let apart = 0, waiting = false;
  canvas.addEventListener("pointerdown", e => {
    held.set(e.pointerId, [e.clientX, e.clientY]); canvas.setPointerCapture(e.pointerId);
    if (held.size === 2) apart = spread(); else tell(e);
  });
  canvas.addEventListener("pointermove", e => {
    if (!held.has(e.pointerId)) {
      if (!waiting) { waiting = true; requestAnimationFrame(() => { waiting = false; tell(e); }); }
      return;
    }
    const [x, y] = held.get(e.pointerId), dx = e.clientX - x, dy = e.clientY - y;
    held.set(e.pointerId, [e.clientX, e.clientY]);
    if (held.size === 2) { const now = spread(); zoomBy(now / apart, e); apart = now; }
    else if (e.shiftKey || data.plane) {
      const share = 2 / Math.min(canvas.clientWidth, canvas.clientHeight);
      pan = [pan[0] + dx * share, pan[1] - dy * share];
    } else turn = multiply(multiply(rotation(0, dy * 0.008), rotation(1, dx * 0.008)), turn);
    draw();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, e => held.delete(e.pointerId));
  }
  canvas.addEventListener("wheel", e => {
    e.preventDefault(); zoomBy(Math.exp(-0.0015 * e.deltaY), e); draw();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { reset(); draw(); });

  // ---- the controls
  root.querySelectorAll("input[type=checkbox]").forEach((box, k) => {
    box.addEventListener("change", () => { bodies[k].shown = box.checked; cut(); });
  });
  const listen = (name, act) => find(name).addEventListener("input", e => act(e.target.value));
  listen("choose-colour", text => { state.colour = Number(text); update(); });
  listen("choose-factor", text => {
    const before = size();
    state.factor = Number(text); zoom *= before / size(); update();
  });
  let playing = 0;
  const show = number => { state.increment = number; update(); };
  const stop = () => { clearInterval(playing); playing = 0; find("play").textContent = "play"; };
  listen("choose-increment", text => { stop(); show(Number(text)); });
  find("play").addEventListener("click", () => {
    if (playing) return stop();
    find("play").textContent = "stop";
    playing = setInterval(() => {
      show((state.increment + 1) % data.increments.length);
      find("choose-increment").value = state.increment;
    }, 400);
  });
  listen("choose-section", text => {
    const [low, high] = data.ends; // at first the middle of the teeth, or the major axis
    state.section = text; find("at").hidden = text === "none";
    find("at").value = text === "across" ? -low / (high - low) : 0;
    cut();
  });
  listen("at", cut);
  window.addEventListener("resize", draw);
  reset(); update();
})();
