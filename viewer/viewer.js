"use strict";

/**
 * Draws meshes side by side, seen by one camera. Nothing is measured here: what colours mean comes with the scene.
 *
 * `createViewer(scene, canvases)` takes a scene as `src/report/page/scene.rs` describes it and a canvas for each of its
 * meshes. It gives `null` where there is no WebGL 2. All meshes are drawn on one hidden canvas, so that their number is not
 * bounded by that of WebGL's contexts, and copied to their own.
 */
function createViewer(scene, canvases) {
  const EYE = 5; // Distance of the eye from what it looks at, in half diagonals of the box of all meshes; the library’s is the same.
  const ZOOMS = [0.3, 400];
  const START = { zoom: scene.zoom, target: scene.target, rotation: scene.rotation };
  const COLOURINGS = ["angle", "quality", "valence", "distance"];

  const surface = document.createElement("canvas");
  const gl = surface.getContext("webgl2", { antialias: true, premultipliedAlpha: true });
  if (!gl) return null;

  const meshes = scene.meshes.map((mesh) => upload(gl, mesh));
  const faces = program(gl, FACES_VERTEX, facesFragment(scene));
  const lines = program(gl, LINES_VERTEX, LINES_FRAGMENT);
  const ramp = new Float32Array(scene.ramp.flatMap(rgb));
  const valences = new Float32Array(scene.valences.flatMap(rgb));
  const camera = { ...START };
  const shown = { colouring: "angle", wire: true, edges: true, place: null };
  let waiting = 0;

  function requestDraw() {
    if (!waiting) waiting = requestAnimationFrame(draw);
  }

  function draw() {
    cancelAnimationFrame(waiting);
    waiting = 0;
    canvases.forEach(drawPanel);
  }

  function drawPanel(canvas, number) {
    const pixel = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * pixel));
    const height = Math.max(1, Math.round(canvas.clientHeight * pixel));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    if (surface.width < width || surface.height < height) {
      surface.width = Math.max(surface.width, width);
      surface.height = Math.max(surface.height, height);
    }
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    drawFaces(meshes[number], width, height, pixel);
    if (shown.edges) {
      drawLines(meshes[number].sharp, rgb(scene.kept), width, height, pixel);
      drawLines(meshes[number].leftOut, rgb(scene.leftOut), width, height, pixel);
    }
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    context.drawImage(surface, 0, surface.height - height, width, height, 0, 0, width, height);
    if (shown.place && shown.place.mesh === number) ring(context, shown.place, width, height, pixel);
  }

  function drawFaces(mesh, width, height, pixel) {
    const at = useProgram(faces, width, height);
    gl.uniform3fv(at("ramp"), ramp);
    gl.uniform3fv(at("valences"), valences);
    gl.uniform3fv(at("marked"), rgb(scene.marked));
    gl.uniform3fv(at("unknown"), rgb(scene.unknown));
    const known = shown.colouring !== "distance" || mesh.hasDistance;
    gl.uniform1i(at("colouring"), known ? COLOURINGS.indexOf(shown.colouring) : -1);
    gl.uniform1f(at("wire"), shown.wire ? 0.35 * pixel : 0);
    gl.bindVertexArray(mesh.faces);
    gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
  }

  function drawLines(edges, colour, width, height, pixel) {
    if (!edges.count) return;
    const at = useProgram(lines, width, height);
    gl.uniform2f(at("halfWidth"), (1.1 * pixel) / width, (1.1 * pixel) / height);
    gl.uniform1f(at("lift"), Math.max(0.004 / camera.zoom, 2e-5));
    gl.uniform3fv(at("colour"), colour);
    gl.bindVertexArray(edges.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, edges.count);
  }

  function useProgram(used, width, height) {
    gl.useProgram(used);
    const at = (name) => gl.getUniformLocation(used, name);
    gl.uniform3fv(at("extent"), scene.extent);
    gl.uniform3fv(at("target"), camera.target);
    gl.uniformMatrix3fv(at("rotation"), true, camera.rotation.flat());
    const { x, y } = scale(width, height);
    gl.uniform4f(at("lens"), x, y, EYE, 2.2 + norm(camera.target));
    return at;
  }

  function scale(width, height) {
    const lens = EYE * camera.zoom;
    return { x: (lens * height) / width, y: lens };
  }

  /** Where a point is on a canvas, in its pixels. */
  function project(point, width, height) {
    const [right, up, near] = times(camera.rotation, minus(point, camera.target));
    const { x, y } = scale(width, height);
    const depth = EYE - near;
    return [(0.5 + (0.5 * x * right) / depth) * width, (0.5 - (0.5 * y * up) / depth) * height];
  }

  function ring(context, place, width, height, pixel) {
    const [x, y] = project(scene.places[place.number].point, width, height);
    for (const [colour, line] of [["rgba(255,255,255,.9)", 5], ["#0b5bd3", 2.5]]) {
      context.beginPath();
      context.arc(x, y, 20 * pixel, 0, 2 * Math.PI);
      context.strokeStyle = colour;
      context.lineWidth = line * pixel;
      context.stroke();
    }
  }

  /** Turns the camera about the axes of the screen, by radians. */
  function turn(right, down) {
    const [sx, cx, sy, cy] = [Math.sin(down), Math.cos(down), Math.sin(right), Math.cos(right)];
    const about = [[cy, 0, sy], [sx * sy, cx, -sx * cy], [-cx * sy, sx, cx * cy]];
    camera.rotation = orthonormal(product(about, camera.rotation));
    requestDraw();
  }

  /** Moves what is seen, by shares of the height of a panel. */
  function move(right, up) {
    const share = 2 / camera.zoom;
    const [x, y] = camera.rotation;
    camera.target = camera.target.map((t, i) => t - share * (right * x[i] + up * y[i]));
    requestDraw();
  }

  function zoomBy(factor) {
    camera.zoom = Math.min(Math.max(camera.zoom * factor, ZOOMS[0]), ZOOMS[1]);
    requestDraw();
  }

  function reset() {
    Object.assign(camera, START);
    shown.place = null;
    requestDraw();
  }

  /** Looks at a place from where its surface faces, near enough to see its edges. */
  function lookAt(number) {
    const { mesh, point, normal, size } = scene.places[number];
    const rotation = norm(normal) > 0.5 ? facing(normal, scene.rotation[1]) : camera.rotation;
    const zoom = Math.min(Math.max(0.13 / size, 1.5), ZOOMS[1]);
    Object.assign(camera, { target: point, rotation, zoom });
    shown.place = { mesh, number };
    requestDraw();
  }

  canvases.forEach((canvas) => listen(canvas, { turn, move, zoomBy, reset }));
  new ResizeObserver(requestDraw).observe(canvases[0]);
  draw();

  return {
    draw,
    lookAt,
    reset,
    setColouring: (colouring) => { shown.colouring = colouring; requestDraw(); },
    setWire: (wire) => { shown.wire = wire; requestDraw(); },
    setEdges: (edges) => { shown.edges = edges; requestDraw(); },
  };
}

