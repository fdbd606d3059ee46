"use strict";

/** Half the width of the lines along sharp edges and of those of the wire frame, in pixels of the page. */
const EDGE = 1.1;
const WIRE = 0.35;

/** What can be coloured by, in the order in which the shader knows it. */
const COLOURINGS = ["angle", "quality", "valence", "distance"];

/**
 * Draws the meshes of a scene, as `src/report/page/scene.rs` describes it, on a canvas each, seen by one camera. Nothing is
 * measured here: figures and colours come with the scene. `null` where there is no WebGL 2.
 *
 * All meshes are drawn on one hidden canvas and copied to their own, since there can be few contexts of WebGL at once.
 */
function createViewer(scene, canvases) {
  const surface = document.createElement("canvas");
  const gl = surface.getContext("webgl2", { antialias: true });
  if (!gl) return null;

  const meshes = scene.meshes.map((mesh) => upload(gl, mesh));
  const faces = program(gl, FACES_VERTEX, facesFragment(scene));
  const lines = program(gl, LINES_VERTEX, LINES_FRAGMENT);
  const [ramp, valences] = [scene.ramp, scene.valences].map((colours) => colours.flatMap(rgb));
  const [kept, leftOut, marked, unknown] = [scene.kept, scene.leftOut, scene.marked, scene.unknown].map(rgb);
  const shown = { colouring: "angle", wire: true, edges: true, place: null };
  const camera = createCamera(scene, requestDraw);
  let waiting = 0;

  function requestDraw() {
    waiting ||= requestAnimationFrame(draw);
  }

  function draw() {
    cancelAnimationFrame(waiting);
    waiting = 0;
    canvases.forEach((canvas, number) => drawPanel(sized(canvas), number));
  }

  /** A canvas with as many pixels as the screen has there, and room for them on the hidden one. */
  function sized(canvas) {
    const pixel = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * pixel)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    if (surface.width < width) surface.width = width;
    if (surface.height < height) surface.height = height;
    return { canvas, width, height, pixel };
  }

  function drawPanel(panel, number) {
    const { canvas, width, height } = panel;
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    drawFaces(meshes[number], panel);
    if (shown.edges) {
      drawLines(meshes[number].sharp, kept, panel);
      drawLines(meshes[number].leftOut, leftOut, panel);
    }
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    context.drawImage(surface, 0, surface.height - height, width, height, 0, 0, width, height);
    if (shown.place?.mesh === number) drawRing(context, camera.project(shown.place.point, width, height), panel.pixel);
  }

  function drawFaces(mesh, panel) {
    const at = use(faces, panel);
    const isKnown = shown.colouring !== "distance" || mesh.hasDistance;
    gl.uniform1i(at("colouring"), isKnown ? COLOURINGS.indexOf(shown.colouring) : -1);
    gl.uniform1f(at("wire"), shown.wire ? WIRE * panel.pixel : 0);
    gl.uniform3fv(at("ramp"), ramp);
    gl.uniform3fv(at("valences"), valences);
    gl.uniform3fv(at("marked"), marked);
    gl.uniform3fv(at("unknown"), unknown);
    gl.bindVertexArray(mesh.faces);
    gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
  }

  function drawLines(edges, colour, panel) {
    const { width, height, pixel } = panel;
    const at = use(lines, panel);
    gl.uniform2f(at("halfWidth"), (EDGE * pixel) / width, (EDGE * pixel) / height);
    gl.uniform1f(at("lift"), Math.max(0.004 / camera.zoom(), 2e-5));
    gl.uniform3fv(at("colour"), colour);
    gl.bindVertexArray(edges.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, edges.count);
  }

  /** Draws with a program from now on; gives where its uniforms are. */
  function use(used, { width, height }) {
    gl.useProgram(used);
    const at = (name) => gl.getUniformLocation(used, name);
    const { target, rotation, lens } = camera.uniforms(width, height);
    gl.uniform3fv(at("extent"), scene.extent);
    gl.uniform3fv(at("target"), target);
    gl.uniformMatrix3fv(at("rotation"), true, rotation);
    gl.uniform4fv(at("lens"), lens);
    return at;
  }

  function reset() {
    shown.place = null;
    camera.reset();
  }

  function show(what) {
    Object.assign(shown, what);
    requestDraw();
  }

  canvases.forEach((canvas) => listen(canvas, { ...camera, reset }));
  const observer = new ResizeObserver(requestDraw);
  observer.observe(canvases[0]);
  draw();

  return {
    draw,
    reset,
    setColouring: (colouring) => show({ colouring }),
    setWire: (wire) => show({ wire }),
    setEdges: (edges) => show({ edges }),
    lookAt(number) {
      shown.place = scene.places[number];
      camera.lookAt(shown.place);
    },
    /** Frees what the graphics card holds; nothing is drawn any more. */
    dispose() {
      observer.disconnect();
      cancelAnimationFrame(waiting);
      gl.getExtension("WEBGL_lose_context")?.loseContext();
    },
  };
}

/** A ring around a place, which is seen on light and dark. */
function drawRing(context, [x, y], pixel) {
  for (const [colour, line] of [["rgba(255,255,255,.9)", 5], ["#0b5bd3", 2.5]]) {
    context.beginPath();
    context.arc(x, y, 20 * pixel, 0, 2 * Math.PI);
    context.strokeStyle = colour;
    context.lineWidth = line * pixel;
    context.stroke();
  }
}

/** Red, green and blue in 0 to 1 of a colour like `#c6e4f0`. */
function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}
