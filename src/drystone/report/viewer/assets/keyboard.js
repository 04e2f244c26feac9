// Keys and what they do: a table, so that the help lists what works.

export const KEYS = [
  { keys: ["ArrowRight", "ArrowLeft"], shown: "← →", does: "next, previous point (shift: ten)" },
  { keys: ["Home", "End"], shown: "Home End", does: "first, last point" },
  { keys: [" "], shown: "Space", does: "play, pause" },
  { keys: ["p"], shown: "P", does: "peak, then the other marks" },
  { keys: ["w", "a", "s", "d"], shown: "W A S D", does: "turn the view (plane: move it)" },
  { keys: ["+", "=", "-"], shown: "+ −", does: "zoom" },
  { keys: ["0"], shown: "0", does: "view as at first" },
  { keys: ["c"], shown: "C", does: "next colouring" },
  { keys: ["j", "f", "t"], shown: "J F T", does: "joints, forces, thrust" },
  { keys: ["Escape"], shown: "Esc", does: "nothing selected" },
  { keys: ["?"], shown: "?", does: "this help" },
];

/** Which action a key means: { name, value }, or null. */
export function action(key, shift = false) {
  const many = shift ? 10 : 1;
  const table = {
    ArrowRight: { name: "step", value: many },
    ArrowLeft: { name: "step", value: -many },
    Home: { name: "go", value: 0 },
    End: { name: "go", value: Infinity },
    " ": { name: "play" },
    p: { name: "mark" },
    w: { name: "orbit", value: [0, 15] },
    s: { name: "orbit", value: [0, -15] },
    a: { name: "orbit", value: [15, 0] },
    d: { name: "orbit", value: [-15, 0] },
    "+": { name: "zoom", value: 1.2 },
    "=": { name: "zoom", value: 1.2 },
    "-": { name: "zoom", value: 1 / 1.2 },
    0: { name: "home" },
    c: { name: "colour" },
    j: { name: "toggle", value: "joints" },
    f: { name: "toggle", value: "forces" },
    t: { name: "toggle", value: "thrust" },
    Escape: { name: "clear" },
    "?": { name: "help" },
  };
  return table[key.length === 1 ? key.toLowerCase() : key] || null;
}

/** Whether a key belongs to the element that has the focus: a text, a list, a slider, a button. */
export function takesKey(element, key) {
  if (!element || !element.tagName) return false;
  const name = element.tagName.toLowerCase();
  if (name === "select" || name === "textarea") return true;
  if (name === "input") {
    if (element.type === "checkbox") return key === " ";
    if (element.type === "range") return key !== " " && key.length > 1;
    return true;
  }
  return (name === "button" || name === "summary") && (key === " " || key === "Enter");
}
