const seen = () => [...all("output").map((output) => Number(output.dataset.value)), text(".badge")];
const dot = () => { const { left, right, top, bottom } = one("circle.cursor").getBoundingClientRect(); return [(left + right) / 2, (top + bottom) / 2]; };
press("Home", ...Array(4).fill("ArrowDown"));
const start = [...seen(), ...dot()];
press("ArrowUp");
const up = [...seen(), ...dot()];
press("End", "PageDown");
const beyond = seen();
press("End", "ArrowUp", "ArrowUp", "ArrowUp", "ArrowUp");
const last = [...seen(), ...dot()];
// A click next to the middle of the map.
const [x, y] = [start[3] + 0.52 * (last[3] - start[3]), start[4] + 0.48 * (last[4] - start[4])];
one("#plots svg").dispatchEvent(new PointerEvent("pointerdown", { clientX: x, clientY: y, buttons: 1, bubbles: true }));
const clicked = [...seen(), ...dot()];
slide(1, 0);
const slid = seen();
// The slider that has the focus, whatever the arrow's direction.
one("#axis1").focus();
press("ArrowRight");
found({ start, up, beyond, last, clicked, slid, held: seen() });
