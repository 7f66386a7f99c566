// The pipe in three dimensions: every stretch as a coarse mesh, those near the cursor as a finer one whose colours come
// from a texture with every cell. World axes are the pipe's: x along, y up, z right; what was not seen is a hole.

const TILE = 128;
const FINE_TILES = 8;

// Smoothing edges costs half the speed where no graphics processor helps.
function drawnInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const named = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = String(gl.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  const lose = gl.getExtension("WEBGL_lose_context");
  if (lose) lose.loseContext();
  return /swiftshader|llvmpipe|software/i.test(renderer);
}

class PipeScene {
  constructor(survey) {
    this.survey = survey;
    this.canvas = document.querySelector("#scene canvas");
    this.mode = "shape";
    this.exaggeration = 1;
    this.wire = this.cut = this.inside = false;
    this.cursor = survey.low;
    this.azimuth = 0.9;
    this.elevation = 0.35;
    this.distance = 5 * survey.circle;
    this.look = { yaw: 0, pitch: 0 };
    this.queued = false;
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !drawnInSoftware() });
    this.renderer.setClearColor(0xeef1f4);
    this.renderer.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.02 * survey.circle, 4000);
    this.scene.add(new THREE.AmbientLight(0xffffff, 0.62 * Math.PI));
    this.light = new THREE.DirectionalLight(0xffffff, 0.5 * Math.PI);
    this.scene.add(this.light, this.light.target);
    this.plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
    this.addRing();
    this.addPins();
    this.rebuild();
    this.listen();
  }

  addRing() {
    const points = new Float32Array(3 * 97);
    for (let n = 0; n <= 96; n += 1) {
      points[3 * n + 1] = Math.sin((n * Math.PI) / 48);
      points[3 * n + 2] = Math.cos((n * Math.PI) / 48);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    this.ring = new THREE.LineLoop(geometry, new THREE.LineBasicMaterial({ color: 0x1d2733 }));
    this.ring.scale.set(1, 0.515 * this.survey.circle, 0.515 * this.survey.circle);
    this.scene.add(this.ring);
  }

  addPins() {
    const points = [];
    for (const feature of this.survey.features) {
      if (feature.clock === null) continue;
      const bearing = Math.PI / 2 - (feature.clock * Math.PI) / 6;
      for (const r of [0.42, 0.68]) points.push(feature.chainage - this.survey.low, r * this.survey.circle * Math.sin(bearing), r * this.survey.circle * Math.cos(bearing));
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    this.pins = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x6a1b9a }));
    if (points.length) this.scene.add(this.pins);
  }

  // Stretches of at most TILE groups without a gap inside.
  spans() {
    const { survey } = this;
    const spans = [];
    let first = 0;
    for (let g = 1; g <= survey.groups; g += 1) {
      const gap = g === survey.groups || survey.start[g] > survey.end[g - 1] + 1e-9;
      if (gap || g - first === TILE) {
        spans.push({ first, last: g, next: gap ? g - 1 : g });
        first = g;
      }
    }
    return spans;
  }

  rebuild() {
    for (const tile of this.tiles || []) this.drop(tile, "coarse", "fine");
    this.tiles = this.spans();
    for (const tile of this.tiles) {
      tile.middle = (this.survey.start[tile.first] + this.survey.end[tile.last - 1]) / 2;
      tile.coarse = this.add(tile, this.geometry(tile, 8, 6, false), new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide }));
    }
    this.refine();
  }

  drop(tile, ...kinds) {
    for (const kind of kinds) {
      if (!tile[kind]) continue;
      this.scene.remove(tile[kind]);
      tile[kind].geometry.dispose();
      if (tile[kind].material.map) tile[kind].material.map.dispose();
      tile[kind].material.dispose();
      tile[kind] = null;
    }
  }

  add(tile, geometry, material) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.position.x = this.survey.start[tile.first] - this.survey.low;
    material.wireframe = this.wire;
    material.clippingPlanes = this.cut ? [this.plane] : null;
    this.scene.add(mesh);
    return mesh;
  }

  // Finer meshes stand near the cursor; those left behind are dropped.
  refine() {
    const near = [...this.tiles].sort((a, b) => Math.abs(a.middle - this.cursor) - Math.abs(b.middle - this.cursor)).slice(0, FINE_TILES);
    const wanted = new Set(near);
    for (const tile of this.tiles) {
      if (wanted.has(tile) && !tile.fine) {
        const material = new THREE.MeshLambertMaterial({ map: this.texture(tile), alphaTest: 0.5, side: THREE.DoubleSide });
        tile.fine = this.add(tile, this.geometry(tile, 2, 3, true), material);
      } else if (!wanted.has(tile)) this.drop(tile, "fine");
      tile.coarse.visible = !tile.fine;
    }
    this.request();
  }

  texture(tile) {
    const { survey } = this;
    const { rows, palette, levels } = survey;
    const colours = cellColours(survey, this.mode);
    const width = tile.last - tile.first;
    const data = new Uint8Array(4 * width * rows);
    const pale = palette[(levels - 1) / 2];
    for (let g = 0; g < width; g += 1) {
      for (let k = 0; k < rows; k += 1) {
        const colour = colours[(tile.first + g) * rows + k];
        const seen = colour < levels;
        const rgb = seen ? palette[colour] : pale;
        data.set([rgb[0], rgb[1], rgb[2], seen ? 255 : 0], 4 * (k * width + g));
      }
    }
    const texture = new THREE.DataTexture(data, width, rows);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.wrapT = THREE.RepeatWrapping;
    texture.magFilter = THREE.NearestFilter;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    texture.needsUpdate = true;
    return texture;
  }

  radius(group, k) {
    const { survey } = this;
    const value = survey.shape[group * survey.rows + (k % survey.rows)];
    let departure = value * survey.tick;
    // Behind a hole the fit carries the shape, so that its rim does not bend.
    if (value < EMPTY) departure = survey.semi_major[group] > 0 ? fittedRadius(survey, group, k) - survey.circle / 2 : 0;
    return survey.circle / 2 + this.exaggeration * departure;
  }

  geometry(tile, alongStep, aroundStep, textured) {
    const { survey } = this;
    const { rows } = survey;
    const count = tile.last - tile.first;
    const along = [];
    for (let n = 0; n < count; n += alongStep) along.push(n);
    along.push(count);
    const around = Math.max(8, Math.floor(rows / aroundStep));
    const position = new Float32Array(3 * along.length * (around + 1));
    const uv = new Float32Array(2 * along.length * (around + 1));
    const origin = survey.start[tile.first];
    along.forEach((n, i) => {
      const group = n < count ? tile.first + n : tile.next;
      const x = (n < count ? survey.start[tile.first + n] : survey.end[tile.last - 1]) - origin;
      for (let j = 0; j <= around; j += 1) {
        const k = Math.round((j * rows) / around);
        const r = this.radius(group, k);
        const v = i * (around + 1) + j;
        position.set([x, r * survey.sines[k % rows], r * survey.cosines[k % rows]], 3 * v);
        uv.set([n / count, (k + 0.5) / rows], 2 * v);
      }
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    const index = [];
    const colour = textured ? null : this.coarseColours(tile, along, around);
    for (let i = 0; i + 1 < along.length; i += 1) {
      for (let j = 0; j < around; j += 1) {
        if (colour && !colour.seen[i * around + j]) continue;
        const a = i * (around + 1) + j;
        const b = a + around + 1;
        index.push(a, b, a + 1, a + 1, b, b + 1);
      }
    }
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
    if (textured) geometry.setAttribute("uv", new THREE.BufferAttribute(uv, 2));
    else geometry.setAttribute("color", new THREE.BufferAttribute(colour.rgb, 3));
    geometry.computeVertexNormals();
    return geometry;
  }

  // Of each patch of cells the one furthest from none; a patch without any reading is a hole.
  coarseColours(tile, along, around) {
    const { survey } = this;
    const { rows, levels, palette } = survey;
    const cells = cellColours(survey, this.mode);
    const half = (levels - 1) / 2;
    const rgb = new Float32Array(3 * along.length * (around + 1));
    const seen = new Uint8Array(along.length * around);
    const colour = new THREE.Color();
    for (let i = 0; i < along.length; i += 1) {
      const from = tile.first + Math.min(along[i], along[along.length - 1] - 1);
      const to = i + 1 < along.length ? tile.first + along[i + 1] : from + 1;
      for (let j = 0; j <= around; j += 1) {
        let found = half;
        let any = false;
        for (let k = Math.round((j * rows) / around); k < Math.round(((j + 1) * rows) / around); k += 1) {
          for (let g = from; g < to; g += 1) {
            const cell = cells[g * rows + (k % rows)];
            if (cell >= levels) continue;
            any = true;
            if (Math.abs(cell - half) > Math.abs(found - half)) found = cell;
          }
        }
        if (j < around) seen[i * around + j] = any ? 1 : 0;
        colour.setRGB(...palette[found].map((v) => v / 255), THREE.SRGBColorSpace);
        rgb.set([colour.r, colour.g, colour.b], 3 * (i * (around + 1) + j));
      }
    }
    return { rgb, seen };
  }

  listen() {
    let from = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, y: event.clientY };
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      this.turn((event.clientX - from.x) / 200, (event.clientY - from.y) / 200);
      from = { x: event.clientX, y: event.clientY };
    });
    this.canvas.addEventListener("pointerup", () => {
      from = null;
    });
  }

  turn(right, down) {
    if (this.inside) {
      this.look.yaw = Math.max(-3, Math.min(3, this.look.yaw - right));
      this.look.pitch = Math.max(-1.4, Math.min(1.4, this.look.pitch + down));
    } else {
      this.azimuth += right;
      this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + down));
    }
    this.request();
  }

  zoom(factor) {
    const whole = this.survey.high - this.survey.low + 4 * this.survey.circle;
    this.distance = Math.max(0.7 * this.survey.circle, Math.min(1.5 * whole, this.distance * factor));
    this.request();
  }

  setCursor(chainage) {
    this.cursor = chainage;
    this.canvas.dataset.chainage = chainage.toFixed(4);
    this.refine();
  }

  setMode(mode) {
    this.mode = mode;
    this.rebuild();
  }

  setExaggeration(factor) {
    this.exaggeration = factor;
    this.rebuild();
  }

  toggle(name) {
    this[name] = !this[name];
    for (const tile of this.tiles) {
      for (const mesh of [tile.coarse, tile.fine]) {
        if (!mesh) continue;
        mesh.material.wireframe = this.wire;
        mesh.material.clippingPlanes = this.cut ? [this.plane] : null;
        mesh.material.needsUpdate = true;
      }
    }
    this.request();
    return this[name];
  }

  place() {
    const x = this.cursor - this.survey.low;
    const { camera, survey } = this;
    this.ring.position.x = x;
    if (this.inside) {
      camera.position.set(x - 0.9 * survey.circle, 0, 0);
      const { yaw, pitch } = this.look;
      camera.lookAt(camera.position.x + Math.cos(pitch) * Math.cos(yaw), Math.sin(pitch), -Math.cos(pitch) * Math.sin(yaw));
    } else {
      const flat = this.distance * Math.cos(this.elevation);
      camera.position.set(x - flat * Math.cos(this.azimuth), this.distance * Math.sin(this.elevation), flat * Math.sin(this.azimuth));
      camera.lookAt(x, 0, 0);
    }
    this.light.position.copy(camera.position);
    this.light.target.position.set(x + (this.inside ? survey.circle : 0), this.inside ? -0.3 * survey.circle : 0, 0);
    // The half of the wall on the camera's side goes.
    this.plane.normal.set(0, -Math.sin(this.elevation), -Math.cos(this.elevation) * Math.sin(this.azimuth)).normalize();
    this.plane.constant = 0;
    if (this.inside) this.plane.normal.set(0, -1, 0);
  }

  request() {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.render();
    });
  }

  render() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.place();
    this.renderer.render(this.scene, this.camera);
  }

  save(name) {
    this.render();
    this.canvas.toBlob((blob) => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    });
  }
}
