// Runs the program: a request in, samples while it draws, its answer out.
"use strict";
const program = (async () => {
  const bytes = await (await fetch("fivebar.wasm")).arrayBuffer();
  const page = { drawn: (at, count) => postMessage({ rows: new Float32Array(memory(), at, count).slice() }) };
  const { instance } = await WebAssembly.instantiate(bytes, { page });
  const memory = () => instance.exports.memory.buffer;
  // A call may move the memory: it is asked for after each.
  const bytesAt = (at, length) => new Uint8Array(memory(), at, length);
  return (request) => {
    const text = new TextEncoder().encode(JSON.stringify(request));
    const at = instance.exports.request(text.length);
    bytesAt(at, text.length).set(text);
    const length = instance.exports.answer();
    const answerAt = instance.exports.answer_at();
    return JSON.parse(new TextDecoder().decode(bytesAt(answerAt, length)));
  };
})();
onmessage = async ({ data }) => {
  try {
    const answer = await program;
    const begun = performance.now();
    const answered = answer(data);
    postMessage({ of: data, answered, seconds: (performance.now() - begun) / 1000 });
  } catch (error) {
    postMessage({ of: data, answered: { error: `the program ended: ${error}` }, seconds: 0 });
  }
};
