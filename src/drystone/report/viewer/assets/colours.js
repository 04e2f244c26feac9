// Colours that colour-blind readers tell apart: viridis for sizes, Okabe and Ito's for kinds.

import { OPEN, PARTLY_OPEN, SLIDING, STICKING } from "./data.js";

const VIRIDIS = [
  "#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58",
  "#b5de2b", "#fde725",
].map(rgb);

export const OKABE_ITO = [
  "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7",
].map(rgb);

export const RESTING = rgb("#e9e5dc");
export const SUPPORT = rgb("#b8b8b8");
export const PALE = rgb("#f4f2ee");
export const SELECTED = rgb("#cc79a7");
export const INK = rgb("#1a1a1a");

export const STATE_COLOURS = [];
STATE_COLOURS[OPEN] = rgb("#d55e00");
STATE_COLOURS[STICKING] = rgb("#6b6b6b");
STATE_COLOURS[SLIDING] = rgb("#0072b2");
STATE_COLOURS[PARTLY_OPEN] = rgb("#e69f00");
export const STATE_NAMES = [];
STATE_NAMES[OPEN] = "open";
STATE_NAMES[STICKING] = "sticking";
STATE_NAMES[SLIDING] = "sliding";
STATE_NAMES[PARTLY_OPEN] = "partly open";

export const TIE_COLOURS = [rgb("#84bdb9"), rgb("#1b7f79"), rgb("#e07b00"), rgb("#8a8a8a")];
export const TIE_NAMES = ["slack", "elastic", "yielding", "broken"];
export const DEAD_LOAD = rgb("#7a4b9a");

export const FORCE = rgb("#0b3c6f");
export const THRUST = rgb("#8a1c5a");

/** [r, g, b] from 0 to 1 of "#rrggbb". */
export function rgb(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

export function css(colour) {
  return `rgb(${colour.map((part) => Math.round(255 * part)).join(",")})`;
}

/** Without its darkest part, and paler, so that edges are seen on it. */
const [DARKEST, PALER] = [0.22, 0.15];

/** Viridis at a share from 0 to 1, into `out`. */
export function viridis(share, out = [0, 0, 0]) {
  const within = DARKEST + (1 - DARKEST) * Math.min(Math.max(share || 0, 0), 1);
  const at = within * (VIRIDIS.length - 1);
  const i = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const rest = at - i;
  for (let k = 0; k < 3; k++) {
    const pure = (1 - rest) * VIRIDIS[i][k] + rest * VIRIDIS[i + 1][k];
    out[k] = PALER + (1 - PALER) * pure;
  }
  return out;
}

/** Colour of a macro-block by its number; -1 is at rest. */
export function ofLabel(label) {
  return label < 0 ? RESTING : OKABE_ITO[label % OKABE_ITO.length];
}

/** A CSS gradient of viridis from left to right. */
export function gradient() {
  const stops = VIRIDIS.map((colour, i) => css(viridis(i / (VIRIDIS.length - 1))));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
