/* Why a film rises: molecules around a film, drawn. The numbers come with the page. */
(function () {
  "use strict";

  const section = document.getElementById("lf-rise");
  if (!section) return;
  const table = JSON.parse(section.dataset.table);
  const element = (id) => document.getElementById(id);
  const canvas = element("lf-rise-canvas");
  const pen = canvas.getContext("2d");
  const slider = element("lf-rise-altitude");
  const SVG = "http://www.w3.org/2000/svg";

  // the scene, in widths of the film; seen from the film's edge
  const WIDTH = 1.8;
  const HEIGHT = 1;
  const FILM = { left: 0.4, right: 1.4, y: 0.5 };
  const SPEED = 0.16; // of cold molecules [widths/s]
  const STEP = 1 / 60; // [s]
  const CELL = 0.1; // in which molecules meet
  const SHORTEST = 0.02; // free path that is drawn
  const KEEPS = { top: 0.25, bottom: 1 }; // share of heat taken over, drawn further apart than it is
  const KICK_LASTS = 0.9; // [s]
  const KICK_LENGTH = 0.055; // for the speed of cold molecules
  const LETTERS = 14; // [px]
  const FEWEST = 70;
  const MOST = 520;
  const REST_FRAMES = 400; // computed before a still picture is drawn
  const THIN = 1; // Knudsen numbers between which air is neither thin nor dense
  const DENSE = 0.03;

  let molecules = [];
  let kicks = [];
  let now = table.start;
  let isRunning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  let isInSight = true;
  let last = 0;
  let colours = {};

  const random = (low, high) => low + (high - low) * Math.random();

  /** A column of the table at the altitude shown. */
  function value(name, altitude = now) {
    const first = table.altitude[0];
    return table[name][Math.min(Math.max(Math.round(altitude - first), 0), table[name].length - 1)];
  }

  const knudsen = (altitude = now) => value("path", altitude) / table.diameter;

  // --- motion ---

  function enter(one) {
    const side = random(0, 2 * (WIDTH + HEIGHT));
    const speed = SPEED * random(0.8, 1.2);
    const angle = Math.asin(random(-1, 1)); // more come straight than along the wall
    const [straight, along] = [speed * Math.cos(angle), speed * Math.sin(angle)];
    if (side < WIDTH) Object.assign(one, { x: side, y: 0, u: along, v: straight });
    else if (side < 2 * WIDTH) {
      Object.assign(one, { x: side - WIDTH, y: HEIGHT, u: along, v: -straight });
    } else if (side < 2 * WIDTH + HEIGHT) {
      Object.assign(one, { x: 0, y: side - 2 * WIDTH, u: straight, v: along });
    } else Object.assign(one, { x: WIDTH, y: side - 2 * WIDTH - HEIGHT, u: -straight, v: along });
    return one;
  }

  function fill() {
    const share = Math.log10(value("pressure") / table.pressure.at(-1)) /
      Math.log10(table.pressure[0] / table.pressure.at(-1));
    const wanted = Math.round(FEWEST + (MOST - FEWEST) * share);
    while (molecules.length < wanted) {
      const one = enter({});
      [one.x, one.y] = [random(0, WIDTH), random(0, HEIGHT)];
      molecules.push(one);
    }
    molecules.length = wanted;
  }

  /** A molecule that meets a face leaves it warmer, and pushes. */
  function bounce(one, face) {
    const energy = one.u ** 2 + one.v ** 2;
    const hot = SPEED ** 2 * (value("hot") / value("cold"));
    const leaving = Math.sqrt((1 - KEEPS[face]) * energy + KEEPS[face] * hot);
    const angle = Math.asin(random(-1, 1));
    const arrived = Math.abs(one.v);
    const away = face === "top" ? -1 : 1;
    one.u = leaving * Math.sin(angle);
    one.v = away * leaving * Math.cos(angle);
    one.y = FILM.y + away * 1e-4;
    kicks.push({ x: one.x, away, size: (arrived + Math.abs(one.v)) / SPEED, age: 0 });
  }

  function move() {
    molecules.forEach((one) => {
      const before = one.y;
      one.x += one.u * STEP;
      one.y += one.v * STEP;
      const crosses = before < FILM.y !== one.y < FILM.y;
      if (crosses && one.x > FILM.left && one.x < FILM.right) {
        bounce(one, before < FILM.y ? "top" : "bottom");
      }
      if (one.x < 0 || one.x > WIDTH || one.y < 0 || one.y > HEIGHT) enter(one);
    });
    meet();
    kicks.forEach((kick) => { kick.age += STEP; });
    kicks = kicks.filter((kick) => kick.age < KICK_LASTS);
  }

  /** Molecules of a cell meet as often as their free path says; neither side of the film mixes. */
  function meet() {
    const path = Math.max(knudsen(), SHORTEST);
    const cells = new Map();
    molecules.forEach((one) => {
      const key = `${Math.floor(one.x / CELL)} ${Math.floor(one.y / CELL)}`;
      if (!cells.has(key)) cells.set(key, []);
      cells.get(key).push(one);
    });
    cells.forEach((inside) => {
      const expected = (0.5 * inside.length * SPEED * STEP) / path;
      const count = Math.floor(expected + Math.random());
      for (let pair = 0; pair < count && inside.length > 1; pair += 1) {
        const first = inside[Math.floor(Math.random() * inside.length)];
        const second = inside[Math.floor(Math.random() * inside.length)];
        if (first !== second) collide(first, second);
      }
    });
  }

  function collide(first, second) {
    const angle = random(0, 2 * Math.PI);
    const half = 0.5 * Math.hypot(first.u - second.u, first.v - second.v);
    const [u, v] = [0.5 * (first.u + second.u), 0.5 * (first.v + second.v)];
    const [across, up] = [half * Math.cos(angle), half * Math.sin(angle)];
    Object.assign(first, { u: u + across, v: v + up });
    Object.assign(second, { u: u - across, v: v - up });
  }

  // --- picture ---

  function takeColours() {
    const style = getComputedStyle(section);
    const names = ["hot", "cold", "computed", "outside", "measured", "available", "flies"];
    colours = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--lf-${name}`)]));
    colours.ink = style.color;
    colours.ground = getComputedStyle(canvas).backgroundColor;
  }

  function fitCanvas() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const wide = Math.round(canvas.clientWidth * ratio);
    if (!wide || canvas.width === wide) return;
    canvas.width = wide;
    canvas.height = Math.round((wide * HEIGHT) / WIDTH);
  }

  function arrow(x, from, to, colour, thick) {
    const head = Math.min(0.03, Math.abs(to - from)) * Math.sign(to - from);
    pen.strokeStyle = colour;
    pen.fillStyle = colour;
    pen.lineWidth = thick;
    pen.beginPath();
    pen.moveTo(x, from);
    pen.lineTo(x, to - 0.8 * head);
    pen.stroke();
    pen.beginPath();
    pen.moveTo(x, to);
    pen.lineTo(x - 0.6 * Math.abs(head), to - head);
    pen.lineTo(x + 0.6 * Math.abs(head), to - head);
    pen.fill();
  }

  /** Words at a place of the scene, in letters of the page's size. */
  function label(text, x, y, colour) {
    const scale = canvas.width / WIDTH;
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${(LETTERS * canvas.width) / canvas.clientWidth}px system-ui, sans-serif`;
    pen.lineJoin = "round";
    pen.lineWidth = 5;
    pen.strokeStyle = colours.ground;
    const room = canvas.width - pen.measureText(text).width - LETTERS / 2;
    const left = Math.min(x * scale, room);
    pen.strokeText(text, left, y * scale);
    pen.fillStyle = colour;
    pen.fillText(text, left, y * scale);
    pen.restore();
  }

  function draw() {
    fitCanvas();
    const scale = canvas.width / WIDTH;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, WIDTH, HEIGHT);
    const border = 1.25 ** 2 * SPEED ** 2; // of energy, above which a molecule is drawn warm
    molecules.forEach((one) => {
      const isWarm = one.u ** 2 + one.v ** 2 > border;
      pen.strokeStyle = isWarm ? colours.hot : colours.cold;
      pen.fillStyle = pen.strokeStyle;
      pen.lineWidth = 0.003;
      pen.beginPath();
      pen.moveTo(one.x, one.y);
      pen.lineTo(one.x - 0.18 * one.u, one.y - 0.18 * one.v);
      pen.stroke();
      pen.beginPath();
      pen.arc(one.x, one.y, 0.0072, 0, 2 * Math.PI);
      pen.fill();
    });
    kicks.forEach((kick) => {
      pen.globalAlpha = 1 - kick.age / KICK_LASTS;
      const tip = FILM.y + kick.away * 0.012;
      arrow(kick.x, tip + kick.away * KICK_LENGTH * kick.size, tip, colours.ink, 0.006);
    });
    pen.globalAlpha = 1;
    pen.fillStyle = colours.available;
    pen.fillRect(FILM.left, FILM.y - 0.007, FILM.right - FILM.left, 0.014);
    const lift = value("lift");
    const long = 0.26; // of the weight's arrow
    const place = FILM.right + 0.08;
    arrow(place, FILM.y, FILM.y + long, colours.outside, 0.014);
    arrow(place, FILM.y, FILM.y - long * lift, colours.computed, 0.014);
    label("weight", place + 0.035, FILM.y + long + 0.06, colours.ink);
    label(`lift ${percent(lift)}`, place + 0.035, FILM.y - Math.max(long * lift, 0.02) - 0.03, colours.computed);
  }

  const percent = (share) => `${(100 * share).toFixed(share < 0.1 ? 1 : 0)} %`;

  // --- curve of lift over altitude, above the slider ---

  function make(parent, name, attributes, text = null) {
    const made = document.createElementNS(SVG, name);
    Object.entries(attributes).forEach(([at, one]) => made.setAttribute(at, one));
    if (text !== null) made.textContent = text;
    parent.append(made);
    return made;
  }

  const box = { left: 9, right: 711, top: 8, bottom: 78 }; // left and right as the slider's handle
  const NARROW = 500; // px, below which every other tick is left out
  const [lowest, highest] = [table.altitude[0], table.altitude.at(-1)];
  const across = (altitude) =>
    box.left + ((box.right - box.left) * (altitude - lowest)) / (highest - lowest);
  const up = (lift) => box.bottom - ((box.bottom - box.top) * lift) / 1.25;

  function drawCurve() {
    const svg = element("lf-rise-curve");
    const wide = svg.clientWidth || 720;
    svg.setAttribute("viewBox", `0 0 ${wide} 96`);
    svg.replaceChildren();
    box.right = wide - box.left;
    const step = wide < NARROW ? 20 : 10;
    const flying = table.altitude.filter((_, index) => table.lift[index] >= 1);
    make(svg, "rect", {
      class: "lf-rise-band", x: across(flying[0] - 0.5), y: box.top,
      width: across(flying.at(-1) + 0.5) - across(flying[0] - 0.5), height: box.bottom - box.top,
    });
    make(svg, "line", { class: "lf-rise-axis", x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom });
    make(svg, "line", { class: "lf-rise-weight", x1: box.left, x2: box.right, y1: up(1), y2: up(1) });
    make(svg, "text", { x: box.left, y: up(1) - 4 }, "lift = weight");
    const path = table.altitude.map((altitude, index) =>
      `${index ? "L" : "M"}${across(altitude).toFixed(1)} ${up(table.lift[index]).toFixed(1)}`);
    make(svg, "path", { class: "lf-rise-lift", d: path.join("") });
    for (let altitude = lowest; altitude <= highest; altitude += step) {
      const anchor = altitude === lowest ? "start" : altitude === highest ? "end" : "middle";
      const text = altitude > highest - step ? `${altitude} km` : String(altitude);
      make(svg, "text", { x: across(altitude), y: 94, "text-anchor": anchor }, text);
    }
    svg.setAttribute("aria-label",
      `Lift over weight, from ${lowest} to ${highest} km. It is above one, and the film rises, ` +
      `from about ${flying[0]} to ${flying.at(-1)} km.`);
    return make(svg, "circle", { class: "lf-rise-dot", r: 6 });
  }
  let dot = drawCurve();

  // --- words ---

  function length(metres) {
    const [size, unit] = [[1, "m"], [1e-2, "cm"], [1e-3, "mm"], [1e-6, "µm"]].find(([one]) => metres >= one) || [1e-6, "µm"];
    return `${Number((metres / size).toPrecision(2))} ${unit}`;
  }

  function pressure(pascal) {
    return `${Number(pascal.toPrecision(2))} Pa`;
  }

  function words() {
    const path = length(value("path"));
    const lift = percent(value("lift"));
    const here = `${now} km, ${pressure(value("pressure"))}.`;
    const flight = value("lift") >= 1 ? "The film rises." : "The film falls.";
    const meets = `A molecule flies ${path} before it meets another.`;
    if (knudsen() > THIN) {
      return ["Thin air", `${here} ${meets} Every kick counts, but few molecules come: ` +
        `lift is ${lift} of the weight. ${flight}`];
    }
    if (knudsen() < DENSE) {
      return ["Dense air", `${here} ${meets} Collisions even the pressure out on both faces. ` +
        `Only near the edge a difference stays: lift is ${lift} of the weight. ${flight}`];
    }
    return ["In between", `${here} ${meets} Many molecules come, and most still reach the film ` +
      `cold. Here lift is largest: it is ${lift} of the weight. ${flight}`];
  }

  function moveDot() {
    dot.setAttribute("cx", across(now));
    dot.setAttribute("cy", up(value("lift")));
  }

  function show() {
    const [title, text] = words();
    const strong = document.createElement("strong");
    strong.textContent = `${title}, `;
    element("lf-rise-now").replaceChildren(strong, text);
    element("lf-rise-hot").textContent = `${value("hot").toFixed(0)} K`;
    element("lf-rise-cold").textContent = `${value("cold").toFixed(0)} K`;
    slider.setAttribute("aria-valuetext", `${now} km, ${pressure(value("pressure"))}, ${title.toLowerCase()}`);
    moveDot();
    section.querySelectorAll("[data-altitude]").forEach((button) => {
      button.setAttribute("aria-pressed", String(Number(button.dataset.altitude) === now));
    });
    fill();
    if (!isRunning) still();
  }

  function still() {
    for (let frame = 0; frame < REST_FRAMES; frame += 1) move();
    draw();
  }

  function frame(time) {
    if (!isRunning) return;
    requestAnimationFrame(frame);
    if (!isInSight || time - last < 0.8e3 * STEP) return;
    last = time;
    move();
    draw();
  }

  function go(altitude) {
    now = Number(altitude);
    slider.value = now;
    show();
  }

  function run(isWanted) {
    isRunning = isWanted;
    const button = element("lf-rise-pause");
    button.textContent = isWanted ? "Pause" : "Play";
    if (isWanted) requestAnimationFrame(frame);
  }

  slider.addEventListener("input", () => go(slider.value));
  section.querySelectorAll("[data-altitude]").forEach((button) => {
    button.addEventListener("click", () => go(button.dataset.altitude));
  });
  element("lf-rise-pause").addEventListener("click", () => run(!isRunning));
  new IntersectionObserver((seen) => { isInSight = seen[0].isIntersecting; }).observe(canvas);
  const repaint = () => { takeColours(); draw(); };
  new MutationObserver(repaint).observe(document.body, { attributeFilter: ["data-theme"] });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  new ResizeObserver(() => {
    draw();
    dot = drawCurve();
    moveDot();
  }).observe(canvas);

  takeColours();
  fill();
  for (let warm = 0; warm < REST_FRAMES; warm += 1) move();
  show();
  run(isRunning);
  draw();
})();
