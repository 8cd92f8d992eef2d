const seen = () => ({
    stop: Number(one("#axis0").value), alpha: shown("output"), told: one("#axis0").getAttribute("aria-valuetext"),
    hip: one(".joint").getAttribute("cy"), badge: text(".badge"), cursors: all("line.cursor").map(middle),
});
const steps = {};
const then = (name, act) => { act(); steps[name] = seen(); };
const opened = seen();
then("start", () => press("Home"));
then("right", () => press("ArrowRight"));
then("left", () => press("ArrowLeft"));
then("before", () => press("ArrowLeft"));
then("border", () => press("PageUp"));
then("back", () => press("PageDown"));
then("end", () => press("End"));
then("behind", () => press("ArrowUp"));
then("slide", () => slide(0, 2));
then("home", () => press("Home"));
// The shaded parts of a panel, from left to right.
const boxes = all("#plots g[clip-path]").map((group) => group.querySelector("path").getBoundingClientRect());
press("Home");
const named = (name) => one(`button[aria-label="${name}"]`);
const clicked = ["Next border", "One step on", "One step back", "Border before"].map((name) => { named(name).click(); return seen().stop; });
const [strip] = all(".track");
const { left, width, top } = strip.getBoundingClientRect();
strip.dispatchEvent(new MouseEvent("click", { clientX: left + 0.75 * width, clientY: top, bubbles: true }));
const struck = seen().stop;
found({ opened, clicked, struck, steps, regions: boxes.map(({ left, right }) => [left, right]), windows: all("line.cursor").length });