// What the user does.

/** Turns what happens on a canvas into calls of the camera. */
function listen(canvas, { turn, move, zoomBy, reset }) {
  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    event.preventDefault();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [right, down] = [now[0] - before[0], now[1] - before[1]];
    const size = canvas.clientHeight;
    const other = [...pointers].find(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, now);
    if (other) {
      const apart = ([x, y]) => Math.hypot(x - other[1][0], y - other[1][1]) || 1;
      zoomBy(apart(now) / apart(before));
      move((0.5 * right) / size, (-0.5 * down) / size);
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) {
      move(right / size, -down / size);
    } else {
      turn((3 * right) / size, (3 * down) / size);
    }
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  // A page that scrolls goes on scrolling until a mesh is chosen.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoomBy(Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)));
  }, { passive: false });
  canvas.addEventListener("dblclick", reset);
  const step = 0.09;
  const keys = {
    ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
    "+": 1.2, "=": 1.2, "-": 1 / 1.2, 0: reset, Home: reset,
  };
  canvas.addEventListener("keydown", (event) => {
    const act = keys[event.key];
    if (act === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (typeof act === "function") act();
    else if (typeof act === "number") zoomBy(act);
    else if (event.shiftKey) move(0.05 * act[0], -0.05 * act[1]);
    else turn(step * act[0], step * act[1]);
  });
}

