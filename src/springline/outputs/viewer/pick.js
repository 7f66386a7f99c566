// From a point of the picture to a place on the wall, and what lies between two such places.

// Where the line of sight first meets wall that is drawn: { chainage, bearing, radius, drawn }, or null.
function pickWall(scene, right, up) {
  const { survey, camera } = scene;
  camera.updateMatrixWorld();
  const eye = camera.position;
  const far = new THREE.Vector3(right, up, 0.5).unproject(camera);
  const ray = [far.x - eye.x, far.y - eye.y, far.z - eye.z];
  const square = ray[1] ** 2 + ray[2] ** 2;
  const along = eye.y * ray[1] + eye.z * ray[2];
  const exaggeration = scene.pipes[0].exaggeration;
  for (const side of [-1, 1]) {
    let radius = survey.circle / 2;
    let found = null;
    for (let n = 0; n < 6; n += 1) {
      const root = along ** 2 - square * (eye.y ** 2 + eye.z ** 2 - radius ** 2);
      const way = root < 0 || square === 0 ? NaN : (-along + side * Math.sqrt(root)) / square;
      if (!(way > 1e-9)) {
        found = null;
        break;
      }
      const [x, y, z] = [eye.x + way * ray[0], eye.y + way * ray[1], eye.z + way * ray[2]];
      found = { chainage: x + survey.low, bearing: Math.atan2(z === 0 && y === 0 ? 1 : y, z), x, y, z };
      radius = wallRadius(survey, "shape", groupAt(survey, found.chainage), rowAt(survey, found.bearing), exaggeration);
    }
    if (!found || found.chainage < survey.low || found.chainage > survey.high) continue;
    const cutAway = scene.cut && scene.plane.normal.y * found.y + scene.plane.normal.z * found.z < 0;
    if (!cutAway && isSeen(survey, groupAt(survey, found.chainage), rowAt(survey, found.bearing))) {
      return wallPoint(survey, found.chainage, found.bearing, exaggeration);
    }
  }
  return null;
}

// A place on the wall with its true radius, and the one at which it is drawn.
function wallPoint(survey, chainage, bearing, exaggeration) {
  const at = ["shape", groupAt(survey, chainage), rowAt(survey, bearing)];
  return { chainage, bearing, radius: wallRadius(survey, ...at, 1), drawn: wallRadius(survey, ...at, exaggeration) };
}

// Straight distance, its part along the pipe, and the arc between two places, by true radii [m].
function measureBetween(a, b) {
  const along = b.chainage - a.chainage;
  const y = b.radius * Math.sin(b.bearing) - a.radius * Math.sin(a.bearing);
  const z = b.radius * Math.cos(b.bearing) - a.radius * Math.cos(a.bearing);
  const turn = Math.abs(Math.atan2(Math.sin(b.bearing - a.bearing), Math.cos(b.bearing - a.bearing)));
  return { straight: Math.hypot(along, y, z), along: Math.abs(along), turn, arc: (turn * (a.radius + b.radius)) / 2 };
}
