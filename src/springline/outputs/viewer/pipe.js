// One pipe as meshes of three levels: few patches far away, more near the camera, and near the cursor a fine mesh whose
// colours come from a texture with every cell. World axes are the pipe's: x along, y up, z right; unseen wall is a hole.

const TILE = 128;
const FINE_TILES = 8;
const NEAR_TILES = 24;
const LEVELS = { far: [32, 10], near: [8, 6], fine: [2, 3] };

class PipeMesh {
  constructor(scene, survey, layer, sideways = 0) {
    this.scene = scene;
    this.survey = survey;
    this.layer = layer;
    this.mode = layer === "other" ? "other" : "shape";
    this.exaggeration = 1;
    this.sideways = sideways;
    this.meshes = new Set();
    this.style = { wireframe: false, clippingPlanes: null };
    this.rebuild();
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
    for (const tile of this.tiles || []) this.drop(tile, "far", "near", "fine");
    this.tiles = this.spans();
    for (const tile of this.tiles) {
      tile.middle = (this.survey.start[tile.first] + this.survey.end[tile.last - 1]) / 2 - this.survey.low;
      this.make(tile, "far");
    }
  }

  make(tile, level) {
    const [along, around] = LEVELS[level];
    const fine = level === "fine";
    const geometry = this.geometry(tile, along, around, fine);
    const colours = fine ? { map: this.texture(tile), alphaTest: 0.5 } : { vertexColors: true };
    const material = new THREE.MeshLambertMaterial({ ...colours, side: THREE.DoubleSide });
    const mesh = new THREE.Mesh(geometry, Object.assign(material, this.style));
    mesh.position.set(this.survey.start[tile.first] - this.survey.low, 0, this.sideways);
    tile[level] = mesh;
    this.meshes.add(mesh);
    this.scene.add(mesh);
  }

  drop(tile, ...levels) {
    for (const level of levels) {
      if (!tile[level]) continue;
      this.scene.remove(tile[level]);
      this.meshes.delete(tile[level]);
      tile[level].geometry.dispose();
      if (tile[level].material.map) tile[level].material.map.dispose();
      tile[level].material.dispose();
      tile[level] = null;
    }
  }

  // Finer meshes stand near the cursor and the camera; those left behind are dropped.
  update(cursor, eye, reach) {
    const nearest = (x) => [...this.tiles].sort((a, b) => Math.abs(a.middle - x) - Math.abs(b.middle - x));
    const fine = new Set(reach < 60 * this.survey.circle ? nearest(cursor).slice(0, FINE_TILES) : []);
    const close = (tile) => reach < 60 * this.survey.circle || Math.abs(tile.middle - eye) < 60 * this.survey.circle;
    const near = new Set(nearest(eye).slice(0, NEAR_TILES).filter(close));
    for (const tile of this.tiles) {
      const level = fine.has(tile) ? "fine" : near.has(tile) ? "near" : "far";
      if (!tile[level]) this.make(tile, level);
      if (level !== "fine" && !fine.has(tile)) this.drop(tile, "fine");
      if (level === "far") this.drop(tile, "near");
      for (const name of Object.keys(LEVELS)) if (tile[name]) tile[name].visible = name === level;
    }
  }

  setStyle(style) {
    Object.assign(this.style, style);
    for (const mesh of this.meshes) {
      Object.assign(mesh.material, this.style);
      mesh.material.needsUpdate = true;
    }
  }

  texture(tile) {
    const { rows, palette, levels } = this.survey;
    const colours = cellColours(this.survey, this.mode);
    const width = tile.last - tile.first;
    const data = new Uint8Array(4 * width * rows);
    const pale = palette[(levels - 1) / 2];
    for (let g = 0; g < width; g += 1) {
      for (let k = 0; k < rows; k += 1) {
        const colour = colours[(tile.first + g) * rows + k];
        const seen = weightOf(this.survey, colour) > 0;
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
        const r = wallRadius(survey, this.layer, group, k, this.exaggeration);
        const v = i * (around + 1) + j;
        position.set([x, r * survey.sines[k % rows], r * survey.cosines[k % rows]], 3 * v);
        uv.set([n / count, (k + 0.5) / rows], 2 * v);
      }
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    const index = [];
    const colour = textured ? null : this.patchColours(tile, along, around);
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
  patchColours(tile, along, around) {
    const { rows, levels, palette } = this.survey;
    const cells = cellColours(this.survey, this.mode);
    const half = (levels - 1) / 2;
    const rgb = new Float32Array(3 * along.length * (around + 1));
    const seen = new Uint8Array(along.length * around);
    const colour = new THREE.Color();
    for (let i = 0; i < along.length; i += 1) {
      const from = tile.first + Math.min(along[i], along[along.length - 1] - 1);
      const to = i + 1 < along.length ? tile.first + along[i + 1] : from + 1;
      for (let j = 0; j <= around; j += 1) {
        let found = half;
        let best = 0;
        for (let k = Math.round((j * rows) / around); k < Math.round(((j + 1) * rows) / around); k += 1) {
          for (let g = from; g < to; g += 1) {
            const cell = cells[g * rows + (k % rows)];
            const weight = weightOf(this.survey, cell);
            if (weight > best) [best, found] = [weight, cell];
          }
        }
        if (j < around) seen[i * around + j] = best > 0 ? 1 : 0;
        colour.setRGB(...palette[found].map((v) => v / 255), THREE.SRGBColorSpace);
        rgb.set([colour.r, colour.g, colour.b], 3 * (i * (around + 1) + j));
      }
    }
    return { rgb, seen };
  }

  dispose() {
    for (const tile of this.tiles) this.drop(tile, "far", "near", "fine");
  }
}
