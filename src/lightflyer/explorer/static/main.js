// The page: what it holds, and what happens when something moves.
import { ask, at, fill, get, make, work } from "./api.js";
import { Figures, frame } from "./figures.js";
import { Form, put } from "./form.js";
import { Tabs, goText } from "./tabs.js";

const REST = 180; // ms without a move, after which slow figures begin
const HEAVY = 90; // ms that the curves of a design take, from which on the prediction waits for a rest
const REST_OF_HEAVY = 350;
const SLOW = 700; // ms after which the page says why it takes long

class Explorer {
  constructor(grammar) {
    this.grammar = grammar;
    this.figures = new Figures();
    this.pins = [];
    this.document = {};
    this.version = 0; // of the design, counted up by each move
    this.tags = {};
    this.form = new Form(at("form"), grammar, {
      edit: (dotted, value, anew) => this.edit(dotted, value, anew),
      change: (section, tag) => this.change(section, tag),
    });
    for (const figure of document.querySelectorAll(".figures figure")) frame(figure, (what) => this.tabs.download(what));
    this.figures.dark = new Map(grammar.palette);
    this.tabs = new Tabs(this);
    this.figures.onTap = (x, y) => this.goTo(x, y);
  }

  // ---- what the page holds ----

  // The address is that of the design, then what the page looks at: see "address".
  async open(question) {
    const { url = "", looked } = apart(question.url);
    const mine = this.opening = {};
    const answer = await ask("open", { ...question, ...(question.url === undefined ? {} : { url }) });
    if (this.opening !== mine) return; // another was opened meanwhile
    this.opening = undefined;
    if (looked) this.tabs.look(looked);
    if (question.url !== undefined && answer.url !== undefined) this.write(answer.url, "replaceState"); // no step of its own
    await this.take(answer, answer.errors ?? []);
  }

  async take(answer, told = []) {
    this.told = told;
    if (!answer.document) return this.mistakes(told);
    Object.assign(this, { document: answer.document, pins: answer.pins });
    at("at").value = answer.at;
    this.show(answer);
    await this.move();
  }

  // The form of another document, at once; results follow.
  show({ document, tags, models }) {
    Object.assign(this, { document, tags });
    this.form.show(document, tags, models);
    this.tabs.showMission(this.form, document);
  }

  edit(dotted, value, anew = false) {
    put(this.document, dotted, value);
    this.told = [];
    if (anew) this.anew = true;
    this.moved(performance.now());
  }

  async change(section, tag) {
    const answer = await ask("switch", { document: this.document, section, tag });
    if (answer.errors) return this.mistakes(answer.errors);
    this.show(answer);
    if (section === "mission" && tag) this.told = [];
    await this.move();
  }

  goTo(x, y) {
    const map = this.tabs.map;
    if (!map) return;
    put(this.document, map.over, goText(x, map.unit));
    at("at").value = goText(y, map.place_unit);
    this.anew = true;
    this.moved();
  }

  view() { return { document: this.document, at: at("at").value, pins: this.pins }; }

  // ---- what happens when something moves ----

  moved(since) {
    this.since ??= since;
    this.tabs.stop();
    this.bands?.abort();
    this.move();
  }

  // One question at a time; what moves meanwhile makes one more.
  async move() {
    this.version += 1;
    this.tabs.outdate();
    if (this.asking) { this.again = true; return; }
    this.asking = true;
    const slow = setTimeout(() => this.say("preparing this kind of design, once", true), SLOW);
    do {
      this.again = false;
      const { since } = this;
      this.since = undefined;
      const asked = performance.now();
      const answer = await ask("move", this.view());
      this.took = performance.now() - asked;
      await this.applied(answer, since);
    } while (this.again);
    clearTimeout(slow);
    this.asking = false;
    this.rest();
  }

