"use strict";
// What a report's charts have in common: numbers, colours, lines, bands, files.
const octsimCharts = (() => {
  const place = (id) => document.getElementById(id);
  const ARRAYS = { f4: Float32Array, f8: Float64Array };
  const unpacked = ({ type, data }) =>
    new ARRAYS[type](Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer);
  // a gap of a line is null, not NaN
  const gaps = (array) => Array.from(array, (one) => (Number.isFinite(one) ? one : null));
  const written = (value) =>
    value && Math.abs(value) < 1e-3 ? value.toExponential() : String(value);
  const told = (value, digits = 4) =>
    Number.isFinite(value) ? written(Number(value.toPrecision(digits))).replaceAll("-", "−") : "not known";

  const LIGHT = {
    ink: "#1f2328", faint: "#57606a", grid: "#e3e7eb", slope: "#0072b2", ideal: "#009e73",
    exact: "#000000", predicted: "#000000", band: "#56b4e955", middle: "#cc79a7", mark: "#d55e00",
  };
  const DARK = {
    ink: "#ced6dd", faint: "#9aa5b1", grid: "#2a323b", slope: "#6cbdf0", ideal: "#2fc99a",
    exact: "#ffffff", predicted: "#ffffff", band: "#56b4e944", middle: "#e6a3c8", mark: "#ff8a3d",
  };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  let printed = false;
  const colours = () => (dark.matches && !printed ? DARK : LIGHT);

  const drawn = new Map(); // chart by name

  const HEIGHT = { image: 340, slope: 320 };
  const FONT = "12px system-ui, sans-serif";

  function axes(x, y, wide) {
    const c = colours();
    const one = (label) => ({
      label, stroke: c.ink, font: FONT, labelFont: FONT, labelSize: 20,
      grid: { stroke: c.grid, width: 1 }, ticks: { stroke: c.grid, width: 1 },
    });
    return [{ ...one(x), size: 38 }, { ...one(y), size: wide || 58 }];
  }

  function key(name, entries) {
    const shown = entries.filter(Boolean).map(([text, colour, form]) => {
      const span = document.createElement("span");
      const mark = document.createElement("i");
      mark.className = form || "";
      mark.style[form === "area" ? "backgroundColor" : "borderColor"] = colour;
      span.append(mark, text);
      return span;
    });
    place(`${name}-key`).replaceChildren(...shown);
  }

  function chart(name, options, data, says) {
    const where = place(`${name}-plot`);
    const old = drawn.get(name);
    if (old) old.destroy();
    const size = { width: where.clientWidth, height: HEIGHT[name] || 260 };
    const made = new uPlot({
      ...size, ...options, legend: { show: false }, padding: [8, 14, 0, 0],
      cursor: { drag: { x: false, y: false }, points: { show: false }, ...options.cursor },
    }, data, where);
    const canvas = made.ctx.canvas;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", says);
    drawn.set(name, made);
  }

  function redrawn(name) {
    drawn.get(name)?.redraw(false);
  }

  // a vertical line at the chosen diameter, or another place
  function marked(u, x, dash) {
    if (!Number.isFinite(x)) return;
    const left = Math.round(u.valToPos(x, "x", true));
    const { ctx, bbox } = u;
    if (left < bbox.left || left > bbox.left + bbox.width) return;
    ctx.save();
    ctx.strokeStyle = colours().mark;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.setLineDash(dash.map((one) => one * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(left, bbox.top);
    ctx.lineTo(left, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  // what lies between two edges over x; parts of it where neither is a gap
  function area(u, x, low, high, colour) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = colour;
    let from = 0;
    for (let i = 0; i <= x.length; i++) {
      if (i < x.length && Number.isFinite(low[i]) && Number.isFinite(high[i])) continue;
      if (i - from > 1) {
        ctx.beginPath();
        for (let j = from; j < i; j++) ctx.lineTo(u.valToPos(x[j], "x", true), u.valToPos(high[j], "y", true));
        for (let j = i - 1; j >= from; j--) ctx.lineTo(u.valToPos(x[j], "x", true), u.valToPos(low[j], "y", true));
        ctx.fill();
      }
      from = i + 1;
    }
    ctx.restore();
  }

  // ends of an axis: all of these, and a margin
  function ends(...arrays) {
    let low = Infinity, high = -Infinity;
    for (const array of arrays) for (const one of array) {
      if (Number.isFinite(one)) { low = Math.min(low, one); high = Math.max(high, one); }
    }
    if (low > high) return [0, 1];
    const margin = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - margin, high + margin];
  }

  // a table as CSV; what is in single precision has seven digits
  function csv(heads, columns) {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const cell = (column, i) => {
      if (typeof column[i] !== "number") return quoted(String(column[i]));
      if (!Number.isFinite(column[i])) return "";
      return String(column instanceof Float32Array ? Number(column[i].toPrecision(7)) : column[i]);
    };
    const rows = Array.from(columns[0], (_, i) => columns.map((one) => cell(one, i)).join(","));
    return [heads.map(quoted).join(","), ...rows, ""].join("\n");
  }

  function download(name, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/plain;charset=utf-8" }));
    link.download = name;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  // a page is drawn anew in the colours of paper before it is printed, and as it was after
  function onColours(redraw) {
    dark.addEventListener("change", redraw);
    addEventListener("beforeprint", () => { printed = true; redraw(); });
    addEventListener("afterprint", () => { printed = false; redraw(); });
  }

  return { place, unpacked, gaps, told, colours, axes, key, chart, marked, area, ends, csv, download, onColours, redrawn };
})();
