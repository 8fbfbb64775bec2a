"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const find = (id) => document.getElementById(id);
  const canvas = find("view"), root = document.documentElement;
  const calm = matchMedia("(prefers-reduced-motion: reduce)"), dark = matchMedia("(prefers-color-scheme: dark)");
  const DEGREES = ["0-form", "1-form", "2-form"];

  // ---- numbers -----------------------------------------------------------------------------------------------------
  const bytes = (text) => {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const binary = atob(text), out = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++) out[i] = binary.charCodeAt(i);
    return out;
  };
  const words = (text) => new Uint16Array(bytes(text).buffer);
  const signed = (text) => new Int16Array(bytes(text).buffer);
  const grouped = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");
  const count = (n, one, many) => `${grouped(n)} ${n === 1 ? one : many}`;
  const short = (x) => {
    const size = Math.abs(x);
    const text = size === 0 ? "0" : size >= 1e4 || size < 1e-3 ? x.toExponential(2) : String(Number(x.toPrecision(3)));
    return text.replace("-", "−");
  };

  // ---- the scene ---------------------------------------------------------------------------------------------------
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  } catch (error) {
    const trouble = document.createElement("p");
    trouble.id = "trouble";
    trouble.setAttribute("role", "alert");
    trouble.textContent = "This page draws with WebGL 2, which this browser does not offer.";
    document.body.append(trouble);
    return;
  }
  renderer.setClearColor(0x000000, 0);
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(26, 1, data.size * 0.01, data.size * 100);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableDamping = !calm.matches;
  controls.minDistance = data.size * 0.05;
  controls.maxDistance = data.size * 20;

  const low = new THREE.Vector3(...data.bounds[0]);
  const extent = new THREE.Vector3(...data.bounds[1]).sub(low);
  const shared = { low: { value: low }, extent: { value: extent }, size: { value: data.size }, pixel: { value: 0 } };
  const over = { value: false };
  const colourOf = (rgb) => new THREE.Vector3(...rgb);
  const rampOf = (form) => {
    const texels = new Uint8Array(256 * 4);
    for (let i = 0; i < 256; i++) {
      const place = (i / 255) * (form.ramp.length - 1), k = Math.min(Math.floor(place), form.ramp.length - 2);
      for (let c = 0; c < 3; c++) {
        texels[4 * i + c] = Math.round(255 * (form.ramp[k][c] + (form.ramp[k + 1][c] - form.ramp[k][c]) * (place - k)));
      }
      texels[4 * i + 3] = 255;
    }
    const texture = new THREE.DataTexture(texels, 256, 1, THREE.RGBAFormat);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
  };
  // The scale as parts of the range in which values are stored.
  const scaleOf = (form) => {
    const [from, to] = form.range, width = to > from ? to - from : 1;
    return new THREE.Vector2((form.scale[0] - from) / width, (form.scale[1] - from) / width);
  };
  const ramps = data.forms.map((form) => form && { ramp: { value: rampOf(form) }, scale: { value: scaleOf(form) } });
  const material = (shader, uniforms, options) =>
    new THREE.ShaderMaterial({ ...shader, uniforms: { ...shared, ...uniforms }, side: THREE.DoubleSide, ...options });
  const ink = { transparent: true, depthWrite: false };
  const add = (mesh, order) => {
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    scene.add(mesh);
    return mesh;
  };

  // The surface, level by level; what is not looked at is not unpacked.
  const lit = data.colours.lights.map((light) => colourOf(light).normalize());
  const surfaceUniforms = {
    coloured: { value: false }, bands: { value: 0 }, ramp: { value: null }, scale: { value: new THREE.Vector2(0, 1) },
    plain: { value: colourOf(data.colours.surface) }, key: { value: lit[0] }, fill: { value: lit[1] },
    brightness: { value: colourOf(data.colours.brightness) },
  };
  const surfaceMaterial = material(SHADERS.surface, surfaceUniforms);
  const meshMaterial = material(SHADERS.mesh, {}, ink);
  const unpacked = new Map();
  const level = (number) => {
    if (unpacked.has(number)) return unpacked.get(number);
    const packed = data.levels[number];
    const indices = packed.wide ? new Uint32Array(bytes(packed.indices).buffer) : words(packed.indices);
    const sizes = packed.size ? null : words(packed.sizes);
    const sizeOf = (face) => (sizes ? sizes[face] : packed.size);
    const triangles = new indices.constructor(3 * (indices.length - 2 * packed.faces));
    for (let face = 0, from = 0, to = 0; face < packed.faces; from += sizeOf(face), face++) {
      for (let i = 1; i + 1 < sizeOf(face); i++) {
        triangles[to++] = indices[from];
        triangles[to++] = indices[from + i];
        triangles[to++] = indices[from + i + 1];
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(words(packed.positions), 3, true));
    geometry.setAttribute("normal", new THREE.BufferAttribute(signed(packed.normals), 3, true));
    const values = packed.values.map((text) => text && new THREE.BufferAttribute(words(text), 1, true));
    const none = () => new THREE.BufferAttribute(new Uint8Array(packed.vertices), 1, true);
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    geometry.setAttribute("value", values.find((value) => value) || none());
    const surface = add(new THREE.Mesh(geometry, surfaceMaterial), 0);
    let edges = null;
    const mesh = () => {
      if (edges) return edges;
      const lines = new indices.constructor(2 * indices.length);
      for (let face = 0, from = 0; face < packed.faces; from += sizeOf(face), face++) {
        const size = sizeOf(face);
        for (let i = 0; i < size; i++) {
          lines[2 * (from + i)] = indices[from + i];
          lines[2 * (from + i) + 1] = indices[from + ((i + 1) % size)];
        }
      }
      const outline = new THREE.BufferGeometry();
      outline.setAttribute("position", geometry.getAttribute("position"));
      outline.setIndex(new THREE.BufferAttribute(lines, 1));
      edges = add(new THREE.LineSegments(outline, meshMaterial), 1);
      return edges;
    };
    const entry = { packed, geometry, values, surface, mesh, hasMesh: () => edges !== null };
    unpacked.set(number, entry);
    return entry;
  };

  // Bands along lines: two vertices a point, one on either side. (Not an instance a segment: software drivers draw
  // instances one by one.) A point is `stride` numbers, its place first; `ends` says where lines end.
  const bands = (points, stride, ends) => {
    const count = points.length / stride, place = new Uint16Array(6 * count), along = new Int16Array(6 * count);
    const side = new Int8Array(2 * count), index = new Uint32Array(6 * count);
    const box = extent.toArray();
    let used = 0;
    for (let i = 0; i < count; i++) {
      const next = ends(i) ? i : i + 1, last = i === 0 || ends(i - 1) ? i : i - 1;
      const way = box.map((length, k) => length * (points[stride * next + k] - points[stride * last + k]));
      const long = Math.hypot(...way) || 1;
      for (let k = 0; k < 3; k++) {
        place[6 * i + k] = place[6 * i + 3 + k] = points[stride * i + k];
        along[6 * i + k] = along[6 * i + 3 + k] = Math.round((32767 * way[k]) / long);
      }
      [side[2 * i], side[2 * i + 1]] = [-127, 127];
      if (next !== i) {
        index.set([2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2], used);
        used += 6;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3, true));
    geometry.setAttribute("along", new THREE.BufferAttribute(along, 3, true));
    geometry.setAttribute("side", new THREE.BufferAttribute(side, 1, true));
    geometry.setIndex(new THREE.BufferAttribute(index.subarray(0, used), 1));
    return geometry;
  };
  // Lines of one segment each, with their opacities.
  const lines = (points, strengths, uniforms, order) => {
    const geometry = bands(points, 3, (i) => i % 2 === 1);
    const each = new Uint8Array((points.length / 3) * 2);
    for (let i = 0; i < each.length; i++) each[i] = strengths[i >> 2];
    geometry.setAttribute("strength", new THREE.BufferAttribute(each, 1, true));
    return add(new THREE.Mesh(geometry, material(SHADERS.line, uniforms, ink)), order);
  };
  const square = (geometry) => {
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    return geometry;
  };
  const layers = {};
  const cage = words(data.cage);
  if (cage.length) {
    layers.cage = lines(cage, new Uint8Array(cage.length / 6).fill(255), {
      ink: { value: colourOf(data.colours.cage) }, alpha: { value: 0.5 }, width: { value: 0.0012 }, bias: { value: 0.004 },
    }, 4);
  }
  const creases = words(data.creases.points);
  if (creases.length) {
    const strengths = bytes(data.creases.sharpness).map((sharpness) => (sharpness < 255 ? 115 : 255));
    layers.creases = lines(creases, strengths, {
      ink: { value: colourOf(data.colours.crease) }, alpha: { value: 1 }, width: { value: 0.0035 }, bias: { value: 0.005 },
    }, 3);
  }
  const flow = { clock: { value: 0 }, period: { value: 0.22 }, still: { value: calm.matches } };
  const points = words(data.strokes.points);
  if (points.length && ramps[1]) {
    const total = points.length / 6, lasting = words(data.strokes.lasting), info = new Uint16Array(8 * total);
    const number = (i) => points[6 * i + 5], ends = (i) => i + 1 === total || number(i) !== number(i + 1);
    const geometry = bands(points, 6, ends);
    for (let i = 0, line = 0; i < total; i++) {
      // Phases without a pattern: parts of the golden ratio.
      const phase = Math.floor(65536 * ((line * 0.6180339887) % 1));
      const own = [points[6 * i + 3], points[6 * i + 4], phase, lasting[line]];
      info.set(own, 8 * i);
      info.set(own, 8 * i + 4);
      if (ends(i)) line++;
    }
    geometry.setAttribute("info", new THREE.BufferAttribute(info, 4, true));
    const uniforms = { ...ramps[1], ...flow, over, duration: { value: data.strokes.duration }, width: { value: 0.0045 } };
    layers.strokes = add(new THREE.Mesh(geometry, material(SHADERS.stroke, uniforms, ink)), 2);
  }
  const at = words(data.arrows.at);
  if (at.length && ramps[1]) {
    const geometry = new THREE.InstancedBufferGeometry(), shape = data.arrows.shape.flat().flatMap((p) => [...p, 0]);
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(shape), 3));
    geometry.setAttribute("at", new THREE.InstancedBufferAttribute(at, 3, true));
    const vectors = new THREE.InstancedInterleavedBuffer(signed(data.arrows.vectors), 6);
    geometry.setAttribute("along", new THREE.InterleavedBufferAttribute(vectors, 3, 0, true));
    geometry.setAttribute("up", new THREE.InterleavedBufferAttribute(vectors, 3, 3, true));
    geometry.setAttribute("value", new THREE.InstancedBufferAttribute(words(data.arrows.speeds), 1, true));
    geometry.instanceCount = at.length / 3;
    const uniforms = { ...ramps[1], over, lengths: { value: new THREE.Vector2(...data.arrows.lengths) } };
    layers.arrows = add(new THREE.Mesh(geometry, material(SHADERS.arrow, uniforms, ink)), 5);
  }
  if (data.zeros.length) {
    const geometry = square(new THREE.InstancedBufferGeometry());
    const fills = data.zeros.flatMap((zero) => data.colours.zeros[zero.index > 0 ? 0 : 1]);
    geometry.setAttribute("at", new THREE.InstancedBufferAttribute(new Float32Array(data.zeros.flatMap((zero) => zero.at)), 3));
    geometry.setAttribute("fill", new THREE.InstancedBufferAttribute(new Float32Array(fills), 3));
    geometry.instanceCount = data.zeros.length;
    layers.zeros = add(new THREE.Mesh(geometry, material(SHADERS.zero, {}, ink)), 6);
  }

  // ---- what is shown -----------------------------------------------------------------------------------------------
  const state = { degree: data.degree, level: data.levels.length - 1, layers: { ...data.layers }, paused: calm.matches };
  let wanted = true; // a frame is
  const redraw = () => { wanted = true; };
  const say = (text) => { find("status").textContent = text; };

  // The surface at a level, in the colours of the degree.
  let revealed = 0;
  const reveal = (number) => {
    const current = level(number);
    if (surfaceUniforms.coloured.value) current.geometry.setAttribute("value", current.values[state.degree]);
    unpacked.forEach((entry, other) => { entry.surface.visible = other === number; });
    revealed = number;
  };
  const show = () => {
    const { degree } = state, form = degree === null ? null : data.forms[degree], current = level(state.level);
    unpacked.forEach((entry, number) => {
      if (state.layers.mesh && number === state.level) entry.mesh();
      if (entry.hasMesh()) entry.mesh().visible = state.layers.mesh && number === state.level;
    });
    surfaceUniforms.coloured.value = degree === 0 || degree === 2;
    reveal(state.level);
    if (surfaceUniforms.coloured.value) {
      surfaceUniforms.bands.value = form.bands;
      surfaceUniforms.ramp.value = ramps[degree].ramp.value;
      surfaceUniforms.scale.value.copy(ramps[degree].scale.value);
    }
    over.value = degree !== 1;
    for (const [name, mesh] of Object.entries(layers)) mesh.visible = state.layers[name];
    // Without a form there is no field to look at.
    for (const name of ["strokes", "arrows", "zeros"]) if (layers[name] && degree === null) layers[name].visible = false;
    flow.still.value = state.paused;

    find("scale").hidden = !form;
    if (form) {
      find("scale-name").textContent = form.name;
      find("scale-unit").textContent = form.unit;
      const stops = form.ramp.map((rgb) => `rgb(${rgb.map((x) => Math.round(255 * x)).join(",")})`);
      find("ramp").style.background = `linear-gradient(to right, ${stops.join(",")})`;
      const [from, to] = form.scale, slack = 1e-6 * (to - from);
      find("low").textContent = (form.range[0] < from - slack ? "≤ " : "") + short(from);
      find("middle").textContent = short((from + to) / 2);
      find("high").textContent = (form.range[1] > to + slack ? "≥ " : "") + short(to);
    }
    const { packed } = current;
    find("counts").textContent =
      `${count(packed.vertices, "vertex", "vertices")}, ${count(packed.faces, "face", "faces")}`;
    find("level").value = state.level;
    find("level-says").textContent = `${state.level} of ${data.levels.length - 1}`;
    find("level").setAttribute("aria-valuetext", `level ${state.level}, ${find("counts").textContent}`);
    for (const radio of document.getElementsByName("degree")) radio.checked = radio.value === String(degree ?? "none");
    for (const box of find("layers").querySelectorAll("input")) box.checked = state.layers[box.name] && !box.disabled;
    find("pause").textContent = state.paused ? "Play" : "Pause";
    find("pause").setAttribute("aria-pressed", String(state.paused));
    redraw();
  };
  const setDegree = (degree) => {
    if (degree !== null && !data.forms[degree]) return say(`there is no ${DEGREES[degree]}`);
    state.degree = degree;
    show();
    say(degree === null ? "no form" : `${DEGREES[degree]}: ${data.forms[degree].name}`);
  };
  const setLevel = (number) => {
    state.level = Math.max(0, Math.min(data.levels.length - 1, number));
    show();
    say(find("level").getAttribute("aria-valuetext"));
  };
  const toggle = (name) => {
    const box = find("layers").querySelector(`[name=${name}]`);
    if (box.disabled) return say("there is nothing of it here");
    state.layers[name] = !state.layers[name];
    show();
    say(`${box.parentElement.textContent.trim()} ${state.layers[name] ? "on" : "off"}`);
  };
  const pause = () => {
    state.paused = !state.paused;
    show();
    say(state.paused ? "paused" : "playing");
  };
  const setTheme = (name) => {
    root.dataset.theme = name;
    redraw();
  };

  // ---- the camera --------------------------------------------------------------------------------------------------
  const narrow = () => innerWidth <= 720;
  const frame = () => {
    // The part of the window that nothing covers.
    const panel = find("panel").getBoundingClientRect(), scale = find("scale").getBoundingClientRect();
    if (narrow()) return { left: 0, top: Math.max(56, find("scale").hidden ? 0 : scale.bottom), right: innerWidth, bottom: panel.top };
    return { left: 0, top: 0, right: panel.left, bottom: innerHeight };
  };
  // Where frames take long, what moves is drawn with fewer pixels and then from a coarser level, and as it is once it
  // stands still.
  const sharpest = Math.min(devicePixelRatio || 1, 2);
  let sharpness = 1, drawn = 0, coarser = 0;
  const lighter = () => {
    let number = state.level;
    // Below some thousand vertices it would show.
    for (let i = 0; i < coarser && number > 0 && data.levels[number - 1].vertices >= 4000; i++) number--;
    return state.layers.mesh ? state.level : number;
  };
  const sharpen = (part) => {
    if (drawn === part) return;
    drawn = part;
    renderer.setPixelRatio(sharpest * part);
    renderer.setSize(innerWidth, innerHeight, false);
  };
  const resize = () => {
    drawn = 0;
    sharpen(1);
    camera.aspect = innerWidth / innerHeight;
    const free = frame();
    camera.setViewOffset(innerWidth, innerHeight, innerWidth / 2 - (free.left + free.right) / 2,
      innerHeight / 2 - (free.top + free.bottom) / 2, innerWidth, innerHeight);
    shared.pixel.value = (2 * Math.tan((camera.fov * Math.PI) / 360)) / innerHeight;
    redraw();
  };
  const home = () => {
    resize();
    const free = frame(), half = Math.tan((camera.fov * Math.PI) / 360);
    const centre = low.clone().addScaledVector(extent, 0.5);
    const towards = new THREE.Vector3(...data.view.towards).normalize();
    const right = new THREE.Vector3(0, 0, 1).cross(towards).normalize(), up = towards.clone().cross(right);
    // As near as every corner of what is seen allows: a few thousand of the vertices do.
    const positions = level(state.level).geometry.getAttribute("position"), p = new THREE.Vector3();
    const tan = [half * (free.right - free.left) / innerHeight, half * (free.bottom - free.top) / innerHeight];
    const cageToo = state.layers.cage && cage.length;
    const fit = (axis, tangent) => {
      let distance = 0;
      const look = () => {
        const along = p.sub(centre).dot(towards);
        distance = Math.max(distance, along + Math.abs(p.dot(axis)) / (0.92 * tangent));
      };
      const step = Math.max(1, Math.floor(positions.count / 5000));
      for (let i = 0; i < positions.count; i += step) {
        p.fromBufferAttribute(positions, i).multiply(extent).add(low);
        look();
      }
      for (let i = 0; cageToo && i < cage.length; i += 3) {
        p.set(cage[i], cage[i + 1], cage[i + 2]).divideScalar(65535).multiply(extent).add(low);
        look();
      }
      return distance;
    };
    controls.target.copy(centre);
    camera.position.copy(centre).addScaledVector(towards, Math.max(fit(right, tan[0]), fit(up, tan[1]), data.size * 0.2));
    controls.update();
    redraw();
  };
  const turn = (left, above) => {
    const offset = camera.position.clone().sub(controls.target), up = camera.up;
    const side = up.clone().cross(offset).normalize();
    const angle = offset.angleTo(up) - above;
    offset.applyAxisAngle(up, left);
    if (angle > 0.05 && angle < Math.PI - 0.05) offset.applyAxisAngle(side.applyAxisAngle(up, left), -above);
    camera.position.copy(controls.target).add(offset);
    controls.update();
    redraw();
  };
  const nearer = (factor) => {
    const offset = camera.position.clone().sub(controls.target);
    const distance = Math.min(Math.max(offset.length() * factor, controls.minDistance), controls.maxDistance);
    camera.position.copy(controls.target).add(offset.setLength(distance));
    controls.update();
    redraw();
  };

  // ---- frames ------------------------------------------------------------------------------------------------------
  let before = 0, first = true, busy = 0, pace = 0;
  const draw = () => {
    const distance = camera.position.distanceTo(controls.target);
    camera.near = Math.max(distance - 2 * data.size, distance * 0.02, data.size * 1e-3);
    camera.far = distance + 3 * data.size;
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
  };
  const tick = (now) => {
    requestAnimationFrame(tick);
    const since = now - before;
    before = now;
    const flowing = layers.strokes?.visible && !state.paused && !document.hidden;
    if (flowing) {
      // Five seconds for a crossing at full speed.
      flow.clock.value = (flow.clock.value + Math.min(0.1, since / 1000) / 5) % flow.period.value;
      wanted = true;
    }
    if (controls.enableDamping) {
      // Turning dies out as quickly where frames are few.
      controls.dampingFactor = 1 - Math.pow(0.93, Math.min(since, 500) / 16.7);
      controls.update();
    }
    if (!wanted) {
      if (busy > 0 && (drawn < 1 || revealed !== state.level)) {
        sharpen(1);
        reveal(state.level);
        draw();
      }
      busy = 0;
      return;
    }
    wanted = false;
    // The mean time from frame to frame, once several came in a row.
    pace = busy < 3 ? 25 : pace + (since - pace) / 4;
    busy++;
    if (pace > 45 && busy > 3) {
      if (sharpness > 0.6) sharpness *= 0.75;
      else coarser = Math.min(coarser + 1, 4);
      busy = 1;
    } else if (pace < 20 && busy > 10) {
      if (coarser > 0) coarser--;
      else sharpness = Math.min(1, sharpness / 0.75);
      busy = 1;
    }
    const light = busy > 1 || flowing || drawn < 1;
    sharpen(light ? sharpness : 1);
    const detail = light ? lighter() : state.level;
    if (detail !== revealed) reveal(detail);
    draw();
    root.dataset.frames = String(Number(root.dataset.frames ?? 0) + 1);
    if (first) {
      first = false;
      root.dataset.ready = String(Math.round(performance.now()));
    }
  };

  // A picture with its scale, as large as the window.
  const shoot = () => {
    sharpen(1);
    draw();
    const out = document.createElement("canvas"), ratio = canvas.width / innerWidth, paper = out.getContext("2d");
    [out.width, out.height] = [canvas.width, canvas.height];
    const style = getComputedStyle(root), ground = style.getPropertyValue("--ground"), text = style.getPropertyValue("--ink");
    paper.fillStyle = ground;
    paper.fillRect(0, 0, out.width, out.height);
    paper.drawImage(canvas, 0, 0);
    paper.scale(ratio, ratio);
    paper.fillStyle = text;
    const font = getComputedStyle(document.body).fontFamily;
    paper.font = `600 15px ${font}`;
    paper.fillText(data.name, 20, 32);
    const form = state.degree === null ? null : data.forms[state.degree];
    if (form) {
      const wide = Math.min(300, innerWidth - 40), y = innerHeight - 40, fade = paper.createLinearGradient(20, 0, 20 + wide, 0);
      form.ramp.forEach((rgb, i) => fade.addColorStop(i / (form.ramp.length - 1), `rgb(${rgb.map((x) => Math.round(255 * x)).join(",")})`));
      paper.font = `13px ${font}`;
      paper.fillText(`${form.name} ${form.unit}`.trim(), 20, y - 8);
      ["low", "middle", "high"].forEach((id, i) => {
        paper.textAlign = ["left", "center", "right"][i];
        paper.fillText(find(id).textContent, 20 + (wide * i) / 2, y + 26);
      });
      paper.fillStyle = fade;
      paper.fillRect(20, y, wide, 11);
    }
    out.toBlob((blob) => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = `${data.name.replace(/\.[^.]*$/, "")}.png`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      say("picture saved");
    }, "image/png");
  };

  // ---- controls ----------------------------------------------------------------------------------------------------
  const help = () => (find("help").open ? find("help").close() : find("help").showModal());
  const keys = {
    "0": () => setDegree(0), "1": () => setDegree(1), "2": () => setDegree(2), n: () => setDegree(null),
    "[": () => setLevel(state.level - 1), "]": () => setLevel(state.level + 1),
    f: () => toggle("strokes"), a: () => toggle("arrows"), z: () => toggle("zeros"), e: () => toggle("creases"),
    c: () => toggle("cage"), m: () => toggle("mesh"),
    " ": pause, r: home, s: shoot, t: () => setTheme(root.dataset.theme === "dark" ? "light" : "dark"), "?": help,
    "+": () => nearer(1 / 1.15), "=": () => nearer(1 / 1.15), "-": () => nearer(1.15),
    ArrowLeft: () => turn(-0.12, 0), ArrowRight: () => turn(0.12, 0), ArrowUp: () => turn(0, 0.12), ArrowDown: () => turn(0, -0.12),
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (find("help").open && event.key !== "?") return;
    // Controls keep the keys that they are worked with.
    const control = event.target.closest?.("input, button");
    if (control && (event.key === " " || event.key === "Enter" || event.key.startsWith("Arrow"))) return;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  find("name").textContent = data.name;
  find("level").max = data.levels.length - 1;
  find("level").disabled = data.levels.length < 2;
  find("level").addEventListener("input", (event) => setLevel(Number(event.target.value)));
  for (const radio of document.getElementsByName("degree")) {
    radio.disabled = radio.value !== "none" && !data.forms[radio.value];
    radio.addEventListener("change", () => setDegree(radio.value === "none" ? null : Number(radio.value)));
  }
  find("degrees").hidden = data.forms.every((form) => !form);
  for (const box of find("layers").querySelectorAll("input")) {
    box.disabled = box.name !== "mesh" && !layers[box.name];
    box.addEventListener("change", () => toggle(box.name));
  }
  if (data.zeros.length) {
    const plus = data.zeros.filter((zero) => zero.index > 0).length, minus = data.zeros.length - plus;
    const dot = (kind) => Object.assign(document.createElement("span"), { className: `dot ${kind}` });
    find("zeros-say").append(`${count(data.zeros.length, "zero", "zeros")}: `, dot("plus"), ` ${plus} of index 1, `,
      dot("minus"), ` ${minus} of index −1`);
    find("zeros-say").hidden = false;
  }
  find("pause").hidden = !layers.strokes;
  find("pause").addEventListener("click", pause);
  find("home").addEventListener("click", home);
  find("shoot").addEventListener("click", shoot);
  find("theme").addEventListener("click", () => keys.t());
  find("ask").addEventListener("click", help);
  find("fold").addEventListener("click", () => {
    const open = find("fold").getAttribute("aria-expanded") !== "true";
    find("fold").setAttribute("aria-expanded", String(open));
    resize();
  });
  controls.addEventListener("change", redraw);
  addEventListener("resize", resize);
  calm.addEventListener("change", () => {
    controls.enableDamping = !calm.matches;
    state.paused = calm.matches;
    show();
  });
  dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
  canvas.setAttribute("aria-label",
    `${data.name}: a surface${layers.strokes ? " with the flow of its field" : ""}. Arrow keys turn it, plus and minus zoom, question mark lists all keys.`);

  setTheme(dark.matches ? "dark" : "light");
  show();
  home();
  requestAnimationFrame(tick);
})();
