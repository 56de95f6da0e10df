// What differs between two texts, line by line (E. Myers, "An O(ND) difference algorithm").
const MOST_CHANGES = 600;

// A list of {kind: "same" | "gone" | "new", text, a, b} with line numbers from 1; null if they have too little in common.
export function difference(one, other) {
  const a = one.split(/\r?\n/), b = other.split(/\r?\n/);
  let head = 0, tail = 0;
  while (head < a.length && head < b.length && a[head] === b[head]) head++;
  while (tail < a.length - head && tail < b.length - head && a.at(-1 - tail) === b.at(-1 - tail)) tail++;
  const middle = changes(a.slice(head, a.length - tail), b.slice(head, b.length - tail));
  if (!middle) return null;
  const kinds = [...Array(head).fill("same"), ...middle, ...Array(tail).fill("same")];
  let i = 0, j = 0;
  return kinds.map((kind) => {
    if (kind !== "new") i++;
    if (kind !== "gone") j++;
    return { kind, text: kind === "new" ? b[j - 1] : a[i - 1], a: kind === "new" ? 0 : i, b: kind === "gone" ? 0 : j };
  });
}

function changes(a, b) {
  const most = Math.min(a.length + b.length, MOST_CHANGES), trace = [];
  let reach = new Map([[1, 0]]);
  for (let d = 0; d <= most; d++) {
    const next = new Map(reach);
    for (let k = -d; k <= d; k += 2) {
      let x = k === -d || (k !== d && reach.get(k - 1) < reach.get(k + 1)) ? reach.get(k + 1) : reach.get(k - 1) + 1;
      while (x < a.length && x - k < b.length && a[x] === b[x - k]) x++;
      next.set(k, x);
      if (x >= a.length && x - k >= b.length) return wayBack([...trace, reach], a.length, b.length);
    }
    trace.push(reach);
    reach = next;
  }
  return null;
}

function wayBack(trace, x, y) {
  const kinds = [];
  for (let d = trace.length - 1; d >= 0; d--) {
    const reach = trace[d], k = x - y;
    const before = k === -d || (k !== d && reach.get(k - 1) < reach.get(k + 1)) ? k + 1 : k - 1;
    const fromX = d ? reach.get(before) : 0, fromY = d ? fromX - before : 0;
    while (x > fromX && y > fromY) { kinds.push("same"); x--; y--; }
    if (!d) break;
    if (x > fromX) { kinds.push("gone"); x--; } else { kinds.push("new"); y--; }
    while (x > fromX && y > fromY) { kinds.push("same"); x--; y--; }
  }
  return kinds.reverse();
}
