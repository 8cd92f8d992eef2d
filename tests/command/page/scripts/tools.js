const one = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
const press = (...keys) => keys.forEach((key) => (document.activeElement ?? document.body).dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true })));
const shown = (selector) => Number(one(selector).dataset.value);
const slide = (axis, stop) => { const input = one(`#axis${axis}`); input.value = stop; input.dispatchEvent(new Event("input", { bubbles: true })); };
const middle = (element) => { const box = element.getBoundingClientRect(); return box.left + box.width / 2; };
const text = (selector) => one(selector)?.textContent ?? null;
const found = (what) => {
    const all = JSON.stringify({ ...what, wrong, loaded: performance.getEntriesByType("resource").length });
    const place = document.createElement("pre");
    place.id = "found";
    place.textContent = encodeURIComponent(all);
    document.body.append(place);
};
