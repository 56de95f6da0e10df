// Numbers as people read them: lengths in mm or inch, times, speeds.
export const MM_PER_INCH = 25.4;

export function units(inch) {
  const factor = inch ? 1 / MM_PER_INCH : 1, places = inch ? 4 : 3, name = inch ? "in" : "mm";
  return {
    factor, name,
    number: (mm) => (mm * factor).toFixed(places),
    length: (mm) => `${(mm * factor).toFixed(places)} ${name}`,
    feed: (mm_min) => `${(mm_min * factor).toFixed(inch ? 1 : 0)} ${name}/min`,
    rate: (mm3_s) => `${(mm3_s * 60 * (inch ? MM_PER_INCH ** -3 : 1e-3)).toPrecision(3)} ${inch ? "in³" : "cm³"}/min`,
    size: (mm) => `${Number((mm * factor).toPrecision(4))} ${name}`,
  };
}

export function clockText(seconds) {
  const minutes = Math.floor(seconds / 60), hours = Math.floor(minutes / 60);
  const rest = (seconds - 60 * minutes).toFixed(3).padStart(6, "0");
  return hours ? `${hours}:${String(minutes % 60).padStart(2, "0")}:${rest}` : `${minutes}:${rest}`;
}

// How many values of a sorted array are not above one.
export function after(sorted, value) {
  let low = 0, high = sorted.length;
  while (low < high) { const middle = (low + high) >> 1; if (sorted[middle] <= value) low = middle + 1; else high = middle; }
  return low;
}

// The next round number from 1, 2, 5 times a power of ten.
export function round125(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find((step) => step * power >= value * 0.999) * power;
}
