"use strict";
document.querySelectorAll(".ranked").forEach(table => table.querySelectorAll("th").forEach((head, column) => {
  let sign = -1;
  head.addEventListener("click", () => {
    sign = -sign;
    const value = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    const compare = (a, b) => (a === "") - (b === "") || sign * (a - b || (isNaN(a - b) ? a.localeCompare(b) : 0));
    const rows = [...table.rows].slice(1).sort((a, b) => compare(value(a), value(b)));
    rows.forEach(row => row.parentNode.append(row));
  });
}));
