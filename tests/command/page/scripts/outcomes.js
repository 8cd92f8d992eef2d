press("Home");
while (shown("output") < alpha) press("ArrowRight");
const listed = () => all("tbody").map((body) => ({
    words: body.querySelector("th").textContent, faded: body.className, pressed: body.querySelector("button").getAttribute("aria-pressed"),
    numbers: [...body.querySelectorAll("tr:not(:first-child)")].map((row) => [...row.cells].slice(1).map((cell) => cell.textContent)),
}));
const everything = listed();
press("2");
const second = listed();
const effects = all(".effect").map((effect) => effect.getAttribute("class"));
press("9");
const none = listed();
one("button[data-outcome='3']").click();
const third = listed();
found({ alpha: shown("output"), sentence: text(".sentence"), everything, second, none, third, effects, status: text("#status") });
