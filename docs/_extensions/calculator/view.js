/* The calculator's page: reads sliders, shows what the core says. No physics in here. */
(function () {
  "use strict";

  const core = globalThis.lightflyerCore;
  const { about, amount, general, pretty } = core;
  const { create, ...figures } = globalThis.lightflyerFigures;
  const bands = globalThis.lightflyerBands;
  const STEPS = 1000; // of a logarithmic slider
  const SLIDER_DIGITS = 3;
  const SETTLED_AFTER = 600; // ms without a move
  const SAVED_AFTER = 10e3; // ms
  const WHERE = about.numbers.find(({ name }) => name === about.coordinate);
  const LINK = "#design:";
  const PLUS_MINUS = /\s*(?:±|\+\/-|\+-)\s*/;
  const RESTED = 150; // ms without a move, from which on bands are computed
  const AT_ONCE = 8; // ms of it between two redraws
  const MOST_UNDONE = 200;
  const SWEEP = 6e3; // ms from one end of a slider to the other, and back
  const NARROW = "(max-width: 46rem)"; // as in calculator.css
  const EMBEDDED = { width: 1100, height: 900 }; // [px]

  const values = core.defaults();
  const spreads = core.spreads(); // standard uncertainties
  let model = Object.keys(about.models)[0];
  let settling = 0;
  let waiting = false;
  let playing = null; // number whose slider moves by itself
  const history = []; // what was shown before, the latest last
  let shown = "";
  let hasBands = true; // wanted by the reader
  let banding = 0; // timer of the bands to come
  let results = null; // what the page shows

  const element = (id) => document.getElementById(id);
  const key = (name) => `lf-${name.replaceAll(".", "-")}`;

  // --- controls ---

  function toSlider(number, value) {
    if (!number.logarithmic) return value;
    return (STEPS * Math.log(value / number.low)) / Math.log(number.high / number.low);
  }

  function fromSlider(number, position) {
    if (!number.logarithmic) return Number(position.toFixed(number.digits));
    const value = number.low * (number.high / number.low) ** (position / STEPS);
    return Number(value.toPrecision(SLIDER_DIGITS));
  }

  /** Value and ± of a text, and what is wrong with it. */
  function read(number, text) {
    const [first, second, ...more] = text.trim().replaceAll(",", ".").split(PLUS_MINUS);
    const value = first === "" ? NaN : Number(first);
    const spread = second === undefined ? 0 : Number(second || NaN);
    return { value, spread, problem: problemWith(number, value, more.length ? NaN : spread) };
  }

  function problemWith(number, value, spread) {
    const { least, most, positive } = number;
    const unit = number.unit ? ` ${pretty(number.unit)}` : "";
    if (!Number.isFinite(value)) return "must be a number";
    if (value > most) return `must be at most ${general(most, 6)}${unit}`;
    if (positive && value <= 0) return "must be positive";
    if (value < least) return `must be at least ${general(least, 6)}${unit}`;
    if (!(spread >= 0 && spread < Infinity)) return "must have a positive number after its ±";
    if (spread > 0 && (!number.computed || number === WHERE)) return "takes no ±";
    return "";
  }

  function set(number, { value, spread }) {
    values[number.name] = value;
    spreads[number.name] = spread;
  }

  function show(number, but = null) {
    const slider = element(key(number.name));
    const box = element(`${key(number.name)}-box`);
    const value = values[number.name];
    if (but !== slider) slider.value = toSlider(number, value);
    const text = core.inWords(value, spreads[number.name]);
    if (but !== box) box.value = text;
    slider.setAttribute("aria-valuetext", `${text} ${number.unit}`.trim());
    const isFirst = value === number.default && spreads[number.name] === number.spread;
    element(`${key(number.name)}-reset`).hidden = isFirst;
    complain(number, "");
  }

  function complain(number, problem) {
    const box = element(`${key(number.name)}-box`);
    box.setAttribute("aria-invalid", String(problem !== ""));
    element(`${key(number.name)}-error`).textContent = problem;
  }

  function connect(number) {
    const slider = element(key(number.name));
    const box = element(`${key(number.name)}-box`);
    slider.addEventListener("input", () => {
      values[number.name] = fromSlider(number, Number(slider.value));
      show(number, slider);
      request();
    });
    box.addEventListener("input", () => {
      const { problem, ...found } = read(number, box.value);
      if (problem === "") {
        set(number, found);
        show(number, box);
        request();
      } else complain(number, `${problem}; results are for ${values[number.name]}`);
    });
  }

  function connectTools(number) {
    const reset = element(`${key(number.name)}-reset`);
    reset.addEventListener("click", () => {
      set(number, { value: number.default, spread: number.spread });
      show(number);
      element(key(number.name)).focus();
      request();
    });
    element(`${key(number.name)}-play`).addEventListener("click", () => {
      play(playing === number ? null : number);
    });
  }

  /** Let a slider move to its ends and back, or stop the one that does. */
  function play(number) {
    if (playing !== null) element(`${key(playing.name)}-play`).setAttribute("aria-pressed", "false");
    playing = number;
    if (number === null) return;
    element(`${key(number.name)}-play`).setAttribute("aria-pressed", "true");
    const [low, high] = [number.low, number.high].map((end) => toSlider(number, end));
    const start = Math.min(Math.max((toSlider(number, values[number.name]) - low) / (high - low), 0), 1);
    let began = null;
    const step = (time) => {
      if (playing !== number) return;
      began ??= time;
      const turned = (start + (time - began) / SWEEP) % 2;
      const share = turned > 1 ? 2 - turned : turned;
      values[number.name] = fromSlider(number, low + share * (high - low));
      show(number);
      update();
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /** Keep what was shown, once a row of moves has ended. */
  function remember() {
    const here = JSON.stringify({ model, values, spreads });
    if (shown && shown !== here) history.push(shown);
    if (history.length > MOST_UNDONE) history.shift();
    shown = here;
    element("lf-undo").disabled = history.length === 0;
  }

  function undo() {
    play(null);
    const before = JSON.parse(history.pop());
    ({ model } = before);
    Object.assign(values, before.values);
    Object.assign(spreads, before.spreads);
    shown = JSON.stringify(before);
    element("lf-undo").disabled = history.length === 0;
    showAll();
  }

  /** Put a text where it can be pasted from; shows it where the browser does not allow that. */
  async function copy(text, done) {
    try {
      await navigator.clipboard.writeText(text);
      element("lf-told").textContent = done;
    } catch {
      element("lf-told").textContent = text;
    }
  }

  function embedCode() {
    const { width, height } = EMBEDDED;
    const address = location.href.replaceAll("&", "&amp;");
    return `<iframe src="${address}" width="${width}" height="${height}" title="lightflyer"></iframe>`;
  }

  function share() {
    element("lf-undo").addEventListener("click", undo);
    element("lf-preset").addEventListener("change", ({ target }) => {
      play(null);
      if (target.value) take(target.value);
    });
    element("lf-link").addEventListener("click", () => {
      keepInAddress();
      copy(location.href, "The link is in the clipboard.");
    });
    element("lf-embed").addEventListener("click", () => {
      keepInAddress();
      copy(embedCode(), "Code for another page is in the clipboard.");
    });
    const isUndo = (event) => (event.ctrlKey || event.metaKey) && event.key === "z" && !event.shiftKey;
    document.addEventListener("keydown", (event) => {
      if (!isUndo(event) || event.target.type === "text" || history.length === 0) return;
      event.preventDefault();
      undo();
    });
    document.documentElement.classList.toggle("lf-embedded", window.self !== window.top);
    window.addEventListener("hashchange", () => {
      if (location.hash.startsWith(LINK)) take(location.hash);
    });
  }

  /** Show what an address says. */
  function take(hash) {
    begin();
    element("lf-link-error").textContent = readAddress(hash);
    showAll();
  }

  function begin() {
    Object.assign(values, core.defaults());
    Object.assign(spreads, core.spreads());
    [model] = Object.keys(about.models);
    hasBands = true;
  }

  function showAll() {
    element("lf-model").value = model;
    element("lf-bands").checked = hasBands;
    about.numbers.forEach((number) => show(number));
    request();
  }

  function reset() {
    play(null);
    begin();
    element("lf-link-error").textContent = "";
    showAll();
  }

  /** Go to a place on the map, by shares of its axes. */
  function goTo(across, up) {
    const [diameter, altitude] = [about.size, about.coordinate].map((name) =>
      about.numbers.find((number) => number.name === name),
    );
    values[diameter.name] = fromSlider(diameter, across * STEPS);
    const ends = [altitude.low, altitude.high].map((end) => toSlider(altitude, end));
    values[altitude.name] = fromSlider(altitude, ends[0] + up * (ends[1] - ends[0]));
    show(diameter);
    show(altitude);
    request();
  }

  // --- a link to what is shown ---

  function keepInAddress() {
    const changed = about.numbers.filter(
      ({ name, default: first, spread }) => values[name] !== first || spreads[name] !== spread,
    );
    const entries = changed.map(
      ({ name }) => `${name}=${values[name]}${spreads[name] ? `+-${spreads[name]}` : ""}`,
    );
    if (!hasBands) entries.unshift("bands=off");
    if (model !== Object.keys(about.models)[0]) entries.unshift(`model=${model}`);
    const isOurs = location.hash.startsWith(LINK);
    if (entries.length) window.history.replaceState(null, "", LINK + entries.join("&"));
    else if (isOurs) window.history.replaceState(null, "", location.pathname + location.search);
  }

  /** Take what the address says; returns what is wrong with it, in words. */
  function readAddress(hash = location.hash) {
    if (!hash.startsWith(LINK)) return "";
    const wrong = [];
    const entries = hash.slice(LINK.length).split("&").filter((entry) => entry !== "");
    entries.forEach((entry) => {
      const [name, text = ""] = entry.split("=");
      const number = about.numbers.find((one) => one.name === name);
      const { problem, ...found } = number ? read(number, text) : {};
      if (name === "model" && Object.hasOwn(about.models, text)) model = text;
      else if (entry === "bands=off") hasBands = false;
      else if (problem === "") set(number, found);
      else wrong.push(number ? `${number.label} ${problem}` : `"${entry}"`);
    });
    return wrong.length ? `Not understood in the link, and left out: ${wrong.join("; ")}.` : "";
  }

  function download() {
    const file = new Blob([core.flyerFile(model, values, spreads)], { type: "application/toml" });
    const link = document.createElement("a");
    link.href = URL.createObjectURL(file);
    link.download = "flyer.toml";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), SAVED_AFTER);
  }

  // --- words ---

  function verdictOf(found) {
    const where = `at ${values[WHERE.name]} ${WHERE.unit}`;
    const needed = results.levitation_irradiance;
    const lamp = about.numbers.find(({ name }) => name === "environment.irradiance");
    const light = values[lamp.name] * lamp.factor;
    if (Number.isNaN(results.lift_over_weight)) {
      return "These numbers do not go together: shares of light above one, or an opening wider than its body.";
    }
    if (!results.converged) return `The heat balance has not converged ${where}.`;
    if (results.lift_over_weight >= 1 && core.isTooHot(values, results.temperature)) {
      const hot = amount("temperature", results.temperature);
      return `Levitates ${where}, but its film melts: it is ${hot}, and withstands ${core.limitOf(values)} K.`;
    }
    if (results.lift_over_weight >= 1) {
      const share = general(results.relative_payload, 3);
      const most = amount("payload", results.payload, found?.here.payload);
      return `Levitates ${where}, and carries up to ${most}: ${share} of its own mass.`;
    }
    if (needed === Infinity) return `Does not levitate ${where}: no light lifts it.`;
    const more = light > 0 ? `, ${general(needed / light, 3)} times the available light` : "";
    return `Does not levitate ${where}: it needs ${amount("levitation_irradiance", needed)}${more}.`;
  }

  /** In how many samples it flies there and its film survives, unless in all or in none as told. */
  function sharesOf(found, flies) {
    if (!found || found.carries === Number(flies)) return "";
    const often = `in ${core.percent(found.carries)} of ${found.samples} samples`;
    return ` ${flies ? "It" : "But it"} levitates there and survives ${often}.`;
  }

  /** What is to be done once, after a row of moves. */
  function settle(text) {
    clearTimeout(settling);
    settling = setTimeout(() => {
      element("lf-spoken").textContent = text;
      keepInAddress();
      remember();
    }, SETTLED_AFTER);
  }

  /** A correlation of errors is asked for where there are two. */
  function showCorrelation() {
    const slider = element("lf-film-tac_correlation");
    if (slider) slider.closest(".lf-number").hidden = !(spreads["film.tac_top"] && spreads["film.tac_bottom"]);
  }

  /** Show the numbers, with bands if there are any yet. */
  function showResults(found = null) {
    const state = core.stateOf(values, results, bands.uncertain(model, values, spreads).length > 0, found);
    const verdict = verdictOf(found) + sharesOf(found, ["flies", "unsure"].includes(state));
    element("lf-verdict").textContent = verdict;
    element("lf-verdict").dataset.state = state;
    about.outputs.forEach(({ name }) => {
      element(`lf-value-${name}`).textContent = results.converged ? amount(name, results[name]) : "–";
      element(`lf-band-${name}`).textContent = found ? core.bandOf(name, found.here[name]) : "";
    });
    const list = element("lf-warnings");
    list.replaceChildren(...results.warnings.map((text) => create("li", {}, text)));
    list.hidden = results.warnings.length === 0;
    settle([verdict, ...results.warnings].join(" "));
  }

  /** What bands are from, or why there are none. */
  function sayBands(text) {
    element("lf-bands-from").textContent = text;
  }

  function sourcesOf(found) {
    const own = about.models[model].uncertain.map(({ name }) => name);
    const errors = own.filter((name) => name.startsWith("force."));
    const stated = about.numbers.filter(({ name }) => spreads[name] > 0).map(({ label }) => label);
    const around = own.filter((name) => !name.startsWith("force."));
    const words = [...stated, ...around.map((name) => name.split(".")[1].replaceAll("_", " "))];
    const parts = words.length ? [`the ± of ${words.join(", ")}`] : [];
    if (errors.length) parts.push("the force model's own errors");
    return `${found.samples} samples of ${parts.join(" and ")}`;
  }

  /** Compute bands while nothing moves, a little at a time. */
  function band() {
    const work = bands.compute(model, values, spreads, figures.places);
    const go = () => {
      const until = performance.now() + AT_ONCE;
      let { done, value } = work.next();
      while (!done && performance.now() < until) ({ done, value } = work.next());
      if (!done) {
        banding = setTimeout(go);
        if (value !== undefined) sayBands(`${(100 * value).toFixed(0)} % computed`);
        return;
      }
      if (value === null) {
        sayBands("none: nothing has a ±. Write one into a box, such as 0.9 ± 0.03");
        return;
      }
      showResults(value);
      figures.showBands(value);
      sayBands(sourcesOf(value));
    };
    go();
  }

  // --- all together ---

  function update() {
    waiting = false;
    results = core.evaluate(model, values);
    showResults();
    showCorrelation();
    figures.show(model, values, results);
    clearTimeout(banding);
    sayBands(hasBands ? "…" : "off: central values only");
    if (hasBands) banding = setTimeout(band, RESTED);
  }

  function request() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(update);
  }

  function start() {
    about.outputs.forEach(({ name, title }) => {
      element("lf-values").append(
        create("dt", {}, title),
        create("dd", { id: `lf-value-${name}` }),
        create("dd", { id: `lf-band-${name}`, class: "lf-band" }),
      );
    });
    // on a phone the figures come soon after the first numbers
    const groups = [...document.querySelectorAll(".lf-controls details")];
    if (window.matchMedia(NARROW).matches) groups.slice(1).forEach((group) => (group.open = false));
    figures.prepare(goTo);
    about.numbers.forEach(connect);
    about.numbers.forEach(connectTools);
    share();
    element("lf-model").addEventListener("change", (event) => {
      model = event.target.value;
      request();
    });
    element("lf-bands").addEventListener("change", ({ target }) => {
      hasBands = target.checked;
      request();
    });
    element("lf-reset").addEventListener("click", reset);
    element("lf-download").addEventListener("click", download);
    element("lf-link-error").textContent = readAddress();
    remember();
    showAll();
    // the calculator may be far down its page
    if (location.hash.startsWith(LINK)) element("lf-calculator").scrollIntoView({ behavior: "instant" });
  }

  start();
})();
