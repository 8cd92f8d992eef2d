const given = (element, value, kind = "input") => { element.value = value; element.dispatchEvent(new Event(kind, { bubbles: true })); };
const state = () => JSON.parse(one("#state").value);
const seen = () => ({ result: JSON.parse(text("#result")), sentence: text(".sentence"), told: text("#status"), rate: state().velocity.base.pitch });
// Until the address holds what is shown, which comes last.
const wait = () => new Promise((done) => setTimeout(done, 50));
const kept = () => {
    const { state: own, along } = JSON.parse(decodeURIComponent(location.hash.slice(1)) || "{}");
    return JSON.stringify(own) === JSON.stringify(state()) && along === one("#along").value;
};
const rest = async () => { do await wait(); while (!kept()); };
const dial = (name) => one(`#dial-${name}`);
await rest();
const opened = seen();
const unnamed = all("input, select, textarea, button").filter((control) => !control.labels?.length && !control.ariaLabel && !control.textContent).map((control) => control.outerHTML);

given(dial("velocity-base-pitch"), 2);
const slid = seen();
given(dial("velocity-base-pitch").nextElementSibling, "-1.25");
const typed = seen();
one("fieldset input[type=checkbox]").click();
const finite = state().friction;
await rest();
given(one("#state"), JSON.stringify({ ...state(), friction: { left_foot: 0.2, right_foot: 0.9 } }));
await rest();
const by_link = {
    shown: text(".axis output"), told: one(".axis input").getAttribute("aria-valuetext"),
    cursors: all("line.cursor").filter((line) => line.style.display !== "none").length,
};
given(one("#state"), JSON.stringify({ ...state(), friction: finite }));
await rest();

const named = (name) => one(`button[aria-label="${name}"]`);
given(one("#along"), "velocity base pitch", "change");
await rest();
const strip = one(".track");
const { left, width } = strip.getBoundingClientRect();
strip.dispatchEvent(new MouseEvent("click", { clientX: left + 0.2 * width, bubbles: true }));
const swept = { regions: all(".track span").length, struck: Number(one(".axis output").dataset.value), state: state().velocity.base.pitch };
named("Next border").click();

given(one("fieldset select"), "", "change");
const free = { stance: state().stance, z: state().position.base.z, told: text("#status") };

// The shank of the left leg, about its knee.
const pointer = (kind, [clientX, clientY]) => one("#scene").dispatchEvent(new PointerEvent(kind, { clientX, clientY, buttons: 1, bubbles: true }));
const bone = all("line.bone[data-body='2']")[0];
const on = (x, y) => { const { x: left, y: top } = new DOMPoint(bone.getAttribute(x), bone.getAttribute(y)).matrixTransform(one("#scene").getScreenCTM()); return [left, top]; };
const [knee, ankle] = [on("x1", "y1"), on("x2", "y2")];
const turned = (angle) => { const [dx, dy] = [ankle[0] - knee[0], ankle[1] - knee[1]]; return [knee[0] + Math.cos(angle) * dx - Math.sin(angle) * dy, knee[1] + Math.sin(angle) * dx + Math.cos(angle) * dy]; };
const before = state().position.joints.left_knee;
pointer("pointerdown", ankle);
for (const angle of [0.1, 0.2, 0.3]) pointer("pointermove", turned(angle));
pointer("pointerup", turned(0.3));
const dragged = { before, after: state().position.joints.left_knee, turn: 0.3 };

given(one("#examples"), "1", "change");
const example = state();
given(one("#state"), JSON.stringify({ ...example, friction: "infinite" }));
press("2");
const pasted = { ...seen(), chosen: all("tbody button").map((button) => button.getAttribute("aria-pressed")) };
await rest();
const linked = state();
const { hash } = location;
given(one("#examples"), "0", "change");
await rest();
location.hash = hash;
await rest();
const reopened = state();

const dropped = async (content) => {
    const event = new DragEvent("drop", { bubbles: true, cancelable: true });
    // Files are read beside the browser's virtual time.
    Object.defineProperty(event, "dataTransfer", { value: { files: [{ text: async () => content }] } });
    document.body.dispatchEvent(event);
    await rest();
};
await dropped(block);
const file = { title: document.title, dials: all(".dial").length };
await dropped("<robot name='none'/>");
const refused = text(".sentence");
await dropped('{"frition": 1}');
found({ opened, unnamed, slid, typed, finite, by_link, swept, free, dragged, pasted, linked, reopened, dropped: file, refused, wrong_state: text(".sentence") });
