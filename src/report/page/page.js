// The page of a report by itself: what it shows, and the report as a file.

(function () {
  const byId = (id) => document.getElementById(id);
  const viewer = showReport(document, JSON.parse(byId("scene").textContent));

  const save = document.createElement("a");
  save.textContent = "Save the report as JSON";
  save.download = "report.json";
  save.href = "data:application/json;charset=utf-8," + encodeURIComponent(byId("report").textContent.trimStart());
  byId("save").append(save);

  // Sizes change on paper; what is drawn is scaled, and drawn anew afterwards.
  window.addEventListener("afterprint", () => viewer?.draw());
  document.documentElement.dataset.viewer = viewer ? "ready" : "none";
})();
