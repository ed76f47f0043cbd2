// Tables that the reader can sort, and buttons that show the motion at the time of a load.

/** Returns the value of a cell by which rows are sorted: a number, or text in lower case. */
function sortValue(cell) {
  const text = cell.textContent.trim();
  const number = Number.parseFloat(text);
  return text !== "" && !Number.isNaN(number) ? number : text.toLowerCase();
}

function compareValues(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return a < b ? -1 : a > b ? 1 : 0;
}

/** Sorts the rows of a table by a column; a second call turns the order around. */
function sortTable(table, column) {
  const heads = [...table.tHead.rows[0].cells];
  const up = heads[column].getAttribute("aria-sort") !== "ascending";
  for (const head of heads) head.removeAttribute("aria-sort");
  heads[column].setAttribute("aria-sort", up ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows];
  rows.sort((a, b) => {
    const order = compareValues(sortValue(a.cells[column]), sortValue(b.cells[column]));
    return up ? order : -order;
  });
  table.tBodies[0].append(...rows);
}

function startTables() {
  for (const table of document.querySelectorAll("table.sortable")) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      head.tabIndex = 0;
      head.addEventListener("click", () => sortTable(table, column));
      head.addEventListener("keydown", (event) => {
        if (event.key === "Enter") sortTable(table, column);
      });
    });
  }
  for (const button of document.querySelectorAll("button[data-time]"))
    button.addEventListener("click", () => {
      page.setTime(Number(button.dataset.time), "table");
      document.getElementById("motion")?.scrollIntoView({ behavior: "smooth" });
    });
}
