press("Home");
while (Number(text("output")) < alpha) press("ArrowRight");
const shown = () => all("tbody").map((body) => ({
    words: body.querySelector("th").textContent, faded: body.className, pressed: body.querySelector("button").getAttribute("aria-pressed"),
    numbers: [...body.querySelectorAll("tr:not(:first-child)")].map((row) => [...row.cells].slice(1).map((cell) => cell.textContent)),
}));
const everything = shown();
press("2");
const second = shown();
const effects = all(".effect").map((effect) => effect.getAttribute("class"));
press("9");
const none = shown();
one("button[data-outcome='3']").click();
const third = shown();
found({ alpha: Number(text("output")), sentence: text(".sentence"), everything, second, none, third, effects, status: text("#status") });
