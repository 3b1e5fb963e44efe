"use strict";
// Sorts, filters and searches the table. What is shown stands in the address, so that it can be sent to somebody.
const table = document.querySelector("table.fleet");
const body = table.tBodies[0];
const rows = [...body.rows];
const heads = [...table.querySelectorAll("thead th")];
const [search, answer, sort, shown] = ["search", "answer", "sort", "shown"].map((id) => document.getElementById(id));
const state = { q: "", answer: "", sort: "", ...Object.fromEntries(new URLSearchParams(location.hash.slice(1))) };

sort.add(new Option("as found", ""));
for (const head of heads) {
  for (const [sign, words] of [["", ""], ["-", ", descending"]]) {
    sort.add(new Option(head.textContent.trim() + words, sign + head.dataset.key));
  }
}

function compare(a, b) {
  if (a === "" || b === "") return (a === "") - (b === "");  // what is not known comes last either way
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, undefined, { numeric: true }) : x - y;
}

function show() {
  const key = state.sort.replace(/^-/, "");
  const column = heads.findIndex((head) => head.dataset.key === key);
  const down = state.sort.startsWith("-");
  heads.forEach((head, k) => (k === column ? head.setAttribute("aria-sort", down ? "descending" : "ascending") : head.removeAttribute("aria-sort")));
  if (column >= 0) {
    const value = (row) => row.cells[column].dataset.value;
    const order = (a, b) => (value(a) === "" || value(b) === "" ? 1 : down ? -1 : 1) * compare(value(a), value(b));
    body.append(...[...rows].sort(order));
  } else {
    body.append(...rows);
  }
  const words = state.q.toLowerCase().split(/\s+/).filter(Boolean);
  for (const row of rows) {
    const text = row.textContent.toLowerCase();
    row.hidden = (state.answer !== "" && row.dataset.answer !== state.answer) || !words.every((word) => text.includes(word));
  }
  shown.value = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`;
  [search.value, answer.value, sort.value] = [state.q, state.answer, state.sort];
  const told = Object.entries(state).filter(([, value]) => value !== "");
  history.replaceState(null, "", told.length ? "#" + new URLSearchParams(told) : location.pathname);
}

function set(change) {
  Object.assign(state, change);
  show();
}

search.form.addEventListener("submit", (event) => event.preventDefault());
search.addEventListener("input", () => set({ q: search.value }));
answer.addEventListener("input", () => set({ answer: answer.value }));
sort.addEventListener("input", () => set({ sort: sort.value }));
for (const head of heads) {
  const key = head.dataset.key;
  head.querySelector("button").addEventListener("click", () => set({ sort: state.sort === key ? "-" + key : key }));
}
show();
