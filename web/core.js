// The core in WebAssembly: takes questions and returns answers.

/** Unpacks the core; gives a function that answers a question, both JSON as text. */
async function core() {
  const packed = Uint8Array.from(atob(document.getElementById("module").textContent), (sign) => sign.charCodeAt(0));
  const { readable, writable } = new DecompressionStream("gzip");
  const writer = writable.getWriter();
  writer.write(packed);
  writer.close();
  const { instance } = await WebAssembly.instantiate(await new Response(readable).arrayBuffer());
  const { memory, room, answer } = instance.exports;
  return (question) => {
    const bytes = new TextEncoder().encode(question);
    const place = room(bytes.length) >>> 0;
    new Uint8Array(memory.buffer, place, bytes.length).set(bytes);
    const from = answer() >>> 0;
    // The memory may have moved while the core answered.
    const all = new Uint8Array(memory.buffer);
    return new TextDecoder().decode(all.subarray(from, all.indexOf(0, from)));
  };
}
