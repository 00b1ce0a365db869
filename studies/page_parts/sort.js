
const value = cell => {
  const text = cell.textContent, number = text === "" ? NaN : Number(text.replace("inf", "Infinity"));
  return Number.isNaN(number) ? text : number;
};
const order = (x, y) => typeof x === typeof y ? (x > y ? 1 : y > x ? -1 : 0) : typeof x === "number" ? -1 : 1;
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach(other => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const rows = [...body.rows].map(row => [value(row.cells[column]), row]);
      // What is empty stays last.
      rows.sort(([x], [y]) => x === "" || y === "" ? (x === "") - (y === "") : order(x, y) * (up ? 1 : -1));
      const sorted = document.createDocumentFragment();
      rows.forEach(([, row]) => sorted.append(row));
      body.append(sorted);
    });
  });
}
