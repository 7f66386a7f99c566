// One cursor over all charts and maps: they share the chainage axis. Without this script the page lacks nothing else.
(() => {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const readout = document.getElementById("readout");
  const cursors = [...document.querySelectorAll(".cursor")];
  const outputs = [...document.querySelectorAll("[data-chart] output")].map((element) => {
    const chart = data.charts[element.closest("[data-chart]").dataset.chart];
    return { element, chart, line: chart.lines[Number(element.dataset.line)] };
  });

  function groupAt(chainage) {
    let low = 0;
    let high = data.start.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (data.start[middle] <= chainage) low = middle;
      else high = middle - 1;
    }
    return chainage <= data.end[low] && chainage >= data.start[low] ? low : -1;
  }

  function valueText(line, chart, group) {
    const low = group < 0 ? null : line.low[group];
    if (low === null) return "–";
    const high = line.high[group];
    const text = low.toFixed(chart.decimals);
    return high === low ? text : `${text} … ${high.toFixed(chart.decimals)}`;
  }

  function show(share) {
    const chainage = data.low + share * (data.high - data.low);
    const group = groupAt(chainage);
    for (const cursor of cursors) {
      cursor.style.display = "block";
      cursor.style.left = `${100 * share}%`;
    }
    for (const { element, chart, line } of outputs) element.textContent = valueText(line, chart, group);
    readout.hidden = false;
    readout.textContent = `${(chainage * data.factor).toFixed(2)} ${data.unit}`;
  }

  function hide() {
    for (const cursor of cursors) cursor.style.display = "none";
    for (const { element } of outputs) element.textContent = "";
    readout.hidden = true;
  }

  for (const area of document.querySelectorAll(".area")) {
    area.addEventListener("pointermove", (event) => {
      const box = area.getBoundingClientRect();
      show(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
    });
    area.addEventListener("pointerleave", hide);
  }
})();
