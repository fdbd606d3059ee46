// The page of a report: its viewer, what is chosen there, and the links to places.

(function () {
  const byId = (id) => document.getElementById(id);
  const scene = JSON.parse(byId("scene").textContent);
  const canvases = [...document.querySelectorAll(".panel canvas")];
  const viewer = canvases.length ? createViewer(scene, canvases) : null;

  function colourBy(key) {
    for (const each of document.querySelectorAll("[data-colouring]")) each.hidden = each.dataset.colouring !== key;
    viewer?.setColouring(key);
  }

  for (const choice of document.querySelectorAll("input[name=colouring]")) {
    choice.addEventListener("change", () => colourBy(choice.value));
    if (choice.checked) colourBy(choice.value);
  }
  byId("wire")?.addEventListener("change", (event) => viewer?.setWire(event.target.checked));
  byId("edges")?.addEventListener("change", (event) => viewer?.setEdges(event.target.checked));
  byId("reset")?.addEventListener("click", () => viewer?.reset());

  for (const link of document.querySelectorAll("a[data-place]")) {
    link.addEventListener("click", () => {
      const choice = document.querySelector(`input[name=colouring][value=${link.dataset.by}]`);
      if (choice) {
        choice.checked = true;
        colourBy(choice.value);
      }
      viewer?.lookAt(Number(link.dataset.place));
    });
  }

  const save = document.createElement("a");
  save.textContent = "Save the report as JSON";
  save.download = "report.json";
  save.href = "data:application/json;charset=utf-8," + encodeURIComponent(byId("report").textContent.trimStart());
  byId("save").append(save);

  // Sizes change on paper; what is drawn is scaled, and drawn anew afterwards.
  window.addEventListener("afterprint", () => viewer?.draw());
  document.documentElement.dataset.viewer = viewer ? "ready" : "none";
})();
