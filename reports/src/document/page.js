const powers = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
function valueOf(row, column) {
  const text = row.cells[column].textContent.trim();
  const number = text.replace(/[\u202f\u00a0]/g, "").replace("−", "-").replace("∞", "Infinity")
    .replace(/×10([⁻⁰¹²³⁴-⁹]+)/, (_, power) => "e" + [...power].map(digit => "0123456789-"[powers.indexOf(digit)]).join(""));
  return number === "" || isNaN(number) ? text : Number(number);
}
for (const head of document.querySelectorAll("thead th")) {
  head.tabIndex = 0;
  head.title = "sort";
  const sort = () => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const body = head.closest("table").tBodies[0], column = head.cellIndex;
    const order = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
    const rows = [...body.rows].map(row => [valueOf(row, column), row]);
    rows.sort(([a], [b]) => down ? order(b, a) : order(a, b));
    for (const [, row] of rows) body.append(row);
  };
  head.addEventListener("click", sort);
  head.addEventListener("keydown", event => { if (event.key === "Enter") sort(); });
}
