"use strict";

/**
 * Starts the viewer of a report within `root`, its choices and its links to places. Gives the viewer; `null` where there is
 * none.
 */
function showReport(root, scene) {
  const all = (selector) => [...root.querySelectorAll(selector)];
  const canvases = all(".panel canvas");
  const viewer = canvases.length ? createViewer(scene, canvases) : null;

  function colourBy(key) {
    for (const each of all("[data-colouring]")) each.hidden = each.dataset.colouring !== key;
    viewer?.setColouring(key);
  }

  for (const choice of all("input[name=colouring]")) {
    choice.addEventListener("change", () => colourBy(choice.value));
    if (choice.checked) colourBy(choice.value);
  }
  root.querySelector("#wire")?.addEventListener("change", (event) => viewer?.setWire(event.target.checked));
  root.querySelector("#edges")?.addEventListener("change", (event) => viewer?.setEdges(event.target.checked));
  root.querySelector("#reset")?.addEventListener("click", () => viewer?.reset());

  for (const link of all("a[data-place]")) {
    link.addEventListener("click", () => {
      const choice = root.querySelector(`input[name=colouring][value=${link.dataset.by}]`);
      if (choice) {
        choice.checked = true;
        colourBy(choice.value);
      }
      viewer?.lookAt(Number(link.dataset.place));
    });
  }
  return viewer;
}
