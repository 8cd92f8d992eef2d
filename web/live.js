// Connects the state, the controls that change it, and the answers of the core.

/** The scale of the last drawing where the next one fits into it, so that nothing jumps. */
function steady(fresh, last, isDragged) {
  if (!last || isDragged) return last ?? fresh;
  const size = ({ low, high }) => Math.hypot(high[0] - low[0], high[1] - low[1]);
  const inside = [0, 1].every((axis) => fresh.low[axis] >= last.low[axis] && fresh.high[axis] <= last.high[axis]);
  const room = 0.06 * size(fresh);
  const wide = { low: fresh.low.map((entry) => entry - room), high: fresh.high.map((entry) => entry + room) };
  const { low, high } = inside && size(fresh) > 0.5 * size(last) ? last : wide;
  const arrow = (kind) => (fresh[kind] === 0 || (fresh[kind] > 0.4 * last[kind] && fresh[kind] < 1.7 * last[kind]) ? last[kind] : fresh[kind]);
  return { ...fresh, low, high, impulse: arrow("impulse"), velocity: arrow("velocity"), before: arrow("before") };
}

/** For whoever drives the page: a promise of the function that answers questions. */
const ready = core();

ready.then((ask) => {
  const place = (id) => document.getElementById(id);
  const asked = (question) => JSON.parse(ask(JSON.stringify(question)));
  const examples = asked({ examples: null });
  /** The number of an example or the text of a file, a state of its robot, what varies, and a tolerance [m]. */
  let [source, read, state, dials, along, tolerance] = [0, null, null, [], "", null];
  let [page, chosen, known, drag] = [null, null, null, null];
  /** A timer, and how long the last sweep took [ms]. */
  let [waiting, spent] = [0, 0];
  let [robot, origin] = [null, null];
  const answer = new Answer(place("answer"), null, (outcome) => choose(outcome));

  /** Takes a robot and a state of it; the robot's own one without any. */
  function load(from, given) {
    const own = examples[from] ?? null;
    const found = asked({ robot: own ? own[1] : from });
    if (found.error) return refuse(found.error);
    [source, read, page, chosen, known] = [from, found, null, null, null];
    place("examples").value = own ? String(from) : "";
    place("read").textContent = found.text;
    take(given ?? (own ? JSON.parse(own[2]) : found.state));
  }

  /** Takes a state, in the form that has all of its coordinates. */
  function take(given) {
    const { state: whole } = asked({ impact: { of: given, tolerance } });
    state = whole ?? given;
    arrange();
    show();
  }

  function refuse({ message, place: where, hint }) {
    const words = `Refused: ${where ? `${where}: ` : ""}${message}${hint ? ` (hint: ${hint})` : ""}`;
    place("answer").replaceChildren(html("p", { className: "sentence" }, words));
    place("status").textContent = words;
  }

  /** Dials for the state's entries, and for how its base is placed. */
  function arrange() {
    const groups = entries(read, state);
    dials = [];
    const sections = Object.entries(groups).map(([name, group]) => {
      const own = group.map((entry) => new Dial(entry, (dial, value) => move(dial.in(state, value))));
      dials.push(...own);
      const more = name === "Ground" ? [infinite(), tolerated()] : name === "Position" && read.robot.base === "floating" ? [standing()] : [];
      return html("fieldset", {}, html("legend", {}, name), ...more, ...own.map((dial) => dial.element));
    });
    place("dials").replaceChildren(...sections);
    const names = dials.map(({ path }) => path.join(" "));
    const options = dials.map(({ label, path }, at) => html("option", { value: names[at] }, path.length > 2 ? `${path[0]} of ${label}` : label));
    place("along").replaceChildren(html("option", { value: "" }, "nothing"), ...options);
    if (!names.includes(along)) along = names.includes("friction") ? "friction" : "";
    place("along").value = along;
  }

  /** Whether friction is infinite. */
  function infinite() {
    const box = html("input", { type: "checkbox", checked: state.friction === "infinite" });
    box.addEventListener("change", () => move({ ...state, friction: box.checked ? "infinite" : 0.6 }));
    return html("label", {}, box, " infinite friction");
  }

  function tolerated() {
    const number = html("input", { type: "number", min: 0, step: "any", value: tolerance ?? "", placeholder: "as usual" });
    number.addEventListener("input", () => {
      tolerance = number.value === "" ? null : Math.max(0, Number(number.value));
      show();
    });
    return html("label", { className: "dial" }, html("span", {}, "touches within", html("small", {}, " m")), number);
  }

  /** How the base is placed. */
  function standing() {
    const feet = [...new Set(read.robot.feet.map((foot) => foot.link))];
    const choice = html("select", {}, html("option", { value: "" }, "where x and z say"), html("option", { value: "place" }, "on its lowest foot"),
      ...feet.map((link) => html("option", { value: `foot ${link}` }, `on ${link}, at rest`)));
    choice.value = state.stance ? `foot ${state.stance}` : state.place === "lowest" ? "place" : "";
    choice.addEventListener("change", () => {
      const { stance, place: lowest, ...rest } = structuredClone(state);
      const [x, z] = origin ?? [0, 0];
      const isOnFoot = choice.value.startsWith("foot ");
      for (const [group, base] of [[rest.position, { x, z }], [rest.velocity, { x: 0, z: 0 }]]) {
        const { x: ownX = base.x, z: ownZ = base.z, ...turn } = group.base ?? {};
        group.base = isOnFoot ? turn : { x: ownX, z: ownZ, ...turn };
      }
      if (isOnFoot) rest.stance = choice.value.slice(5);
      if (choice.value === "place") rest.place = "lowest";
      take(rest);
    });
    return html("label", {}, "stands ", choice);
  }

  function move(next) {
    state = next;
    show();
  }

  function choose(outcome) {
    const outcomes = page?.frames[0].outcomes.length ?? 0;
    chosen = outcome !== null && outcome < outcomes ? outcome : null;
    draw();
  }

  /** Asks what happens, and shows it. */
  function show() {
    const { result, text, base, page: fresh } = asked({ impact: { of: state, tolerance } });
    origin = base ?? origin;
    page = { ...fresh, scale: steady(fresh.scale, page?.scale, drag !== null) };
    if (chosen !== null && chosen >= fresh.frames[0].outcomes.length) chosen = null;
    for (const dial of dials) dial.show(state);
    place("text").textContent = text;
    place("result").textContent = JSON.stringify(result, null, 1);
    if (document.activeElement !== place("state")) place("state").value = JSON.stringify(state, null, 1);
    document.title = `heelstrike: ${read.robot.name}`;
    draw();
    follow();
    clearTimeout(waiting);
    waiting = setTimeout(() => { survey(); keep(); }, Math.min(2000, Math.max(120, 2 * spent)));
  }

  function draw() {
    const [frame] = page.frames;
    if (!robot) robot = new Robot(place("scene"), place("key"), page);
    Object.assign(robot, { data: page, shown: [frame, chosen] });
    robot.fit();
    answer.data = page;
    answer.show(frame, chosen);
    const words = [page.texts[frame.sentence], ...frame.outcomes.map((outcome, number) => `${number + 1}: ${page.texts[outcome.words]}`)].join(" ");
    // Screen readers announce the change.
    if (place("status").textContent !== words) place("status").textContent = words;
    place("scene").setAttribute("aria-label", `The robot: ${words}`);
  }

  const varied = () => dials.find(({ path }) => path.join(" ") === along);

  /** The regions along the chosen entry, if they may have changed. */
  function survey() {
    const dial = varied();
    const name = dial?.label.replace(/\W/g, "_").replace(/^(?=\d)/, "_");
    const { id, uncertainty, ...rest } = state;
    const [from, to] = dial ? [Number(dial.range.min), Number(dial.range.max)] : [0, 0];
    const of = dial && { parameters: { [name]: { from, to, steps: 25 } }, state: dial.in(rest, name) };
    const question = JSON.stringify({ sweep: { of, tolerance } });
    if (known?.question === question) return;
    known = { question };
    const [control, plots] = [place("control"), place("plots")];
    control.replaceChildren();
    plots.replaceChildren();
    if (!dial) return;
    const start = performance.now();
    const swept = JSON.parse(ask(question));
    spent = performance.now() - start;
    if (swept.error) return control.append(html("p", {}, `No regions: ${swept.error.message}`));
    const go = (stop) => move(dial.in(state, swept.page.axes[0].values[stop]));
    const slider = new Slider(control, swept.page, 0, go);
    const [{ values }] = swept.page.axes;
    const here = () => (typeof dial.of(state) === "number" ? nearest(values, dial.of(state)) : values.length - 1);
    control.append(buttons({
      step: (way) => go(Math.min(values.length - 1, Math.max(0, here() + way))),
      border: (way) => go(border(swept.page.frames.map((frame) => frame.region), here(), way)),
      again: () => here() === values.length - 1 && (go(0), true),
    }));
    plots.innerHTML = swept.svg;
    known = { question, dial, slider, here, swept, plots: new Plots(plots, swept.page, ([value]) => move(dial.in(state, value))) };
    follow();
  }

  /** Moves slider and cursor of the regions to the state. */
  function follow() {
    if (!known?.slider) return;
    const { dial, slider, here, swept, plots } = known;
    const value = dial.of(state);
    if (typeof value !== "number") {
      slider.none(value);
      plots.hide();
      return;
    }
    const region = swept.page.regions[swept.page.frames[here()].region];
    slider.show(here(), "", region ? `region ${region.name}` : "", value);
    plots.show([value]);
  }

  const link = () => `#${encodeURIComponent(JSON.stringify({ robot: source, state, tolerance, along }))}`;

  /** Keeps everything in the page's address. */
  function keep() {
    if (link().length < 60000) history.replaceState(null, "", link());
  }

  /** What an address holds, or the first example. */
  function open() {
    let kept = {};
    try {
      kept = JSON.parse(decodeURIComponent(location.hash.slice(1)) || "{}");
    } catch {
      // The address was cut off: begin anew.
    }
    tolerance = kept.tolerance ?? null;
    along = kept.along ?? "";
    load(kept.robot ?? 0, kept.state);
  }

  /** The body that is nearest to a point of the screen, within a finger's reach. */
  function grasped(event) {
    const distance = (line) => {
      const [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map((name) => Number(line.getAttribute(name)));
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(place("scene").getScreenCTM().inverse());
      const part = Math.min(1, Math.max(0, ((at.x - x1) * (x2 - x1) + (at.y - y1) * (y2 - y1)) / (Math.hypot(x2 - x1, y2 - y1) ** 2 || 1)));
      return Math.hypot(at.x - x1 - part * (x2 - x1), at.y - y1 - part * (y2 - y1));
    };
    const part = event.target.closest("g[data-body]");
    if (part) return Number(part.dataset.body);
    const bones = [...place("scene").querySelectorAll("line[data-body]")].map((line) => [distance(line), Number(line.dataset.body)]);
    const [near] = bones.sort(([a], [b]) => a - b);
    return near && near[0] < 24 ? near[1] : null;
  }

  /** Turns or shifts the joint of the body that is dragged, or the base. */
  function pull(event) {
    const to = [event.clientX, event.clientY];
    const { body, from } = drag;
    const { bodies } = page.frames[0].pose;
    const { joints, bodies: named } = read.robot;
    const [, x, z] = bodies[body];
    const center = new DOMPoint(...robot.at([x, z])).matrixTransform(place("scene").getScreenCTM());
    const angle = ([px, py]) => Math.atan2(py - center.y, px - center.x);
    // Clockwise on the screen is positive about the plane's normal.
    const turn = Math.atan2(Math.sin(angle(to) - angle(from)), Math.cos(angle(to) - angle(from)));
    const shift = [(to[0] - from[0]) / robot.zoom, (from[1] - to[1]) / robot.zoom];
    const joint = joints.find(({ child }) => child === named[body].name);
    const dial = (name, part) => dials.find(({ path }) => path[0] === "position" && path[1] === part && path[2] === name);
    const moves = [];
    if (joint?.type === "turn") moves.push([dial(joint.name, "joints"), joint.sign * turn]);
    else if (joint) {
      const [, , , cos, sin] = bodies[named.findIndex(({ name }) => name === joint.parent)];
      const [dx, dz] = joint.direction;
      moves.push([dial(joint.name, "joints"), shift[0] * (cos * dx - sin * dz) + shift[1] * (sin * dx + cos * dz)]);
    } else if (dial("z", "base")) moves.push([dial("x", "base"), shift[0]], [dial("z", "base"), shift[1]]);
    else moves.push([dial("pitch", "base"), turn]);
    drag.from = to;
    const before = state;
    const next = moves.filter(([dial]) => dial).reduce((state, [dial, by]) => dial.in(state, dial.of(state) + by), state);
    move(next);
    // A refused state, such as one deep in the ground, is taken back.
    if (!page.frames[0].pose) move(before);
  }

  const scene = place("scene");
  scene.addEventListener("pointerdown", (event) => {
    const body = page?.frames[0].pose ? grasped(event) : null;
    if (body === null) return;
    drag = { body, from: [event.clientX, event.clientY] };
  });
  addEventListener("pointermove", (event) => { if (drag) pull(event); });
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => { if (drag) { drag = null; show(); } });

  place("examples").replaceChildren(...examples.map(([name], at) => html("option", { value: String(at) }, name)), html("option", { value: "", hidden: true }, "from a file"));
  place("examples").addEventListener("change", (event) => { along = ""; load(Number(event.target.value)); });
  place("along").addEventListener("change", (event) => { along = event.target.value; show(); });
  place("state").addEventListener("input", (event) => {
    try {
      take(JSON.parse(event.target.value));
    } catch ({ message }) {
      refuse({ message, place: "the state" });
    }
  });
  const copy = (text) => navigator.clipboard?.writeText(text).catch(() => {}) ?? place("state").select();
  place("copy").addEventListener("click", () => copy(JSON.stringify(state)));
  place("link").addEventListener("click", () => copy(location.href.split("#")[0] + link()));

  /** A URDF file, or a state of the robot that is there. */
  const file = async ([given]) => {
    if (!given) return;
    const text = await given.text();
    if (text.trimStart().startsWith("<")) load(text);
    else { place("state").value = text; place("state").dispatchEvent(new Event("input")); }
  };
  place("file").addEventListener("change", (event) => file(event.target.files));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => { event.preventDefault(); file(event.dataTransfer.files); });
  addEventListener("hashchange", () => { if (location.hash !== link()) open(); });
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || /^(input|select|textarea)$/i.test(event.target.tagName) && event.target.type !== "range") return;
    if (/^[0-9]$/.test(event.key)) choose(event.key === "0" ? null : Number(event.key) - 1);
    if (event.key === "Escape") choose(null);
  });

  open();
}).catch(({ message }) => { document.getElementById("answer").textContent = `This browser cannot run the core: ${message}`; });