// Meshes on the graphics card.

/** Bytes of each corner of each triangle: place (6), distance, mark, angle, quality, the valences of all three, padding. */
const STRIDE = 16;

function upload(gl, mesh) {
  const places = new Uint16Array(bytes(mesh.positions).buffer);
  const corners = mesh.vertices > 65536
    ? new Uint32Array(bytes(mesh.corners).buffer)
    : new Uint16Array(bytes(mesh.corners).buffer);
  const [angle, quality, valence] = [mesh.angle, mesh.quality, mesh.valence].map(bytes);
  const distance = mesh.distance ? bytes(mesh.distance) : null;
  const marked = new Set(mesh.marked);
  const data = new DataView(new ArrayBuffer(STRIDE * corners.length));
  for (let corner = 0; corner < corners.length; corner++) {
    const at = STRIDE * corner;
    const face = Math.floor(corner / 3);
    const v = corners[corner];
    for (let k = 0; k < 3; k++) {
      data.setUint16(at + 2 * k, places[3 * v + k], true);
      data.setUint8(at + 10 + k, valence[corners[3 * face + k]]);
    }
    data.setUint8(at + 6, distance ? distance[v] : 0);
    data.setUint8(at + 7, marked.has(face) ? 255 : 0);
    data.setUint8(at + 8, angle[face]);
    data.setUint8(at + 9, quality[face]);
  }
  const faces = gl.createVertexArray();
  gl.bindVertexArray(faces);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  attribute(gl, 0, 3, gl.UNSIGNED_SHORT, STRIDE, 0);
  attribute(gl, 1, 4, gl.UNSIGNED_BYTE, STRIDE, 6);
  gl.enableVertexAttribArray(2);
  gl.vertexAttribIPointer(2, 3, gl.UNSIGNED_BYTE, STRIDE, 10);
  return {
    faces,
    count: corners.length,
    hasDistance: distance !== null,
    sharp: uploadEdges(gl, mesh.sharp),
    leftOut: uploadEdges(gl, mesh.leftOut),
  };
}

function uploadEdges(gl, text) {
  const ends = bytes(text);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, ends, gl.STATIC_DRAW);
  attribute(gl, 0, 3, gl.UNSIGNED_SHORT, 12, 0);
  attribute(gl, 1, 3, gl.UNSIGNED_SHORT, 12, 6);
  gl.vertexAttribDivisor(0, 1);
  gl.vertexAttribDivisor(1, 1);
  return { array, count: ends.length / 12 };
}

function attribute(gl, place, size, type, stride, offset) {
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, type, true, stride, offset);
}

function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}

function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

// Small matrices, by rows.

function norm(v) {
  return Math.hypot(...v);
}

function minus(a, b) {
  return a.map((x, i) => x - b[i]);
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(v) {
  const length = norm(v) || 1;
  return v.map((x) => x / length);
}

function times(rows, v) {
  return rows.map((row) => dot(row, v));
}

function product(a, b) {
  return a.map((row) => [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k]));
}

/** A rotation without what rounding added to it. */
function orthonormal([right, , near]) {
  const z = unit(near);
  const y = unit(cross(z, right));
  return [cross(y, z), y, z];
}

/** The rotation that looks against `normal`, with `up` as upright as can be. */
function facing(normal, up) {
  const z = unit(normal);
  const side = cross(up, z);
  const x = norm(side) > 1e-3 ? unit(side) : unit(cross(Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], z));
  return [x, cross(z, x), z];
}

// Shaders.

