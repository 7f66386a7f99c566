// The pipe in three dimensions: camera, light, the ring at the cursor, markers of features, and what is measured.

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
  constructor(survey, onPick) {
    this.survey = survey;
    this.onPick = onPick;
    this.canvas = document.querySelector("#scene canvas");
    this.wire = this.cut = this.inside = this.beside = false;
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
    this.addMarkers();
    this.addRuler();
    this.pipes = [new PipeMesh(this.scene, survey, "shape")];
    this.listen();
  }

  lines(points, colour) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour }));
    lines.frustumCulled = false;
    this.scene.add(lines);
    return lines;
  }

  circle(x, radius) {
    const points = [];
    for (let n = 0; n < 96; n += 1) {
      for (const m of [n, n + 1]) points.push(x, radius * Math.sin((m * Math.PI) / 48), radius * Math.cos((m * Math.PI) / 48));
    }
    return points;
  }

  addRing() {
    this.ring = this.lines(this.circle(0, 0.515 * this.survey.circle), 0x1d2733);
  }

  // A pin where a feature has a place on the wall, a hoop where it goes all the way round.
  addMarkers() {
    const points = [];
    for (const feature of this.survey.features) {
      const x = feature.chainage - this.survey.low;
      if (feature.clock === null) points.push(...this.circle(x, 0.53 * this.survey.circle));
      else {
        const bearing = bearingOfClock(feature.clock);
        for (const r of [0.42, 0.68]) points.push(x, r * this.survey.circle * Math.sin(bearing), r * this.survey.circle * Math.cos(bearing));
      }
    }
    this.lines(points, 0x6a1b9a);
  }

  addRuler() {
    this.ruler = this.lines([], 0xd50057);
    this.ruler.material.depthTest = false;
    this.ruler.renderOrder = 9;
  }

  // Points as { chainage, bearing, radius }; a cross at each, and a line between two.
  setRuler(points) {
    const size = 0.025 * this.survey.circle;
    const places = points.map((p) => [p.chainage - this.survey.low, p.drawn * Math.sin(p.bearing), p.drawn * Math.cos(p.bearing)]);
    const ends = places.flatMap(([x, y, z]) => [x - size, y, z, x + size, y, z, x, y - size, z, x, y + size, z, x, y, z - size, x, y, z + size]);
    if (places.length === 2) ends.push(...places[0], ...places[1]);
    this.ruler.geometry.dispose();
    this.ruler.geometry = new THREE.BufferGeometry();
    this.ruler.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends), 3));
    this.request();
  }

  listen() {
    let from = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, y: event.clientY, moved: 0 };
      if (event.isTrusted) this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      const [right, down] = [event.clientX - from.x, event.clientY - from.y];
      from.moved += Math.abs(right) + Math.abs(down);
      if (from.moved < 4) return;
      this.turn(right / 200, down / 200);
      Object.assign(from, { x: event.clientX, y: event.clientY });
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (from && from.moved < 4) this.click(event);
      from = null;
    });
    this.canvas.addEventListener("pointercancel", () => {
      from = null;
    });
  }

  click(event) {
    const box = this.canvas.getBoundingClientRect();
    const found = pickWall(this, (2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    if (found) this.onPick(found);
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
    this.request();
  }

  setMode(mode) {
    this.pipes[0].mode = mode;
    this.pipes[0].rebuild();
    this.request();
  }

  setExaggeration(factor) {
    for (const pipe of this.pipes) {
      pipe.exaggeration = factor;
      pipe.rebuild();
    }
    this.request();
  }

  toggle(name) {
    this[name] = !this[name];
    if (name === "beside") {
      if (this.beside) this.pipes.push(new PipeMesh(this.scene, this.survey, "other", 1.35 * this.survey.circle));
      else this.pipes.pop().dispose();
      this.pipes.at(-1).exaggeration = this.pipes[0].exaggeration;
      if (this.beside) {
        this.pipes[1].rebuild();
        Object.assign(this, { azimuth: 0.3, elevation: 0.6 });
      }
    }
    for (const pipe of this.pipes) pipe.setStyle({ wireframe: this.wire, clippingPlanes: this.cut ? [this.plane] : null });
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
      const middle = this.beside ? 0.675 * survey.circle : 0;
      camera.position.set(x - flat * Math.cos(this.azimuth), this.distance * Math.sin(this.elevation), middle + flat * Math.sin(this.azimuth));
      camera.lookAt(x, 0, middle);
    }
    this.light.position.copy(camera.position);
    this.light.target.position.set(x + (this.inside ? survey.circle : 0), this.inside ? -0.3 * survey.circle : 0, 0);
    // The half of the wall on the camera's side goes; of two pipes side by side the upper half.
    const { azimuth, elevation } = this;
    if (this.inside || this.beside) this.plane.normal.set(0, -1, 0);
    else this.plane.normal.set(0, -Math.sin(elevation), -Math.cos(elevation) * Math.sin(azimuth)).normalize();
    for (const pipe of this.pipes) pipe.update(x, camera.position.x, this.inside ? 0 : this.distance);
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
    this.canvas.toBlob((blob) => saveAs(blob, name));
  }
}
