// WebGL2 as the renderers use it: programs with their uniforms by name, and textures that are tables.

export const ROW_BITS = 11;
/** Texels a row of all tables. */
export const ROW = 1 << ROW_BITS;

const made = new WeakMap(); // by context
function make(gl, kind) {
  const object = gl[`create${kind}`]();
  if (!made.has(gl)) made.set(gl, []);
  made.get(gl).push([kind, object]);
  return object;
}
/** Gives back what was made in a context: a browser would keep it on its GPU for long. */
export function release(gl) {
  for (const [kind, object] of made.get(gl) ?? []) gl[`delete${kind}`](object);
  made.delete(gl);
}
export const makeFramebuffer = (gl) => make(gl, "Framebuffer");

/** Throws an Error with what the compiler says. */
export function makeProgram(gl, vertices, fragments) {
  const program = make(gl, "Program");
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertices], [gl.FRAGMENT_SHADER, fragments]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(`its shader: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(program, shader);
    gl.deleteShader(shader); // with the program
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(`its shaders: ${gl.getProgramInfoLog(program)}`);
  const places = {};
  for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++n) {
    const { name, type } = gl.getActiveUniform(program, n);
    places[name] = [gl.getUniformLocation(program, name), type];
  }
  return { program, places };
}

/** Sets what the program, which is in use, has of these. */
export function setUniforms(gl, { places }, values) {
  const setters = { [gl.FLOAT]: "uniform1f", [gl.FLOAT_VEC2]: "uniform2fv", [gl.FLOAT_VEC3]: "uniform3fv", [gl.FLOAT_VEC4]: "uniform4fv", [gl.UNSIGNED_INT]: "uniform1ui", [gl.UNSIGNED_INT_VEC2]: "uniform2uiv" };
  for (const [name, value] of Object.entries(values))
    if (places[name]) gl[setters[places[name][1]] ?? "uniform1i"](places[name][0], value);
}

export function makeTexture(gl, filter = gl.NEAREST, kind = gl.TEXTURE_2D) {
  const texture = make(gl, "Texture");
  gl.bindTexture(kind, texture);
  for (const name of ["MIN_FILTER", "MAG_FILTER"]) gl.texParameteri(kind, gl[`TEXTURE_${name}`], filter);
  for (const name of ["WRAP_S", "WRAP_T"]) gl.texParameteri(kind, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE);
  return texture;
}

/** Numbers of 8, 16 or 32 bits, `each` of them a texel. */
export function fillTable(gl, texture, values, each) {
  const bits = 8 * values.BYTES_PER_ELEMENT;
  const kind = gl[`${each === 4 ? "RGBA" : "R"}${bits}UI`];
  const format = each === 4 ? gl.RGBA_INTEGER : gl.RED_INTEGER;
  const type = { 8: gl.UNSIGNED_BYTE, 16: gl.UNSIGNED_SHORT, 32: gl.UNSIGNED_INT }[bits];
  const rows = Math.max(1, Math.ceil(values.length / each / ROW));
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, kind, ROW, rows, 0, format, type, null);
  const whole = Math.floor(values.length / each / ROW);
  if (whole > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, whole, format, type, values.subarray(0, whole * ROW * each));
  const rest = values.length / each - whole * ROW;
  if (rest > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, whole, rest, 1, format, type, values.subarray(whole * ROW * each));
}

export function makeTable(gl, values, each) {
  const texture = makeTexture(gl);
  fillTable(gl, texture, values, each);
  return texture;
}

/** A buffer of them, which is bound. */
export function makeIndices(gl, values) {
  const buffer = make(gl, "Buffer");
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, values, gl.STATIC_DRAW);
  return buffer;
}
