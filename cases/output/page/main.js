// Starts the parts of the page when its data are read. Without scripts, or in a browser that cannot
// inflate the data, the page keeps its pictures.

async function start() {
  startTables();
  if (typeof DecompressionStream === "undefined") return;
  page.data = await readData();
  document.documentElement.classList.add("scripts");
  startPlots();
  startMotion();
  startIterations();
  startThumbnails();
  page.setTime(page.time, "start");
  document.documentElement.dataset.ready = "true";
}

start();