/** From a place in the box, 0 to 1 along each axis, to what the eye sees and to the screen. */
const CAMERA = `#version 300 es
precision highp float;
uniform vec3 extent, target;
uniform mat3 rotation;
uniform vec4 lens; // Scale in x and y, distance of the eye, depth of what is seen.
vec3 seen(vec3 place) { return rotation * ((place - 0.5) * extent - target); }
vec4 onScreen(vec3 p) {
  float depth = lens.z - p.z;
  return vec4(lens.xy * p.xy, -p.z / lens.w * depth, depth);
}
`;

const FACES_VERTEX = CAMERA + `
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 figures;
layout(location = 2) in uvec3 cornerValences;
out vec3 p;
out vec3 corner;
out float distance_;
flat out vec3 ofFace;
flat out uvec3 ofCorners;
void main() {
  p = seen(place);
  gl_Position = onScreen(p);
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  distance_ = figures.x;
  ofFace = figures.yzw;
  ofCorners = cornerValences;
}`;

const facesFragment = ({ ramp, valences }) => `#version 300 es
precision highp float;
precision highp int;
uniform vec3 ramp[${ramp.length}];
uniform vec3 valences[${valences.length}];
uniform vec3 marked, unknown;
uniform int colouring;
uniform float wire;
in vec3 p;
in vec3 corner;
in float distance_;
flat in vec3 ofFace;
flat in uvec3 ofCorners;
out vec4 pixel;
vec3 onRamp(float bad) {
  float at = clamp(bad, 0.0, 1.0) * ${ramp.length - 1}.0;
  int k = min(int(at), ${ramp.length - 2});
  return mix(ramp[k], ramp[k + 1], at - float(k));
}
vec3 valenceColour() {
  bool first = corner.x >= corner.y && corner.x >= corner.z;
  uint nearest = first ? ofCorners.x : corner.y >= corner.z ? ofCorners.y : ofCorners.z;
  return valences[nearest];
}
void main() {
  vec3 colour = colouring == 0 ? onRamp(ofFace.y)
    : colouring == 1 ? onRamp(ofFace.z)
    : colouring == 2 ? valenceColour()
    : colouring == 3 ? onRamp(distance_)
    : unknown;
  if (ofFace.x > 0.5) colour = marked;
  vec3 normal = normalize(cross(dFdx(p), dFdy(p)));
  vec3 eye = normalize(vec3(0.0, 0.0, 5.0) - p);
  if (dot(normal, eye) < 0.0) normal = -normal;
  // The inside of a surface is dull and dark.
  if (!gl_FrontFacing) colour = mix(colour, vec3(0.32, 0.3, 0.36), 0.7);
  float light = 0.70 + 0.32 * max(dot(normal, normalize(vec3(-0.4, 0.6, 0.7))), 0.0)
    + 0.12 * max(dot(normal, normalize(vec3(0.8, -0.2, 0.5))), 0.0);
  colour *= light;
  if (wire > 0.0) {
    vec3 width = fwidth(corner);
    vec3 away = corner / max(width, vec3(1e-6));
    float line = 1.0 - smoothstep(wire, wire + 0.9, min(away.x, min(away.y, away.z)));
    // Triangles of a few pixels would be all line.
    float room = smoothstep(0.02, 0.25, 0.25 - max(width.x, max(width.y, width.z)));
    colour = mix(colour, vec3(0.05, 0.09, 0.16), line * mix(0.12, 0.6, room));
  }
  pixel = vec4(colour, 1.0);
}`;

const LINES_VERTEX = CAMERA + `
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
uniform vec2 halfWidth;
uniform float lift; // How much nearer than the surface, so that it does not hide them.
void main() {
  vec4 a = onScreen(seen(from)), b = onScreen(seen(to));
  vec2 along = normalize((b.xy / b.w - a.xy / a.w) / halfWidth + vec2(1e-9, 0.0));
  vec4 end = gl_VertexID < 2 ? a : b;
  float side = gl_VertexID % 2 == 0 ? 1.0 : -1.0;
  float past = gl_VertexID < 2 ? -0.5 : 0.5;
  end.xy += (side * vec2(-along.y, along.x) + past * along) * halfWidth * 2.0 * end.w;
  end.z -= lift * end.w;
  gl_Position = end;
}`;

const LINES_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1.0); }`;
