// Numbers for people.

/** A length [m] in millimetres or metres, four digits. */
export function length(value) {
  if (!Number.isFinite(value)) return "–";
  const mm = 1e3 * value;
  return Math.abs(value) < 0.1 ? `${digits(mm, 4)} mm` : `${digits(value, 4)} m`;
}

/** A force [N]. */
export function force(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e6) return `${digits(value / 1e6, 4)} MN`;
  return size >= 1e3 ? `${digits(value / 1e3, 4)} kN` : `${digits(value, 4)} N`;
}

export function degrees(radians) {
  return `${digits((180 / Math.PI) * radians, 3)}°`;
}

export function multiplier(value) {
  return Number.isFinite(value) ? value.toFixed(4) : "–";
}

/** A value on the curve's abscissa: a length, or an angle in degrees where supports turn. */
export function motion(axes, value) {
  return axes && axes.motion_unit === "°" ? `${digits(value, 4)}°` : length(value);
}

/** A value on its ordinate: a multiplier, or the reaction of supports that move. */
export function ordinate(axes, value) {
  if (!axes || !axes.force_unit) return multiplier(value);
  return axes.force_unit === "N m" ? `${force(value)} m` : force(value);
}

/** A number with at most so many significant digits, without zeros at the end. */
export function digits(value, most) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) return value.toExponential(Math.min(most, 3) - 1);
  return String(Number(value.toPrecision(most)));
}
