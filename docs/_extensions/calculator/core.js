/* What the calculator knows: results, warnings, bands and the flyer file. No page in here. */
(function () {
  "use strict";

  const { functions, about } = globalThis.lightflyerModel;
  const computed = about.numbers.filter((number) => number.computed);
  const WHERE = about.numbers.find((number) => number.name === about.coordinate);
  const COORDINATE = computed.findIndex((number) => number.name === about.coordinate);
  const SIZE = computed.findIndex((number) => number.name === about.size);
  const LIMIT_ROUNDING = 1 + 1e-5; // as in the package
  const MOST_DIGITS = 16;
  const STEP = 1e-4; // of a number, over its value, by which a slope is taken
  const SMALLEST_SLOPE = 1e-7; // elasticity that is more than rounding, of results to 1e-12
  const SURE = 0.95; // share of samples from which on it flies
  const SMALLEST = 1e-9; // width of a band, over its end, that is more than rounding
  const CLOSER = 60; // places looked at around the least light
  const CLOSE = 1e-12; // of lift over weight at an edge, and of its bracket over its place
  const MOST_STEPS = 100;
  const TWO_DIGITS = 4; // first digit of half a band below which two of its digits are told

  const place = Object.fromEntries(about.outputs.map((output, index) => [output.name, index]));
  const CONVERGED = about.outputs.length;

  /** Values that a reader sees, by name, at the start. */
  function defaults() {
    return Object.fromEntries(about.numbers.map((number) => [number.name, number.default]));
  }

  /** Their standard uncertainties. */
  function spreads() {
    return Object.fromEntries(about.numbers.map((number) => [number.name, number.spread]));
  }

  /** Arguments of a force model's compiled function, in the package's units. */
  function argumentsOf(model, values) {
    const others = about.models[model].uncertain.map(({ value }) => value);
    return [...computed.map((number) => values[number.name] * number.factor), ...others];
  }

  /** Results of one place by name, in the package's units, with warnings. */
  function evaluate(model, values) {
    const found = functions[model].evaluate(...argumentsOf(model, values));
    const results = Object.fromEntries(
      about.outputs.map((output, index) => [output.name, found[index]]),
    );
    results.converged = found[CONVERGED];
    results.warnings = warnings(model, values, results, found.slice(CONVERGED + 1));
    return results;
  }

  function warnings(model, values, results, looked) {
    const { ranges, notes } = about.models[model];
    const said = [...notes];
    ranges.forEach((range, index) => {
      said.push(...beyond(range, looked[index], results.pressure));
    });
    const limit = limitOf(values);
    if (isTooHot(values, results.temperature)) {
      said.push(
        `the flyer reaches ${results.temperature.toFixed(0)} K, and its film withstands ` +
          `${limit.toFixed(0)} K`,
      );
    }
    if (results.lift_over_weight < 0) said.push(...about.pushed.down);
    if (results.lift_over_weight === 0) said.push(...about.pushed.not);
    return [...new Set(said)];
  }

  function beyond(range, value, pressure) {
    const { name, lowest, highest } = range;
    const at = `at ${general(pressure, 3)} Pa`;
    const line = (word, limit) =>
      `${name} is ${apart(value, limit)} ${at}, ${word} ${general(limit, 3)}: ${range.beyond}`;
    if (lowest !== null && value < lowest) return [line("below", lowest)];
    if (highest !== null && value > highest) return [line("above", highest)];
    return [];
  }

  /** Temperature that all the flyer's films withstand [K]. */
  function limitOf(values) {
    return Math.min(...about.limits.map((name) => values[name]));
  }

  /** Whether a film is hotter than it withstands; temperature: [K]. */
  function isTooHot(values, temperature) {
    return temperature > limitOf(values) * LIMIT_ROUNDING;
  }

  /**
   * Whether a flyer "flies" at a place: "unsure" where its samples are not known yet, or where too
   * many of them do not, as in the explorer; "hot" where its film melts; or "not".
   */
  function stateOf(values, results, isUncertain, bands) {
    if (!(results.converged && results.lift_over_weight >= 1)) return "not";
    if (isTooHot(values, results.temperature)) return "hot";
    return isUncertain && !(bands && bands.carries >= SURE) ? "unsure" : "flies";
  }

  /** Whether a row of results is within all ranges of a force model. */
  function isInRange(model, row) {
    const { ranges } = about.models[model];
    for (let index = 0; index < ranges.length; index += 1) {
      const { lowest, highest } = ranges[index];
      const value = row[CONVERGED + 1 + index];
      if (lowest !== null && value < lowest) return false;
      if (highest !== null && value > highest) return false;
    }
    return true;
  }

  /** A value with as many digits as show that it is not the limit. */
  function apart(value, limit) {
    for (let digits = 3; digits < MOST_DIGITS; digits += 1) {
      if (general(value, digits) !== general(limit, 3)) return general(value, digits);
    }
    return String(value);
  }

  /** A number in some significant digits, as Python's format "g" has it. */
  function general(value, digits) {
    if (!Number.isFinite(value)) return String(value);
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const exponent = Number(power);
    const plain = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
    if (exponent >= -4 && exponent < digits) return plain(value.toFixed(digits - 1 - exponent));
    const size = String(Math.abs(exponent)).padStart(2, "0");
    return `${plain(mantissa)}e${exponent < 0 ? "-" : "+"}${size}`;
  }

  /** A value with its ±, where it has one. */
  const inWords = (value, spread) => (spread ? `${value} ± ${spread}` : String(value));

  /** A value with its 95 % band, with as many digits as that allows, as in the package. */
  function withBand(value, band, unit, text = general(value, 4)) {
    const half = band ? (band[1] - band[0]) / 2 : 0;
    const shownUnit = unit ? ` ${unit}` : "";
    if (!(half > SMALLEST * Math.abs(value) && half < Infinity)) return text + shownUnit;
    const rounded = value.toFixed(digitsOf(half));
    const kept = value && !Number(rounded) ? general(value, 1) : rounded; // small, in a wide band
    return `${kept}${shownUnit} (${bandText(band)})`;
  }

  /** The ends of a band, with as many digits as it allows. */
  function bandText([low, high]) {
    const digits = digitsOf((high - low) / 2);
    return [low, high].map((end) => end.toFixed(digits).replace(/^-(0\.?0*)$/, "$1")).join(" to ");
  }

  /** A share that is neither none nor all, as in the package. */
  function percent(share) {
    const text = (100 * share).toFixed(0);
    return `${["0", "100"].includes(text) ? (100 * share).toFixed(1) : text} %`;
  }

  /** Digits after the point that half a band allows. */
  function digitsOf(half) {
    const power = Math.floor(Math.log10(half));
    return Math.max(0, -power + (half < TWO_DIGITS * 10 ** power ? 1 : 0));
  }

  const pretty = (unit) => unit.replace("^2", "²");

  /** An output in words, with its unit, and its 95 % band if there is one. */
  function amount(name, value, band = null) {
    const { factor, unit } = about.outputs[place[name]];
    if (value === Infinity) return "no light suffices";
    if (Number.isNaN(value)) return "–";
    return withBand(value * factor, band?.map((end) => end * factor), pretty(unit));
  }

  /** The 95 % band of an output in words; empty where it does not move. */
  function bandOf(name, band) {
    const { factor } = about.outputs[place[name]];
    if (band === null || !Number.isFinite(band[0])) return "";
    const [low, high] = band.map((end) => end * factor);
    if (high === Infinity) return `above ${general(low, 3)}`;
    if (!(high - low > SMALLEST * Math.abs(high))) return "";
    return bandText([low, high]);
  }

  /** Rows of outputs over altitudes [m]. */
  function profile(model, values, altitudes) {
    const given = argumentsOf(model, values);
    return altitudes.map((altitude) => {
      given[COORDINATE] = altitude;
      return functions[model].evaluate(...given);
    });
  }

  /** Ranges of altitude [m] in which it levitates, lowest first. */
  function bands(model, values, altitudes, rows) {
    return ranges(model, argumentsOf(model, values), altitudes, rows);
  }

  /** The same of a compiled function's arguments. */
  function ranges(model, given, altitudes, rows) {
    const own = [...given];
    const at = (altitude) => {
      own[COORDINATE] = altitude;
      return spare(functions[model].evaluate(...own));
    };
    const found = [];
    let start = spare(rows[0]) >= 0 ? altitudes[0] : null;
    for (let index = 1; index < rows.length; index += 1) {
      const flies = spare(rows[index]) >= 0;
      if (flies === (start !== null)) continue;
      const ends = [index - 1, index].map((end) => [altitudes[end], spare(rows[end])]);
      const edge = crossing(at, flies ? ends.reverse() : ends);
      if (flies) start = edge;
      else {
        found.push([start, edge]);
        start = null;
      }
    }
    if (start !== null) found.push([start, altitudes[altitudes.length - 1]]);
    return found;
  }

  const spare = (row) => row[place.lift_over_weight] - 1;

  /** Where what is positive at the first of two ends is last so, by the Illinois method. */
  function crossing(at, [[inside, above], [outside, below]]) {
    let [kept, last] = [0, 0];
    for (let step = 0; step < MOST_STEPS; step += 1) {
      const share = above / (above - below);
      const isUseful = share > 0 && share < 1; // else halve: an end is on it, or not a number
      const middle = inside + (isUseful ? share : 0.5) * (outside - inside);
      if (Math.abs(outside - inside) <= CLOSE * Math.abs(middle)) break;
      const value = at(middle);
      if (Math.abs(value) <= CLOSE) return middle;
      if (value >= 0) [inside, above] = [middle, value];
      else [outside, below] = [middle, value];
      last = value >= 0 ? 1 : -1;
      if (last === kept && last > 0) below /= 2;
      if (last === kept && last < 0) above /= 2;
      kept = last;
    }
    return inside;
  }

  /** The widest of some ranges on its axis; undefined of none. */
  function widestOf(found) {
    const isRatio = computed[COORDINATE].logarithmic;
    const widths = found.map(([low, high]) => (isRatio ? high / low : high - low));
    return found[widths.indexOf(Math.max(...widths))];
  }

  /** Where it comes to rest when released: altitude [m] and temperature [K]; null if not in sight. */
  function rest(model, values, altitudes, found) {
    if (about.coordinate !== "altitude") return null; // nothing drifts in a chamber
    const widest = widestOf(found);
    if (!widest || widest[1] === altitudes[altitudes.length - 1]) return null;
    const [row] = profile(model, values, [widest[1]]);
    return { altitude: widest[1], temperature: row[place.temperature] };
  }

  /** A coordinate in words, with its band if there is one. */
  function placeOf(coordinate, band = null) {
    const { factor, unit, logarithmic } = WHERE;
    const value = coordinate / factor;
    const text = logarithmic ? general(value, 3) : value.toFixed(1);
    return withBand(value, band?.map((end) => end / factor), pretty(unit), text);
  }

  /** Where it flies, of some places, in the words of predict; bands: those of samples, or null. */
  function flightWords(found, places, bands) {
    const [least, most] = [places[0], places[places.length - 1]];
    const flies = found.length > 0;
    const isSure = !bands || bands.flies === Number(flies);
    const often = isSure ? "" : `in ${percent(bands.flies)} of ${bands.samples} samples`;
    if (!flies) {
      return `It does not fly between ${placeOf(least)} and ${placeOf(most)}${often && `, but does ${often}`}.`;
    }
    const widest = widestOf(found);
    const ranges = found.map((range) => {
      const [low, high] = range.map((edge, end) =>
        placeOf(edge, bands && range === widest && edge > least && edge < most ? bands.edges[end] : null));
      return `from ${range[0] <= least ? "below " : ""}${low} to ${range[1] >= most ? "above " : ""}${high}`;
    });
    return `It flies${often && `, ${often},`} ${ranges.join(" and ")}.`;
  }

  /** What becomes of it when released, in the words of predict. */
  function restWords(values, rest, bands) {
    if (rest === null) return "";
    const survives = !isTooHot(values, rest.temperature);
    const hot = withBand(rest.temperature, bands?.rest, "K", rest.temperature.toFixed(0));
    let but = "";
    if (bands && bands.survives !== Number(survives)) {
      but = `${survives ? "," : ""} in ${percent(bands.survives)} of the samples`;
    } else if (bands?.rest && bands.rest[1] > limitOf(values)) but = ", but not in all of that band";
    const film = survives ? ` and survives${but}` : but.startsWith(" in") ? `, and survives${but}` : "";
    const limit = about.limits.length ? `its film withstands ${limitOf(values)} K${film}` : "its limit is not stated";
    return `Released, it rests at ${placeOf(rest.altitude)} and ${hot}; ${limit}.`;
  }

  /** Where it needs the least light: altitude [m] and irradiance [W/m²]; null if nowhere. */
  function easiest(model, values, altitudes, rows) {
    const lights = rows.map((row) => row[place.levitation_irradiance]);
    const least = lights.indexOf(Math.min(...lights));
    if (least < 0 || !Number.isFinite(lights[least])) return null;
    const [low, high] = [Math.max(least - 1, 0), Math.min(least + 1, rows.length - 1)];
    const step = (altitudes[high] - altitudes[low]) / CLOSER;
    const near = Array.from({ length: CLOSER + 1 }, (_, at) => altitudes[low] + at * step);
    const closer = profile(model, values, near).map((row) => row[place.levitation_irradiance]);
    const best = closer.indexOf(Math.min(...closer));
    return { altitude: near[best], irradiance: closer[best] };
  }

  /**
   * Payload [kg], temperature [K], and whether the force model is within its ranges where there is
   * a payload, over diameters [m] and altitudes [m], row by row.
   */
  function map(model, values, diameters, altitudes) {
    const given = argumentsOf(model, values);
    const payload = new Float64Array(diameters.length * altitudes.length);
    const temperature = new Float64Array(payload.length);
    const inRange = new Uint8Array(payload.length);
    altitudes.forEach((altitude, row) => {
      given[COORDINATE] = altitude;
      diameters.forEach((diameter, column) => {
        given[SIZE] = diameter;
        const found = functions[model].evaluate(...given);
        const index = row * diameters.length + column;
        payload[index] = found[CONVERGED] ? found[place.payload] : NaN;
        temperature[index] = found[place.temperature];
        inRange[index] = !(payload[index] > 0) || isInRange(model, found);
      });
    });
    return { payload, temperature, inRange };
  }

  /** Change in percent of the irradiance to levitate if a number grows by 1 %. */
  function elasticities(model, values, irradiance) {
    const given = argumentsOf(model, values);
    return computed
      .map((number, index) => ({ number, value: slope(model, given, index, irradiance) / irradiance }))
      .filter(({ number, value }) => number.name !== about.coordinate && Math.abs(value) > SMALLEST_SLOPE);
  }

  /** Slope of the irradiance to levitate over the logarithm of a number, by differences. */
  function slope(model, given, index, irradiance) {
    const moved = (steps) => {
      const own = [...given];
      own[index] *= 1 + steps * STEP;
      return functions[model].evaluate(...own)[place.levitation_irradiance];
    };
    const [below, above] = [moved(-1), moved(1)];
    if (Number.isFinite(above - below)) return (above - below) / (2 * STEP);
    const side = Number.isFinite(above) ? 1 : -1; // at an end of the range, of one side
    const [near, far] = [moved(side), moved(2 * side)];
    return (side * (4 * near - far - 3 * irradiance)) / (2 * STEP);
  }

  /** The top face's emittance that is one number with a bottom face's, as one key of a file; or null. */
  function sharedTop(name, values, spreads) {
    const top = name.replace(/emittance_bottom$/, "emittance_top");
    const isOne = top !== name && spreads[name] > 0 && spreads[top] === spreads[name];
    return isOne && values[top] === values[name] ? top : null;
  }

  /** The flyer file of some values and their ±; the package gives the same numbers for it. */
  function flyerFile(model, values, spreads = {}) {
    const { version, template } = about;
    const where = computed[COORDINATE];
    const shared = about.numbers.map(({ name }) => sharedTop(name, values, spreads));
    const lines = [
      `# Made by the calculator of the documentation of lightflyer ${version}. The same numbers:`,
      `# lightflyer predict FILE --at "${values[where.name]} ${where.unit}"`,
    ];
    for (const [section, fixed] of Object.entries(template)) {
      lines.push("", `[${section}]`);
      for (const [key, value] of Object.entries(fixed)) lines.push(`${key} = ${JSON.stringify(value)}`);
      for (const [at, { name, unit }] of about.numbers.entries()) {
        const end = name.lastIndexOf(".");
        if (name.slice(0, Math.max(end, 0)) !== section || shared[at]) continue;
        const key = shared.includes(name) ? "emittance" : name.slice(end + 1);
        const text = inWords(values[name], spreads[name]);
        lines.push(`${key} = ${unit || spreads[name] ? `"${`${text} ${unit}`.trim()}"` : text}`);
      }
      if (section === "force") lines.push(`model = "${model}"`);
    }
    return `${lines.join("\n")}\n`;
  }

  globalThis.lightflyerCore = {
    about,
    place,
    defaults,
    spreads,
    evaluate,
    argumentsOf,
    isInRange,
    profile,
    bands,
    ranges,
    widestOf,
    rest,
    isTooHot,
    limitOf,
    easiest,
    placeOf,
    flightWords,
    restWords,
    stateOf,
    map,
    elasticities,
    sharedTop,
    flyerFile,
    general,
    pretty,
    amount,
    inWords,
    withBand,
    percent,
    bandOf,
  };
})();