  async applied(answer, since) {
    if (answer.tags) this.tags = answer.tags;
    const kinds = answer.models ?? this.form.models;
    if (this.anew) {
      this.anew = false;
      this.show({ document: this.document, tags: this.tags, models: kinds });
    }
    this.mistakes([...(answer.errors ?? []), ...(this.told ?? [])]);
    this.wrong = !answer.figures;
    this.lost = answer.lost === true;
    document.body.classList.toggle("stale", this.wrong);
    if (answer.url !== undefined && !this.again) this.address(answer.url);
    if (!answer.figures) return;
    this.coordinate = answer.coordinate;
    if (await this.figures.prepare(answer.coordinate.logarithmic)) this.tabs.clear();
    this.scale = answer.figures.payload.scale;
    for (const [name, data] of Object.entries(answer.figures)) this.figures.put(name, data);
    this.form.setEnds(answer.sliders);
    this.showPlace(answer.place);
    requestAnimationFrame(() => setTimeout(() => {
      document.body.dataset.drawn = Number(document.body.dataset.drawn ?? 0) + 1;
      if (since) performance.measure("redraw", { start: since, end: performance.now() });
    }));
  }

  // Nothing moves any more: first the numbers, then what takes longer.
  async rest() {
    const { version } = this;
    if (this.wrong) { this.say(this.lost ? "The explorer does not answer. Figures show the last design that it computed." : "Fix the marked field. Figures show the last valid design."); return; }
    this.say("computing", true);
    if (this.took > HEAVY) {
      await new Promise((go) => { setTimeout(go, REST_OF_HEAVY); });
      if (version !== this.version) return;
    }
    const answer = await ask("predict", { document: this.document });
    if (version !== this.version) return;
    if (answer.errors) { this.mistakes(answer.errors); this.say(""); return; }
    this.showResults(answer);
    this.say("up to date");
    document.body.dataset.settled = version;
    clearTimeout(this.later);
    this.later = setTimeout(() => this.slowly(version), REST);
  }

  async slowly(version) {
    if (version !== this.version) return;
    this.tabs.refresh();
    this.showPins();
    this.placePoints();
    const mine = this.bands = new AbortController();
    try {
      const last = await work("bands", { document: this.document }, mine.signal, () => {});
      if (version !== this.version || mine.signal.aborted) return;
      if (last.result) {
        for (const [name, data] of Object.entries(last.result.figures)) this.figures.put(name, data);
        this.showReadings(last.result.readings);
        this.showVerdict(last.result.verdict);
        at("bands").textContent = [last.result.note, ...last.result.warnings].join(" ");
      }
      if (last.errors) at("bands").textContent = `Bands: ${last.errors.map((one) => one.text).join("; ")}`;
      document.body.dataset.banded = version;
    } catch (error) {
      if (error.name !== "AbortError") throw error;
    }
  }

  // Browsers refuse to change the address at every move of a slider. A row of moves is one step
  // back, which the browser's own button and "Undo" take.
  address(url) {
    if (this.opening) return; // another's address follows
    this.url = url;
    clearTimeout(this.addressing);
    this.addressing = setTimeout(() => {
      const isStep = apart(location.hash.slice(1)).url !== url;
      this.write(url, isStep ? "pushState" : "replaceState");
    }, REST);
  }

  // At once; what is pushed is a step of the history.
  write(url, how) {
    this.url = url;
    clearTimeout(this.addressing);
    const here = `#${url}${this.tabs.looked()}`;
    if (here !== location.hash) history[how]({ step: steps() + Number(how === "pushState") }, "", here);
    at("undo").disabled = steps() === 0;
  }

  undo() {
    if (steps()) history.back();
  }

  // The address is another than the design's: by the browser's buttons, or by hand.
  returned() {
    at("undo").disabled = steps() === 0;
    const url = location.hash.slice(1);
    if (apart(url).url === this.url) return;
    this.open({ url });
  }

  // ---- what it shows ----

  say(text, busy = false) {
    document.body.classList.toggle("busy", busy);
    at("doing").textContent = text;
  }

  mistakes(list) {
    this.form.showMistakes(list);
    const place = at("mistakes");
    place.hidden = list.length === 0;
    const texts = [...new Set(list.map(({ key, text }) => named(this.form.title(key), key, text)))];
    fill(place, texts.length > 1 ? make("ul", {}, ...texts.map((text) => make("li", {}, text))) : make("p", {}, texts[0] ?? ""));
  }

  showReadings(list) {
    fill(at("readings"), ...list.map((one) => make("div", { "data-reading": one.name },
      make("dt", {}, one.label), make("dd", {}, one.text), ...(one.spread ? [make("dd", { class: "spread" }, one.spread)] : []))));
    const payload = list.find(({ name }) => name.endsWith("payload_mg"));
    at("brief").textContent = [list[0], payload].filter(Boolean).map((one) => one.text).join(" · ");
  }

