/* 95 % bands by samples of what is uncertain, the same as those of predict. No page in here. */
(function () {
  "use strict";

  const core = globalThis.lightflyerCore;
  const { about, place } = core;
  const { functions } = globalThis.lightflyerModel;
  const computed = about.numbers.filter((number) => number.computed);
  const COORDINATE = computed.findIndex((number) => number.name === about.coordinate);
  const SAMPLES = about.samples; // as of predict
  const MOST_DRAWS = 20 * SAMPLES; // of which some are impossible
  const [LAYERS, TAIL, AREA] = [256, 3.6541528853610088, 0.004928673233974655]; // of the ziggurat
  const SIZES = 2n ** 52n - 1n;
  const MULTIPLIER = 47026247687942121848144207491837523525n;
  const CLOSER = 20; // steps around the most lift of a sample that seems not to fly
  const COVERAGE = [0.025, 0.975];
  const TACS = ["film.tac_top", "film.tac_bottom"];
  const ENDLESS = "levitation_irradiance"; // where there is none, it is above any other

  /** What is uncertain: its index among a function's arguments, and its distribution. */
  function uncertain(model, values, spreads) {
    const sliders = computed.map((number, index) => ({
      index,
      name: number.name,
      rank: number.rank,
      value: values[number.name] * number.factor,
      spread: core.sharedTop(number.name, values, spreads) ? 0 : (spreads[number.name] || 0) * number.factor,
      least: number.least * number.factor,
      most: number.most * number.factor,
    }));
    const others = about.models[model].uncertain.map((one, index) => ({
      ...one,
      index: computed.length + index,
      least: one.least ?? -Infinity,
      most: one.most ?? Infinity,
    }));
    // in predict's order, in which the widest come first
    return [...sliders, ...others].filter(({ spread }) => spread > 0)
      .sort((one, other) => one.rank - other.rank)
      .sort((one, other) => other.spread - one.spread);
  }

  /** Edges and densities of the layers of the normal distribution (Marsaglia and Tsang 2000). */
  function layers() {
    const density = (edge) => Math.exp(-edge * edge / 2);
    const edges = [AREA / density(TAIL)]; // of the one with the tail, were it a rectangle
    edges[LAYERS - 1] = TAIL;
    for (let at = LAYERS - 2; at >= 1; at -= 1) {
      edges[at] = Math.sqrt(-2 * Math.log(AREA / edges[at + 1] + density(edges[at + 1])));
    }
    return { edges, density };
  }

  /** A function that gives normal numbers, those of NumPy's generator (PCG64, O'Neill 2014). */
  function normals() {
    const { edges, density } = layers();
    const increment = BigInt(about.random.inc);
    let state = BigInt(about.random.state);
    const word = () => {
      state = BigInt.asUintN(128, state * MULTIPLIER + increment);
      const [mixed, turn] = [BigInt.asUintN(64, (state >> 64n) ^ state), state >> 122n];
      return BigInt.asUintN(64, (mixed >> turn) | (mixed << (64n - turn)));
    };
    const share = () => Number(word() >> 11n) / 2 ** 53;
    const tail = () => {
      for (;;) {
        const beyond = -Math.log1p(-share()) / TAIL;
        if (-2 * Math.log1p(-share()) > beyond * beyond) return TAIL + beyond;
      }
    };
    return () => {
      for (;;) {
        const drawn = word();
        const [layer, size] = [Number(drawn & 255n), (drawn >> 9n) & SIZES];
        const sign = drawn & 256n ? -1 : 1;
        const found = (edges[layer] * Number(size)) / 2 ** 52;
        const inner = layer === 0 ? TAIL : layer === 1 ? 0 : edges[layer - 1];
        if (found < inner) return sign * found;
        if (layer === 0) return size & 256n ? -tail() : tail();
        const [low, high] = [density(edges[layer]), layer === 1 ? 1 : density(edges[layer - 1])];
        if (low + (high - low) * share() < density(found)) return sign * found;
      }
    };
  }

  /** Make the errors of both TACs correlated, as the values say. */
  function correlate(row, inputs, values) {
    const [top, bottom] = TACS.map((tac) => inputs.findIndex(({ name }) => name === tac));
    const shared = values["film.tac_correlation"] || 0;
    if (top < 0 || bottom < 0) return row;
    const own = [...row];
    own[bottom] = shared * row[top] + Math.sqrt(1 - shared * shared) * row[bottom];
    return own;
  }

  /** Arguments of possible samples, at the coordinate of the values. */
  function* draws(model, values, spreads) {
    const nominal = core.argumentsOf(model, values);
    const inputs = uncertain(model, values, spreads);
    const tops = computed.map(({ name }) => core.sharedTop(name, values, spreads));
    const next = normals();
    let kept = 0;
    for (let draw = 0; draw < MOST_DRAWS && kept < SAMPLES; draw += 1) {
      const given = [...nominal];
      const row = correlate(inputs.map(next), inputs, values);
      inputs.forEach(({ index, value, spread }, at) => (given[index] = value + spread * row[at]));
      tops.forEach((top, at) => {
        if (top) given[at] = given[computed.findIndex(({ name }) => name === top)];
      });
      const isPossible = inputs.every(({ index, least, most }) => given[index] > least && given[index] < most) &&
        !Number.isNaN(functions[model].evaluate(...given)[place.lift_over_weight]);
      if (!isPossible) continue;
      kept += 1;
      yield given;
    }
  }

  /** Ends of the 95 % band of some values, outwards to the next sample; null of none. */
  function ends(values, isEndless = false) {
    const counted = isEndless
      ? values.map((value) => (Number.isFinite(value) ? value : Infinity))
      : values.filter(Number.isFinite);
    if (counted.length === 0) return null;
    counted.sort((one, other) => one - other);
    const last = counted.length - 1;
    return [counted[Math.floor(COVERAGE[0] * last)], counted[Math.ceil(COVERAGE[1] * last)]];
  }

  /** Ranges in which a sample levitates between two places, around that of most lift. */
  function narrow(model, given, places, rows) {
    const lift = rows.map((row) => row[place.lift_over_weight]);
    const most = lift.indexOf(Math.max(...lift.filter((one) => !Number.isNaN(one))));
    if (most < 0) return [];
    const [low, high] = [Math.max(most - 1, 0), Math.min(most + 1, places.length - 1)];
    const near = Array.from({ length: CLOSER + 1 }, (_, at) =>
      places[low] + ((places[high] - places[low]) * at) / CLOSER);
    const own = [...given];
    const closer = near.map((coordinate) => {
      own[COORDINATE] = coordinate;
      return functions[model].evaluate(...own);
    });
    return core.ranges(model, given, near, closer);
  }

  /**
   * Bands of a design over some places, in the package's units; null if nothing is uncertain. It
   * yields often, for others to go on, the share that is done.
   */
  function* compute(model, values, spreads, places) {
    if (uncertain(model, values, spreads).length === 0) return null;
    const { evaluate } = functions[model];
    const [here, light, edges, rests] = [[], places.map(() => []), [], []];
    for (const given of draws(model, values, spreads)) {
      here.push(evaluate(...given));
      const own = [...given];
      const rows = [];
      for (const coordinate of places) {
        own[COORDINATE] = coordinate;
        rows.push(evaluate(...own));
        yield here.length / SAMPLES;
      }
      rows.forEach((one, at) => light[at].push(one[place.levitation_irradiance]));
      let found = core.ranges(model, given, places, rows);
      if (found.length === 0) found = narrow(model, given, places, rows);
      const widest = core.widestOf(found) ?? [NaN, NaN];
      edges.push(widest);
      own[COORDINATE] = widest[1];
      rests.push(found.length ? evaluate(...own)[place.temperature] : NaN);
    }
    const hot = (temperature) => core.isTooHot(values, temperature);
    const share = (rows, isSo) => rows.filter(isSo).length / rows.length;
    return {
      samples: here.length,
      places,
      light: light.map((each) => ends(each, true)),
      here: Object.fromEntries(
        about.outputs.map(({ name }) => [name, ends(here.map((row) => row[place[name]]), name === ENDLESS)]),
      ),
      edges: [0, 1].map((end) => ends(edges.map((widest) => widest[end]))),
      rest: ends(rests),
      flies: share(edges, ([low]) => !Number.isNaN(low)),
      survives: share(rests, (temperature) => !Number.isNaN(temperature) && !hot(temperature)),
      carries: share(here, (row) => row[place.lift_over_weight] >= 1 && !hot(row[place.temperature])),
    };
  }

  globalThis.lightflyerBands = { compute, draws, normals, uncertain };
})();
