"use strict";

// What the graphics card does with each vertex and each pixel.

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
out float far;
flat out vec3 ofFace;
flat out uvec3 ofCorners;
void main() {
  p = seen(place);
  gl_Position = onScreen(p);
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  far = figures.x;
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
in float far;
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
    : colouring == 3 ? onRamp(far)
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
