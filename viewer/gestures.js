"use strict";

// Turns what a person does on a canvas into calls of a camera.

/** How far a drag over the height of a canvas, a key and a step of the wheel go: radians, radians, shares of the zoom. */
const PER_DRAG = 3;
const PER_KEY = 0.09;
const PER_WHEEL = 0.0015;

function listen(canvas, camera) {
  listenToPointers(canvas, camera);
  listenToKeys(canvas, camera);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", camera.reset);
  // A page that scrolls goes on scrolling until a mesh is chosen.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    camera.zoomBy(Math.exp(-PER_WHEEL * event.deltaY * (event.deltaMode ? 30 : 1)));
  }, { passive: false });
}

/** One pointer turns, or moves with Shift or another button; two move and zoom. */
function listenToPointers(canvas, { turn, move, zoomBy }) {
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
    const [right, down] = minus(now, before).map((x) => x / canvas.clientHeight);
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    pointers.set(event.pointerId, now);
    if (other) {
      zoomBy((norm(minus(now, other)) || 1) / (norm(minus(before, other)) || 1));
      move(0.5 * right, -0.5 * down);
    } else if (event.shiftKey || event.buttons > 1) {
      move(right, -down);
    } else {
      turn(PER_DRAG * right, PER_DRAG * down);
    }
  });
}

function listenToKeys(canvas, { turn, move, zoomBy, reset }) {
  const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const zooms = { "+": 1.2, "=": 1.2, "-": 1 / 1.2 };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const [way, zoom] = [ways[event.key], zooms[event.key]];
    if (way && event.shiftKey) move(0.05 * way[0], -0.05 * way[1]);
    else if (way) turn(PER_KEY * way[0], PER_KEY * way[1]);
    else if (zoom) zoomBy(zoom);
    else if (event.key === "0" || event.key === "Home") reset();
    else return;
    event.preventDefault();
  });
}
