"use strict";
// Draws a report's charts from the values in the page, and offers them as CSV.
(() => {
  const { place, unpacked, gaps, told, colours, axes, key, chart, marked, area, ends, csv, download, onColours, redrawn } =
    octsimCharts;
  const values = JSON.parse(place("values").textContent);
  const diameter = values.diameter && unpacked(values.diameter);
  let at = diameter ? Math.floor(diameter.length / 2) : 0;
  const makers = new Map(); // what draws each chart anew, by name
  const changing = ["spectrum", "ascan"]; // with the diameter; in others its mark moves
  const saved = new Map(); // what gives the text of each file, by its name

  // small or large numbers without their power of ten, and that as an axis says it
  function scaled(found) {
    const most = found.reduce((most, one) => (Math.abs(one) > most ? Math.abs(one) : most), 0);
    const power = most > 0 ? Math.floor(Math.log10(most)) : 0;
    if (Math.abs(power) < 3) return ["", found];
    const digits = [...String(power)].map((one) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[one] || "⁻").join("");
    return [` (10${digits})`, Array.from(found, (one) => one / 10 ** power)];
  }

  function chosenBy(u, scale) {
    u.over.addEventListener("click", (event) => {
      const box = u.over.getBoundingClientRect();
      const where = scale === "x" ? event.clientX - box.left : event.clientY - box.top;
      const value = u.posToVal(where, scale);
      let best = 0;
      diameter.forEach((one, i) => {
        if (Math.abs(one - value) < Math.abs(diameter[best] - value)) best = i;
      });
      choose(best);
    });
  }

  if (values.slope) {
    const slope = values.slope, found = {};
    for (const [name, one] of Object.entries(slope.columns)) found[name] = unpacked(one);
    const band = Object.fromEntries(
      ["band_diameter", "middle", "low", "high"].map((name) => [name, unpacked(slope[name])]));
    const x = Array.from(found.diameter);
    const exact = found.exact_phase_slope || new Float64Array(x.length).fill(NaN);
    const some = exact.some(Number.isFinite);
    makers.set("slope", () => {
      const c = colours(), flat = Array(x.length).fill(slope.predicted);
      const y = ends(found.phase_slope, found.ideal_phase_slope, exact, band.low, band.high, [slope.predicted]);
      chart("slope", {
        scales: { x: { time: false }, y: { range: () => y } },
        axes: axes("Diameter (µm)", "Phase slope (mrad/nm)"),
        series: [
          {},
          { stroke: c.predicted, width: 1, dash: [8, 3, 2, 3], points: { show: false } },
          { stroke: c.ideal, width: 1.5, dash: [6, 4], points: { show: false } },
          { stroke: c.slope, width: 2, points: { show: x.length < 60, size: 5, fill: c.slope } },
          { stroke: c.exact, width: 0, points: { show: true, size: 8, fill: c.exact, stroke: c.exact } },
        ],
        hooks: {
          drawClear: [(u) => area(u, band.band_diameter, band.low, band.high, c.band)],
          draw: [(u) => {
            const { ctx, bbox } = u;
            ctx.save();
            ctx.beginPath();
            ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
            ctx.clip();
            ctx.strokeStyle = c.middle;
            ctx.lineWidth = 1.5 * devicePixelRatio;
            ctx.beginPath();
            band.middle.forEach((one, i) => Number.isFinite(one) &&
              ctx.lineTo(u.valToPos(band.band_diameter[i], "x", true), u.valToPos(one, "y", true)));
            ctx.stroke();
            ctx.restore();
            marked(u, diameter[at], [4, 3]);
          }],
          ready: [(u) => chosenBy(u, "x")],
        },
      }, [x, flat, gaps(found.ideal_phase_slope), gaps(found.phase_slope), gaps(exact)],
      `Phase slope over the diameter, ${told(x[0])} to ${told(x[x.length - 1])} µm`);
      key("slope", [
        ["phase slope of the run", c.slope], ["ideal spectrum cos(2ndk)", c.ideal, "dashed"],
        ["prediction", c.predicted, "dashed"], some && ["Maxwell's equations", c.exact, "dots"],
        [slope.band, c.middle], ["± of that", c.band, "area"], ["chosen diameter", c.mark, "dashed"],
      ]);
    });
    saved.set("phase_slope.csv", () => csv(
      ["diameter_um", ...Object.keys(found).slice(1).map((name) => `${name}_mrad_per_nm`)],
      Object.values(found)));
  }

  if (values.spectra) {
    const s = values.spectra, k = unpacked(s.wavenumber), depth = unpacked(s.depth);
    const [intensity, decibel] = [unpacked(s.intensity), unpacked(s.decibel)];
    const nominal = unpacked(s.nominal);
    const row = (all, one, count) => all.subarray(one * count, (one + 1) * count);
    const nanometres = (one) => 2000 * Math.PI / one;
    makers.set("spectrum", () => {
      const c = colours(), found = row(intensity, at, k.length);
      const [unit, y] = scaled(found), range = ends(y, [0]);
      chart("spectrum", {
        scales: { x: { time: false }, y: { range: () => range } },
        axes: axes("Wavenumber (1/µm)", `Intensity${unit}`),
        series: [{}, { stroke: c.slope, width: 1.5, points: { show: false } }],
      }, [Array.from(k), gaps(y)], `Spectrum at the diameter ${told(diameter[at])} µm`);
      const [long, short] = [nanometres(k[0]), nanometres(k[k.length - 1])];
      key("spectrum", [[`intensity, ${told(long, 3)} nm at the left to ${told(short, 3)} nm at the right`, c.slope]]);
    });
    makers.set("ascan", () => {
      const c = colours(), y = row(decibel, at, depth.length);
      chart("ascan", {
        scales: { x: { time: false }, y: { range: () => [Math.max(ends(y)[0], -80), 3] } },
        axes: axes("Optical depth (µm)", "Magnitude (dB)"),
        series: [{}, { stroke: c.slope, width: 1.5, points: { show: false } }],
        hooks: { draw: [(u) => marked(u, nominal[at], [2, 3])] },
      }, [Array.from(depth), gaps(y)], `A-scan at the diameter ${told(diameter[at])} µm`);
      key("ascan", [["magnitude over its largest", c.slope], ["n d, the neuron's far side from its near side", c.mark, "dashed"]]);
    });

    const shades = s.colours.map((one) => [1, 3, 5].map((i) => parseInt(one.slice(i, i + 2), 16)));
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [k.length, diameter.length];
    const context = picture.getContext("2d"), pixels = context.createImageData(k.length, diameter.length);
    for (let i = 0; i < intensity.length; i++) {
      const line = Math.floor(i / k.length), to = 4 * ((diameter.length - 1 - line) * k.length + i % k.length);
      const value = Math.round((shades.length - 1) * intensity[i] / s.largest);
      const shade = shades[Math.min(Math.max(value, 0), shades.length - 1)];
      if (shade && Number.isFinite(value)) pixels.data.set([...shade, 255], to);
    }
    context.putImageData(pixels, 0, 0);
    makers.set("image", () => {
      const half = diameter.length > 1 ? (diameter[1] - diameter[0]) / 2 : 0.01;
      const range = [diameter[0] - half, diameter[diameter.length - 1] + half];
      chart("image", {
        scales: { x: { time: false, range: () => [k[0], k[k.length - 1]] }, y: { range: () => range } },
        axes: axes("Wavenumber (1/µm)", "Diameter (µm)"),
        series: [{}, { show: true, width: 0, points: { show: false } }],
        hooks: {
          drawSeries: [({ ctx, bbox }) => {
            ctx.save();
            ctx.imageSmoothingEnabled = false;
            ctx.drawImage(picture, bbox.left, bbox.top, bbox.width, bbox.height);
            ctx.restore();
          }],
          draw: [(u) => {
            const y = u.valToPos(diameter[at], "y", true), { ctx, bbox } = u;
            ctx.save();
            ctx.strokeStyle = "#ff8a3d";
            ctx.lineWidth = 2 * devicePixelRatio;
            ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
            ctx.beginPath();
            ctx.moveTo(bbox.left, y);
            ctx.lineTo(bbox.left + bbox.width, y);
            ctx.stroke();
            ctx.restore();
          }],
          ready: [(u) => chosenBy(u, "y")],
        },
      }, [Array.from(k), Array(k.length).fill(diameter[0])], "Intensity of all spectra, as an image");
      key("image", [["chosen diameter", "#ff8a3d", "dashed"]]);
      place("scale").style.background = `linear-gradient(to right, ${s.colours.join(",")})`;
      place("largest").textContent = s.largest === null ? "not known" : told(s.largest, 3);
    });
    const named = (one) => `diameter_${diameter[one]}_um`;
    saved.set("spectrum.csv", () => csv(["wavenumber_per_um", `intensity_at_${named(at)}`], [k, row(intensity, at, k.length)]));
    saved.set("a_scan.csv", () => csv(["optical_depth_um", `magnitude_dB_at_${named(at)}`], [depth, row(decibel, at, depth.length)]));
    saved.set("spectra.csv", () => csv(["wavenumber_per_um", ...Array.from(diameter, (_, i) => named(i))],
      [k, ...Array.from(diameter, (_, i) => row(intensity, i, k.length))]));
  }

  if (values.paths) {
    const columns = ["share", "field_amplitude", "mean_optical_path_length"].map((name) => unpacked(values.paths[name]));
    const of = (column, path, i) => column[path * diameter.length + i];
    makers.set("paths", () => {
      const [shares, fields, lengths] = columns;
      const rows = values.paths.names.map((name, path) => {
        const line = document.createElement("tr"), head = document.createElement("th");
        head.scope = "row";
        head.textContent = name;
        const share = of(shares, path, at), bar = document.createElement("span");
        bar.className = "bar";
        bar.style.width = `${Number.isFinite(share) ? Math.min(Math.abs(share), 1) * 6 : 0}em`;
        const cells = [share, of(fields, path, at), of(lengths, path, at)].map((value, column) => {
          const cell = document.createElement("td");
          cell.textContent = column ? told(value) : `${told(100 * value, 3)} %`;
          if (!column) { cell.className = "bars"; cell.prepend(bar); }
          return cell;
        });
        line.append(head, ...cells);
        return line;
      });
      place("paths-body").replaceChildren(...rows);
    });
    changing.push("paths");
    saved.set("light_paths.csv", () => csv(
      ["diameter_um", ...values.paths.names.flatMap((name) => ["share", "field_amplitude", "mean_optical_path_um"].map((one) => `${one} of ${name}`))],
      [diameter, ...values.paths.names.flatMap((_, path) => columns.map((one) => one.subarray(path * diameter.length, (path + 1) * diameter.length)))]));
  }

  values.traces.forEach((trace, number) => {
    const [time, change, error, edge, low, high] =
      ["time", "change", "error", "edge", "low", "high"].map((name) => unpacked(trace[name]));
    const name = `trace-${number}`;
    makers.set(name, () => {
      const c = colours(), range = ends(change, low, high);
      chart(name, {
        scales: { x: { time: false }, y: { range: () => range } },
        axes: axes("Time (ms)", `Change (${trace.unit})`),
        series: [{}, { stroke: c.slope, width: 1.5, points: { show: false } }],
        hooks: { drawClear: [(u) => area(u, edge, low, high, c.band)] },
      }, [Array.from(time), gaps(change)], `${trace.name} over time, ${trace.unit}`);
      key(name, [[trace.name, c.slope], ["± both errors", c.band, "area"]]);
    });
    saved.set(`trace_${number}.csv`, () => csv(["time_ms", `change_${trace.unit}`, `standard_error_${trace.unit}`], [time, change, error]));
  });

  const config = place("config-text");
  if (config) saved.set("config.yaml", () => config.textContent);

  // the numbers at the chosen diameter
  function read() {
    const facts = [];
    if (values.slope) {
      const { columns, component, fringe, predicted } = values.slope;
      const [slope, ideal] = ["phase_slope", "ideal_phase_slope"].map((name) => unpacked(columns[name])[at * values.every]);
      facts.push(["Phase slope", Number.isFinite(slope) ? `${slope.toFixed(3)} mrad/nm` : "not known"]);
      facts.push(["Ideal spectrum", `${told(ideal, 5)} mrad/nm`], ["Off the prediction", `${told(predicted === null ? NaN : slope - predicted, 3)} mrad/nm`]);
      facts.push(["Strongest component", String(component[at])]);
      if (fringe.length) facts.push(["Fringe", fringe[at] || "not known"]);
    }
    if (values.spectra) {
      facts.push(["Focus", `${told(unpacked(values.spectra.focus)[at])} µm`]);
      facts.push(["Error of the intensity", told(unpacked(values.spectra.error)[at], 2)]);
    }
    place("readout").replaceChildren(...facts.map(([name, value]) => {
      const box = document.createElement("div"), dt = document.createElement("dt"), dd = document.createElement("dd");
      [dt.textContent, dd.textContent] = [name, value];
      box.append(dt, dd);
      return box;
    }));
  }

  function choose(number) {
    at = number;
    const slider = place("diameter"), text = `${diameter[at].toFixed(4)} µm`;
    slider.value = String(at);
    slider.setAttribute("aria-valuetext", text);
    place("chosen").textContent = text;
    read();
    for (const name of changing) makers.get(name)?.();
    for (const name of ["slope", "image"]) redrawn(name);
  }

  function drawAll() {
    for (const draw of makers.values()) draw();
  }

  if (diameter) {
    const slider = place("diameter");
    slider.max = String(diameter.length - 1);
    slider.addEventListener("input", () => choose(Number(slider.value)));
    choose(at);
  }
  drawAll();
  onColours(drawAll);
  let width = document.body.clientWidth;
  new ResizeObserver(() => {
    if (document.body.clientWidth === width) return;
    width = document.body.clientWidth;
    drawAll();
  }).observe(document.body);
  for (const button of document.querySelectorAll("button[data-file]")) {
    button.addEventListener("click", () => download(button.dataset.file, saved.get(button.dataset.file)()));
  }
})();