  showVerdict({ state, lines }) {
    at("verdict").hidden = false;
    at("verdict").dataset.state = state;
    fill(at("verdict-lines"), ...lines.map((text) => make("li", {}, text)));
    this.showSchematic(this.tags.flyer);
  }

  // A drawing of the package's own, fetched once a kind.
  async showSchematic(tag) {
    const kind = String(tag ?? "").split(" ")[0];
    if (at("schematic").dataset.kind === kind) return;
    at("schematic").dataset.kind = kind;
    fill(at("schematic"));
    const answer = this.grammar.drawn.includes(kind) ? await fetch(`static/kind-${kind}.svg`) : null;
    if (!answer?.ok || at("schematic").dataset.kind !== kind) return;
    const drawing = new DOMParser().parseFromString(await answer.text(), "image/svg+xml");
    fill(at("schematic"), document.importNode(drawing.documentElement, true));
  }

  showResults(answer) {
    this.summary = answer.summary;
    this.showReadings(answer.readings);
    this.showVerdict(answer.verdict);
    for (const [name, data] of Object.entries(answer.figures)) this.figures.put(name, data);
    if (!at("at").value.trim()) this.showPlace(answer.place);
    at("description").textContent = answer.description;
    fill(at("assumptions"), ...answer.assumptions.map((text) => make("li", {}, text)));
    fill(at("warnings"), ...answer.warnings.map((text) => make("li", {}, text)));
    at("python").textContent = answer.python;
    at("toml").textContent = answer.toml;
    fill(at("rows"), make("thead", {}, make("tr", {}, ...answer.rows.columns.map((text) => make("th", { scope: "col" }, text)))),
      make("tbody", {}, ...answer.rows.rows.map((row) => make("tr", {}, ...row.map((text) => make("td", {}, text))))));
  }

  showPlace(place) {
    const { name, unit } = this.coordinate;
    const such = name === "altitude" ? "75 km" : `5 ${unit}`;
    at("at-words").textContent = `${name}, such as ${such}; empty: where the payload is largest`;
    const [low, high] = this.figures.data.get("irradiance").x;
    const slider = at("at-slider");
    Object.assign(slider.dataset, { low, high, unit, logarithmic: this.coordinate.logarithmic });
    for (const figure of ["irradiance", "payload", "temperature"]) {
      this.figures.put(figure, { sources: { place: { x: place ? [place.x] : [] } } });
    }
    if (!place) { slider.setAttribute("aria-valuetext", "where the payload is largest"); return; }
    slider.setAttribute("aria-valuetext", `${place.x.toPrecision(4)} ${unit}`);
    if (document.activeElement !== slider) {
      const part = this.coordinate.logarithmic ? Math.log(place.x / low) / Math.log(high / low) : (place.x - low) / (high - low);
      slider.value = Math.round(1000 * part);
    }
    fill(at("place"), make("tbody", {}, ...place.rows.map((one) => make("tr", {}, make("th", { scope: "row" }, one.label), make("td", {}, one.text)))));
  }

  async showPins() {
    at("pin").disabled = this.pins.length >= this.grammar.most_pins;
    const { version } = this;
    const none = { results: [[]], differences: [], warnings: [] };
    const answer = this.pins.length ? await ask("pins", { ...this.view(), scale: this.scale }) : none;
    if (version !== this.version) return;
    if (answer.errors) { this.say(answer.errors[0].text); return; }
    const empty = { sources: { pins: { xs: [], ys: [], colour: [] } } };
    for (const name of ["irradiance", "temperature", "payload"]) this.figures.put(name, answer.figures?.[name] ?? empty);
    this.tabs.showPins(answer, this.grammar.pin_colours, (index) => { this.pins.splice(index, 1); this.move(); });
    document.body.dataset.pinned = this.pins.length;
  }

  pin() {
    if (this.wrong || this.pins.length >= this.grammar.most_pins) return;
    const { mission, ...design } = structuredClone(this.document);
    this.pins.push(design);
    this.tabs.select("pins", false);
    this.move();
  }

  // ---- files ----

