"use strict";
// Sorting and filtering the table, playing the attacks, and opening what a link or a printer asks for.
// Without scripts the page shows everything that it has, unsorted and with each attack's last step.
(() => {
  const table = document.querySelector("table.networks");
  const rows = table ? [...table.tBodies[0].rows] : [];

  function compare(a, b) {
    const x = a.dataset.value, y = b.dataset.value;
    if (x === "" || y === "") return (x === "") - (y === "") ;
    const u = Number(x), v = Number(y);
    if (!Number.isNaN(u) && !Number.isNaN(v)) return u - v;
    return x.localeCompare(y, undefined, { numeric: true });
  }

  if (table) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = head.querySelector("button");
      if (!button) return;
      button.addEventListener("click", () => {
        const descending = head.getAttribute("aria-sort") === "ascending";
        [...table.tHead.rows[0].cells].forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", descending ? "descending" : "ascending");
        const sign = descending ? -1 : 1;
        rows.sort((p, q) => {
          const a = p.cells[column], b = q.cells[column];
          const missing = (a.dataset.value === "") - (b.dataset.value === "");
          return missing || sign * compare(a, b);
        });
        table.tBodies[0].append(...rows);
      });
    });
  }

  const words = document.querySelector("#words"), failing = document.querySelector("#failing");
  const count = document.querySelector("#count"), group = document.querySelector("#group");
  const bounds = [...document.querySelectorAll(".filters fieldset")];

  function isWithin(cell, least, most) {
    const low = cell.dataset.value, high = cell.dataset.upper ?? low;
    return (least === "" || (low !== "" && Number(low) >= Number(least))) &&
      (most === "" || (high !== "" && Number(high) <= Number(most)));
  }
  function filter() {
    const wanted = words.value.toLowerCase();
    const asked = bounds.map((each) => [Number(each.dataset.column), ...[...each.querySelectorAll("input")].map(
      (input) => input.value)]).filter(([, least, most]) => least !== "" || most !== "");
    let shown = 0;
    rows.forEach((row) => {
      const fits = row.textContent.toLowerCase().includes(wanted) &&
        !(failing && failing.checked && row.dataset.gate === "passed") &&
        !(group && group.value && row.dataset.group !== group.value) &&
        asked.every(([column, least, most]) => isWithin(row.cells[column], least, most));
      row.hidden = !fits;
      shown += fits;
      const part = document.getElementById(row.dataset.part);
      if (part) part.hidden = !fits;
    });
    count.textContent = `${shown} of ${rows.length} shown`;
  }
  if (words) {
    words.addEventListener("input", filter);
    if (failing) failing.addEventListener("change", filter);
    const filters = document.querySelector(".filters");
    for (const event of ["input", "change"]) filters.addEventListener(event, filter); // a choice tells the second only
    filters.querySelector("#clear").addEventListener("click", () => {
      filters.querySelectorAll("input").forEach((input) => { input.value = ""; });
      if (group) group.value = "";
      filter();
    });
    filter(); // a browser that goes back keeps what was typed
  }

  function open() {
    const part = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (part && part.tagName === "DETAILS") part.open = true;
  }
  window.addEventListener("hashchange", open);
  open();
  let folded = [];
  window.addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details.network:not([open])")];
    folded.forEach((part) => { part.open = true; });
  });
  window.addEventListener("afterprint", () => folded.forEach((part) => { part.open = false; }));

  document.querySelectorAll(".film").forEach((film) => {
    const curtain = film.querySelector(".shown"), button = film.querySelector("button");
    const slider = film.querySelector("input"), last = Number(slider.max), width = Number(film.dataset.width);
    const step = film.querySelector(".step");
    let timer = 0;
    function show() {
      curtain.setAttribute("width", String((width * Number(slider.value)) / last));
      step.textContent = `step ${slider.value}`;
    }
    function stop() {
      clearInterval(timer);
      timer = 0;
      button.textContent = "Play";
    }
    button.addEventListener("click", () => {
      if (timer) { stop(); return; }
      if (Number(slider.value) >= last) slider.value = "0";
      button.textContent = "Pause";
      show();
      timer = setInterval(() => {
        slider.value = String(Number(slider.value) + 1);
        show();
        if (Number(slider.value) >= last) stop();
      }, 120);
    });
    slider.addEventListener("input", () => { stop(); show(); });
    show();
  });
})();
