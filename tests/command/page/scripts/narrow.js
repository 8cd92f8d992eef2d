document.body.style.width = `${width}px`;
document.body.style.margin = 0;
for (const more of all("details")) more.open = true;
await new Promise((done) => setTimeout(done, 300));
const parts = all("main *, header *").filter((part) => !part.closest("pre, svg"));
const beyond = parts.filter((part) => part.getBoundingClientRect().right > width);
found({ parts: parts.length, beyond: beyond.map((part) => part.outerHTML.slice(0, 80)) });
