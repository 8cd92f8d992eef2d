ask(JSON.stringify({ robot: urdf }));
const start = performance.now();
const answers = states.map((state) => ask(`{"impact":{"of":${state}}}`));
const each = (performance.now() - start) / states.length;
// Without the drawing, as the core wrote it.
found({ results: answers.map((answer) => answer.slice('{"result":'.length, answer.indexOf(',"text":"'))), each });
