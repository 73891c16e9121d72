/* The calculator's figures. No physics in here. */
(function () {
  "use strict";

  const core = globalThis.lightflyerCore;
  const { about, amount, general, place } = core;
  const SVG = "http://www.w3.org/2000/svg";
  const SLOPES = 8; // numbers of most effect that are shown

  const numbers = Object.fromEntries(about.numbers.map((number) => [number.name, number]));
  const WHERE = numbers[about.coordinate]; // altitude, or pressure in a chamber
  const { low: BOTTOM, high: TOP } = WHERE;
  const UNIT = core.pretty(WHERE.unit);
  const KILO = WHERE.factor; // of the coordinate
  const ALTITUDES = along(WHERE, 161);
  const BANDS = along(WHERE, 41); // places at which bands are known
  const DIAMETER = numbers[about.size];
  const CENTI = DIAMETER.factor; // of the size
  const MAP_DIAMETERS = along(DIAMETER, 64, true);
  const MAP_ALTITUDES = along(WHERE, 60, true);
  const MASS = about.outputs[place.payload];
  const MILLIGRAM = 1 / MASS.factor; // of masses
  const LIGHTS = about.lights; // ends of the axis of irradiance [W/m²]
  const DECADES_OF_ALL = 2.4; // of an axis, beyond which only powers of ten have ticks
  const DECADES = 4; // of payload on the map
  // Matplotlib's cividis, as in the package's maps
  const CIVIDIS = [
    [0, 34, 78], [26, 56, 111], [67, 78, 108], [97, 101, 111], [125, 124, 120],
    [155, 148, 118], [188, 174, 108], [222, 201, 88], [254, 232, 56],
  ];
  const TOO_HOT = 70; // opacity of 255 where the film does not withstand it

  const LONG = 12; // ms that a map takes, from which on it waits until nothing moves
  const RESTED = 150; // ms

  let mapping = 0;
  let mapTook = 0;
  let mapped = ""; // what the map was drawn for

  const element = (id) => document.getElementById(id);

  function spaced(low, high, count, centred = false) {
    const ends = centred ? count : count - 1;
    const shift = centred ? 0.5 : 0;
    return Array.from({ length: count }, (_, at) => low + ((high - low) * (at + shift)) / ends);
  }

  /** Values of a number along its slider, in the package's units. */
  function along({ low, high, factor, logarithmic }, count, centred = false) {
    if (!logarithmic) return spaced(low * factor, high * factor, count, centred);
    return spaced(Math.log(low), Math.log(high), count, centred).map((one) => Math.exp(one) * factor);
  }

  /** Round numbers on an axis, at most a few. */
  function ticks(low, high, isLogarithmic) {
    if (!isLogarithmic) {
      const step = [1, 2, 5, 10, 20, 50].find((one) => (high - low) / one <= 6);
      const first = Math.ceil(low / step) * step;
      return Array.from({ length: Math.floor((high - first) / step) + 1 }, (_, at) => first + at * step);
    }
    const decades = Math.log10(high / low);
    const mantissas = decades > DECADES_OF_ALL ? [1] : [1, 2, 5];
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
      mantissas.forEach((one) => found.push(Number(`${one}e${power}`)));
    }
    return found.filter((one) => one >= low * 0.999 && one <= high * 1.001);
  }

  const scaleOf = ({ low, high, logarithmic: isLogarithmic }) =>
    (isLogarithmic ? logarithmic(low, high) : linear(low, high));

  function create(name, attributes = {}, text = null) {
    const made = document.createElement(name);
    Object.entries(attributes).forEach(([at, value]) => made.setAttribute(at, value));
    if (text !== null) made.textContent = text;
    return made;
  }

  function draw(parent, name, attributes, text = null) {
    const made = document.createElementNS(SVG, name);
    Object.entries(attributes).forEach(([at, value]) => made.setAttribute(at, value));
    if (text !== null) made.textContent = text;
    parent.append(made);
    return made;
  }

  /** A plot with axes; x and y give positions of values. */
  function plot(svg, { width, height, right, x, y, xTitle, yTitle, xTicks, yTicks }) {
    const box = { left: 62, right: width - right, top: 10, bottom: height - 42 };
    const along = (scale, from, to) => {
      const [low, high] = scale.ends.map(scale.of);
      return (value) => from + ((to - from) * (scale.of(value) - low)) / (high - low);
    };
    const at = {
      box,
      width,
      height,
      x: along(x, box.left, box.right),
      y: along(y, box.bottom, box.top),
    };
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    at.under = draw(svg, "g", {});
    const axes = draw(svg, "g", { class: "lf-axes" });
    xTicks.forEach((tick) => {
      const left = at.x(tick);
      draw(axes, "line", { x1: left, x2: left, y1: box.top, y2: box.bottom });
      draw(axes, "text", { x: left, y: box.bottom + 15, "text-anchor": "middle" }, String(tick));
    });
    yTicks.forEach((tick) => {
      const top = at.y(tick);
      draw(axes, "line", { x1: box.left, x2: box.right, y1: top, y2: top });
      draw(axes, "text", { x: box.left - 6, y: top + 4, "text-anchor": "end" }, String(tick));
    });
    const middle = { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 };
    draw(axes, "text", { x: middle.x, y: height - 6, "text-anchor": "middle" }, xTitle);
    const turned = `translate(12 ${middle.y}) rotate(-90)`;
    draw(axes, "text", { transform: turned, "text-anchor": "middle" }, yTitle);
    at.over = draw(svg, "g", {});
    return at;
  }

  const linear = (low, high) => ({ ends: [low, high], of: (value) => value });
  const logarithmic = (low, high) => ({ ends: [low, high], of: Math.log });

  let curve = null;
  function prepareCurve() {
    curve = plot(element("lf-curve"), {
      width: 400,
      height: 290,
      right: 14,
      x: scaleOf(WHERE),
      y: logarithmic(...LIGHTS),
      xTitle: `${WHERE.label} [${UNIT}]`,
      yTitle: "irradiance [W/m²]",
      xTicks: ticks(BOTTOM, TOP, WHERE.logarithmic),
      yTicks: ticks(...LIGHTS, true),
    });
    curve.bands = draw(curve.under, "g", { class: "lf-bands" });
    curve.spread = draw(curve.under, "path", { class: "lf-spread" });
    curve.lines = Object.fromEntries(
      Object.keys(about.models).map((name) => [name, draw(curve.over, "path", {})]),
    );
    curve.beyond = draw(curve.over, "path", { class: "lf-needed lf-beyond" });
    curve.light = draw(curve.over, "line", { class: "lf-light" });
    curve.here = draw(curve.over, "line", { class: "lf-here" });
    curve.least = draw(curve.over, "circle", { class: "lf-dot", r: 4 });
    curve.keys = Object.fromEntries(
      Object.entries(about.models).map(([name, { title }]) => [name, legendKey(title)]),
    );
    legendKey("available light").setAttribute("class", "lf-light");
    legendKey("levitates in this light").setAttribute("class", "lf-band-key");
    curve.spreadKey = legendKey("95 % band");
    curve.spreadKey.setAttribute("class", "lf-spread-key");
  }

  function legendKey(title) {
    const entry = create("span");
    const swatch = draw(entry, "svg", { viewBox: "0 0 30 10" });
    entry.append(title);
    element("lf-curve-legend").append(entry);
    return draw(swatch, "path", { d: "M0 5h30" });
  }

  function pathOf(rows, isShown = () => true) {
    const { box } = curve;
    let path = "";
    let pen = "M";
    rows.forEach((row, index) => {
      const light = row[place.levitation_irradiance];
      if (!Number.isFinite(light) || light > LIGHTS[1] || !isShown(row)) {
        pen = "M";
        return;
      }
      const top = Math.min(curve.y(Math.max(light, LIGHTS[0])), box.bottom);
      path += `${pen}${curve.x(ALTITUDES[index] / KILO).toFixed(1)} ${top.toFixed(1)}`;
      pen = "L";
    });
    return path;
  }

  function showCurve(model, values) {
    let own = null;
    Object.keys(about.models).forEach((name, index) => {
      const rows = core.profile(name, values, ALTITUDES);
      if (name === model) own = rows;
      const line = curve.lines[name];
      const isShown = name === model ? (row) => core.isInRange(name, row) : undefined;
      line.setAttribute("d", pathOf(rows, isShown));
      const style = name === model ? "lf-needed" : `lf-other lf-other-${index}`;
      [line, curve.keys[name]].forEach((made) => made.setAttribute("class", style));
    });
    curve.beyond.setAttribute("d", pathOf(own));
    const { box } = curve;
    const found = core.bands(model, values, ALTITUDES, own);
    curve.bands.replaceChildren();
    found.forEach(([low, high]) => {
      const [left, right] = [curve.x(low / KILO), curve.x(high / KILO)];
      const size = { x: left, width: right - left, y: box.top, height: box.bottom - box.top };
      draw(curve.bands, "rect", size);
    });
    const light = values["environment.irradiance"] * numbers["environment.irradiance"].factor;
    line(curve.light, box.left, box.right, lightAt(light), lightAt(light));
    mark(curve.light, isOn(LIGHTS, light));
    const here = curve.x(values[WHERE.name]);
    line(curve.here, here, here, box.top, box.bottom);
    mark(curve.here, isOn([BOTTOM, TOP], values[WHERE.name]));
    const least = core.easiest(model, values, ALTITUDES, own);
    mark(curve.least, least !== null && isOn(LIGHTS, least.irradiance));
    if (least !== null) {
      curve.least.setAttribute("cx", curve.x(least.altitude / KILO));
      curve.least.setAttribute("cy", lightAt(least.irradiance));
    }
    const isBeyond = own.some((row) => !core.isInRange(model, row));
    const isLow = own.some((row) => row[place.levitation_irradiance] < LIGHTS[0]);
    const notes = [
      isBeyond ? "The line is faint where the force model is beyond its range." : "",
      isLow ? `It runs along the axis where less than ${LIGHTS[0]} W/m² suffice.` : "",
    ];
    const rest = core.rest(model, values, ALTITUDES, found);
    curve.words = (bands) =>
      [core.flightWords(found, ALTITUDES, bands), leastWords(least), core.restWords(values, rest, bands), ...notes]
        .join(" ").trim();
    sayCurve(null);
  }

  /** Say what the curve shows, with bands if there are any yet. */
  function sayCurve(bands) {
    const words = curve.words(bands);
    element("lf-curve-text").textContent = words;
    element("lf-curve").setAttribute("aria-label", `Irradiance to levitate over altitude. ${words}`);
    curve.spread.setAttribute("d", bands ? areaOf(bands) : "");
    mark(curve.spreadKey, bands !== null);
  }

  /** Outline of the band of the irradiance, within the axes. */
  function areaOf({ light, places }) {
    const isShown = (ends) => ends !== null && ends[0] <= LIGHTS[1];
    const pieces = [];
    light.forEach((ends, index) => {
      if (!isShown(ends)) return;
      if (index === 0 || !isShown(light[index - 1])) pieces.push([[], []]);
      const x = curve.x(places[index] / KILO).toFixed(1);
      ends.forEach((end, side) => pieces[pieces.length - 1][side].push(`${x} ${lightAt(end).toFixed(1)}`));
    });
    return pieces.map(([low, high]) => `M${[...low, ...high.reverse()].join("L")}Z`).join("");
  }

  function lightAt(light) {
    return curve.y(Math.min(Math.max(light, LIGHTS[0]), LIGHTS[1]));
  }

  const isOn = ([low, high], value) => value >= low && value <= high;

  /** Show a mark that lies on its axes, hide another. */
  function mark(made, isShown) {
    made.setAttribute("visibility", isShown ? "visible" : "hidden");
  }

  function line(made, x1, x2, y1, y2) {
    Object.entries({ x1, x2, y1, y2 }).forEach(([at, value]) => made.setAttribute(at, value));
  }

  function leastWords(least) {
    if (least === null) return "No light lifts it there.";
    const needed = amount("levitation_irradiance", least.irradiance);
    return `It needs least at ${core.placeOf(least.altitude)}: ${needed}.`;
  }

  let chart = null;
  function prepareMap(goTo) {
    const svg = element("lf-map-axes");
    chart = plot(svg, {
      width: 400,
      height: 290,
      right: 78,
      x: logarithmic(DIAMETER.low, DIAMETER.high),
      y: scaleOf(WHERE),
      xTitle: `${DIAMETER.label} [${core.pretty(DIAMETER.unit)}]`,
      yTitle: `${WHERE.label} [${UNIT}]`,
      xTicks: ticks(DIAMETER.low, DIAMETER.high, true),
      yTicks: ticks(BOTTOM, TOP, WHERE.logarithmic),
    });
    const { box, width, height } = chart;
    const canvas = element("lf-map");
    canvas.width = MAP_DIAMETERS.length;
    canvas.height = MAP_ALTITUDES.length;
    const share = (part, whole) => `${(100 * part) / whole}%`;
    canvas.style.left = share(box.left, width);
    canvas.style.top = share(box.top, height);
    canvas.style.width = share(box.right - box.left, width);
    canvas.style.height = share(box.bottom - box.top, height);
    const pieces = 40;
    const bar = { x: box.right + 10, width: 10, height: (box.bottom - box.top) / pieces + 0.5 };
    for (let piece = 0; piece < pieces; piece += 1) {
      const y = box.bottom - ((piece + 1) * (box.bottom - box.top)) / pieces;
      const fill = `rgb(${colour(piece / (pieces - 1)).join(",")})`;
      draw(chart.over, "rect", { ...bar, y, fill });
    }
    chart.marks = Array.from({ length: DECADES + 1 }, (_, decade) => {
      const y = box.bottom - ((box.bottom - box.top) * decade) / DECADES;
      return draw(chart.over, "text", { class: "lf-mark", x: box.right + 24, y: y + 4 });
    });
    chart.best = draw(chart.over, "g", {});
    chart.crosses = ["lf-halo", "lf-best"].map((style) => draw(chart.best, "path", { class: style }));
    chart.here = draw(chart.over, "circle", { class: "lf-dot", r: 5 });
    svg.addEventListener("click", (event) => goThere(event, goTo));
  }

  function goThere(event, goTo) {
    const svg = element("lf-map-axes");
    const frame = svg.getBoundingClientRect();
    const { box, width, height } = chart;
    const x = ((event.clientX - frame.left) * width) / frame.width;
    const y = ((event.clientY - frame.top) * height) / frame.height;
    if (x < box.left || x > box.right || y < box.top || y > box.bottom) return;
    const across = (x - box.left) / (box.right - box.left);
    const up = (box.bottom - y) / (box.bottom - box.top);
    goTo(across, up);
  }

  function colour(share) {
    const along = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
    const first = Math.min(Math.floor(along), CIVIDIS.length - 2);
    const rest = along - first;
    return CIVIDIS[first].map((low, part) =>
      Math.round(low + rest * (CIVIDIS[first + 1][part] - low)),
    );
  }

  function showMap(model, values) {
    const others = about.numbers.filter(({ name }) => ![WHERE.name, DIAMETER.name].includes(name));
    const wanted = JSON.stringify([model, ...others.map(({ name }) => values[name])]);
    if (wanted !== mapped) {
      mapped = wanted;
      clearTimeout(mapping);
      const given = { ...values };
      const paint = () => {
        const start = performance.now();
        paintMap(model, given);
        mapTook = performance.now() - start;
        element("lf-map").classList.remove("lf-old");
      };
      if (mapTook < LONG) paint();
      else {
        element("lf-map").classList.add("lf-old");
        mapping = setTimeout(paint, RESTED);
      }
    }
    const diameter = values[DIAMETER.name];
    chart.here.setAttribute("cx", chart.x(diameter));
    chart.here.setAttribute("cy", chart.y(values[WHERE.name]));
    const isWithin = isOn([DIAMETER.low, DIAMETER.high], diameter);
    mark(chart.here, isWithin && isOn([BOTTOM, TOP], values[WHERE.name]));
  }

  function paintMap(model, values) {
    const { payload, temperature, inRange } = core.map(model, values, MAP_DIAMETERS, MAP_ALTITUDES);
    const limit = core.limitOf(values);
    let best = -1;
    payload.forEach((mass, index) => {
      if (mass > 0 && temperature[index] <= limit && (best < 0 || mass > payload[best])) {
        best = index;
      }
    });
    const most = best < 0 ? MILLIGRAM : payload[best];
    const top = Math.ceil(Math.log10(most / MILLIGRAM) - 1e-9);
    const canvas = element("lf-map");
    const context = canvas.getContext("2d");
    const image = context.createImageData(canvas.width, canvas.height);
    payload.forEach((mass, index) => {
      if (!(mass > 0)) return;
      const column = index % canvas.width;
      const row = canvas.height - 1 - Math.floor(index / canvas.width);
      const share = 1 + (Math.log10(mass / MILLIGRAM) - top) / DECADES;
      if (!inRange[index] && (row + column) % 2) return;
      const opacity = temperature[index] > limit ? TOO_HOT : 255;
      image.data.set([...colour(share), opacity], 4 * (row * canvas.width + column));
    });
    context.putImageData(image, 0, 0);
    chart.marks.forEach((mark, decade) => {
      mark.textContent = general(10 ** (top - DECADES + decade), 3);
    });
    markBest(best, most, inRange.includes(0));
  }

  function markBest(best, most, isBeyond) {
    mark(chart.best, best >= 0);
    let words = "In this light none of these levitates with a film that withstands it.";
    if (best >= 0) {
      const diameter = MAP_DIAMETERS[best % MAP_DIAMETERS.length] / CENTI;
      const altitude = MAP_ALTITUDES[Math.floor(best / MAP_DIAMETERS.length)] / KILO;
      const [x, y] = [chart.x(diameter), chart.y(altitude)];
      const cross = `M${x - 5} ${y}h10M${x} ${y - 5}v10`;
      chart.crosses.forEach((made) => made.setAttribute("d", cross));
      words =
        `Most on this map (cross): ${amount("payload", most)}, at ${general(diameter, 3)} ` +
        `${core.pretty(DIAMETER.unit)} and ${general(altitude, 3)} ${UNIT}.`;
    }
    const chequered = isBeyond ? ", chequered where the force model is beyond its range" : "";
    const described =
      `Largest payload [${MASS.unit}] over diameter and ${WHERE.label}; ` +
      "faint where the film is hotter than it " +
      `withstands${chequered}.`;
    element("lf-map-text").textContent = `${described} ${words} Click a place to take it.`;
    element("lf-map-axes").setAttribute("aria-label", `${described} ${words}`);
  }

  let rows = [];
  function prepareSlopes() {
    rows = Array.from({ length: SLOPES }, () => {
      const row = create("tr");
      const bar = create("div");
      const cells = [create("th", { scope: "row" }), create("td"), create("td")];
      cells[1].append(bar);
      row.append(...cells);
      return { row, bar, cells };
    });
    element("lf-slopes").append(...rows.map(({ row }) => row));
  }

  function showSlopes(model, values, results) {
    const needed = results.levitation_irradiance;
    const useful = results.converged && Number.isFinite(needed) && needed > 0;
    const found = useful ? core.elasticities(model, values, needed) : [];
    found.sort((one, other) => Math.abs(other.value) - Math.abs(one.value));
    const largest = found.length ? Math.abs(found[0].value) : 1;
    rows.forEach(({ row, bar, cells }, index) => {
      row.hidden = index >= found.length;
      if (row.hidden) return;
      const { number, value } = found[index];
      cells[0].textContent = number.label;
      bar.style.width = `${(100 * Math.abs(value)) / largest}%`;
      bar.className = value > 0 ? "lf-more" : "lf-less";
      cells[2].textContent = `${value > 0 ? "+" : "−"}${general(Math.abs(value), 3)} %`;
    });
    element("lf-slopes-empty").hidden = found.length > 0;
  }

  /** Draw what does not change; a click on the map calls back with shares of its axes. */
  function prepare(goTo) {
    prepareCurve();
    prepareMap(goTo);
    prepareSlopes();
  }

  function show(model, values, results) {
    showCurve(model, values);
    showMap(model, values);
    showSlopes(model, values, results);
  }

  globalThis.lightflyerFigures = { create, prepare, show, showBands: sayCurve, places: BANDS };
})();
