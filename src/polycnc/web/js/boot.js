"use strict";
// Unpack the modules and the data of this page. A module becomes a blob: that is what its importers import.
(async () => {
  const failed = (text) => { document.body.prepend(Object.assign(document.createElement("p"), { className: "failed", textContent: text })); };
  if (typeof DecompressionStream === "undefined") {
    failed("This page needs a browser of 2023 or later.");
    return;
  }
  const unpacked = async (element) => {
    const bytes = Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
    element.textContent = "";
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  };
  const data = {};
  for (const element of document.querySelectorAll("script.data")) data[element.id] = await unpacked(element);
  const bare = { three: "three.module.min.js", uplot: "uPlot.esm.js" };
  const urls = {};
  let last = "";
  for (const [name, text] of JSON.parse(new TextDecoder().decode(data.modules))) {
    const resolved = text.replace(/\b(from|import)\s*(["'])([^"']+)\2/g, (all, word, quote, wanted) => {
      const url = urls[bare[wanted] ?? wanted.replace(/^\.\//, "")];
      return url ? `${word}${quote}${url}${quote}` : all;
    });
    last = urls[name] = URL.createObjectURL(new Blob([resolved], { type: "text/javascript" }));
  }
  try {
    await (await import(last)).start(data);
  } catch (error) {
    failed(`This page cannot be shown: ${error.message}`);
    throw error;
  }
})();
