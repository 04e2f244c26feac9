// Streams of a page, back to arrays: the inverse of codec.py.

const ITEM = { f4: Float32Array, i2: Int16Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };
const BITS = { 1: Uint8Array, 2: Uint16Array, 4: Uint32Array };

/** Bytes of a base64 text that were deflated, inflated again: a promise of a Uint8Array. */
export async function inflate(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Arrays of all streams of a table: name -> { shape, values }. */
export function decode(bytes, table) {
  const streams = {};
  for (const entry of table) {
    const Kind = ITEM[entry.kind];
    const count = entry.shape.reduce((product, n) => product * n, 1);
    const start = bytes.byteOffset + entry.offset;
    const values = entry.varying
      ? summed(bytes.subarray(entry.offset), count, entry.shape[0], Kind)
      : new Kind(bytes.buffer.slice(start, start + count * Kind.BYTES_PER_ELEMENT));
    streams[entry.name] = { shape: entry.shape, values };
  }
  return streams;
}

/** Byte planes of differences along the first axis, of `rows` rows, as an array of `Kind`. */
function summed(planes, count, rows, Kind) {
  const size = Kind.BYTES_PER_ELEMENT;
  const bits = new BITS[size](count);
  for (let byte = 0; byte < size; byte++) {
    const plane = planes.subarray(byte * count, (byte + 1) * count);
    const shift = 8 * byte;
    for (let i = 0; i < count; i++) bits[i] |= plane[i] << shift;
  }
  const width = rows > 0 ? count / rows : 0;
  for (let i = width; i < count; i++) bits[i] += bits[i - width]; // wraps around, as it should
  return new Kind(bits.buffer);
}