  async read(input, what, told) {
    const [file] = input.files;
    input.value = "";
    if (!file) return null;
    if (file.size > this.grammar.largest_upload) {
      told(`${file.name}: has ${(file.size / 2 ** 20).toFixed(1)} MiB; at most ${this.grammar.largest_upload / 2 ** 20} MiB can be read`);
      return null;
    }
    const content = { text: await file.text(), name: file.name };
    const answer = await ask(`upload/${what}`, { ...content, document: this.document });
    if (answer.errors) { told(answer.errors.map((one) => one.text).join("\n")); return null; }
    if (what === "points") this.points = content;
    return answer;
  }

  async openFile(input) {
    const answer = await this.read(input, "design", (text) => this.mistakes(text.split("\n").map((line) => ({ key: "", text: line }))));
    if (answer) await this.take(answer);
  }

  async openPoints(input) {
    const answer = await this.read(input, "points", (text) => { at("points-words").textContent = text; });
    if (answer) this.showPoints(answer);
  }

  showPoints(answer) {
    this.placed = this.surroundings();
    this.figures.put("irradiance", { sources: { points: answer.columns } });
    at("points-words").textContent = [answer.words, ...answer.warnings].join(" ");
    at("points-clear").hidden = false;
  }

  surroundings() { return JSON.stringify(this.document.environment ?? {}); }

  // Points have a pressure: where that is depends on the surroundings.
  async placePoints() {
    if (at("points-clear").hidden || this.placed === this.surroundings()) return;
    const answer = await ask("upload/points", { ...this.points, document: this.document });
    if (!answer.errors) this.showPoints(answer);
  }

  clearPoints() {
    this.figures.put("irradiance", { sources: { points: { x: [], y: [], low: [], high: [], sample: [] } } });
    at("points-words").textContent = "";
    at("points-clear").hidden = true;
  }
}

function themed(explorer) {
  const root = document.documentElement, button = at("theme");
  const show = () => { button.textContent = root.dataset.theme === "dark" ? "Light" : "Dark"; };
  button.addEventListener("click", () => {
    root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
    try { localStorage.setItem("lightflyer-theme", root.dataset.theme); } catch { /* storage may be off */ }
    show();
    explorer.figures.dress();
  });
  show();
}

function slidePlace(explorer) {
  const { value, dataset: { low, high, unit, logarithmic } } = at("at-slider");
  const part = value / 1000;
  const place = logarithmic === "true" ? low * (high / low) ** part : Number(low) + part * (high - low);
  at("at").value = `${Number(place.toPrecision(4))} ${unit}`;
  explorer.moved(performance.now());
}

// Steps of the history that are this page's, up to the address.
function steps() { return history.state?.step ?? 0; }

// What an address has: the design, and after it what the page looks at.
function apart(text = "") {
  const [url, looked] = text.split("&looks=");
  return { url, looked };
}

// A mistake with the name of its field.
function named(title, key, text) {
  if (!title) return text;
  return text.startsWith(key) ? `${title}${text.slice(key.length)}` : `${title}: ${text}`;
}

async function begin() {
  const grammar = await get("api/grammar");
  fill(at("materials"), ...grammar.materials.map((name) => make("option", { value: name })));
  at("start").append(...grammar.starts.map((one) => make("option", { value: one.name }, one.title)));
  at("foot").textContent = `lightflyer ${grammar.version}. This page is served by this computer, and asks no other.`;
  const explorer = new Explorer(grammar);
  globalThis.explorer = explorer;
  themed(explorer);
  at("start").addEventListener("change", (event) => { if (event.target.value) explorer.open({ start: event.target.value }); event.target.value = ""; });
  at("pin").addEventListener("click", () => explorer.pin());
  at("at").addEventListener("input", () => explorer.moved(performance.now()));
  at("at-slider").addEventListener("input", () => slidePlace(explorer));
  at("open-file").addEventListener("change", (event) => explorer.openFile(event.target));
  at("points-file").addEventListener("change", (event) => explorer.openPoints(event.target));
  at("points-clear").addEventListener("click", () => explorer.clearPoints());
  at("undo").addEventListener("click", () => explorer.undo());
  addEventListener("keydown", (event) => {
    const isUndo = (event.ctrlKey || event.metaKey) && event.key === "z" && !event.shiftKey;
    if (isUndo && event.target.type !== "text") { event.preventDefault(); explorer.undo(); }
  });
  addEventListener("hashchange", () => explorer.returned());
  await explorer.open({ url: location.hash.slice(1) });
  document.body.dataset.ready = "1";
}

begin();
