'use strict';
// The 3-D view of a report: CAD, mesh and a cut through its cells. It knows no tables.
// Places that come in and go out are those of the CAD file, in metres; inside they are about `scene.origin`.

class Viewer {
  // Throws where the browser has no WebGL.
  constructor(canvas, scene) {
    this.origin = scene.origin;
    this.diagonal = scene.diagonal;
    this.colours = new Colours(scene.colors);
    this.surfaces = { cad: decodeSurface(scene.cad) };
    if (scene.mesh) this.surfaces.mesh = decodeSurface(scene.mesh);
    if (scene.volume) this.volume = new Volume(scene.volume);
    this.body = [0, 1, 2].map((a) => [scene.body[0][a] - scene.origin[a], scene.body[1][a] - scene.origin[a]]);
    this.mode = 'patch';
    this.layers = { cad: !scene.mesh, mesh: true, lines: true, edges: true, worst: false };
    this.hidden = new Set();  // names of surfaces with the number of a part: "mesh 3"
    this.cut = { axis: -1, value: 0, keep: 1, whole: false };
    this.onPick = () => {};
    this.onRender = () => {};

    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.localClippingEnabled = true;
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.light = new THREE.DirectionalLight(0xffffff, 0.55);
    this.world.add(this.light, new THREE.AmbientLight(0xffffff, 0.52));
    this.clip = new THREE.Plane(new THREE.Vector3(0, 0, 1), Infinity);
    this.parts = { cad: this.buildPatches('cad', 0x334455), mesh: [] };
    if (this.surfaces.mesh) this.parts.mesh = this.buildPatches('mesh', 0x10181f);
    this.edges = this.addLines(scene.edges, 0x101820);
    this.addMarks(scene.marks);
    this.addWorst(scene.worst);
    this.addMarker();
    this.cutGroup = new THREE.Group();
    this.world.add(this.cutGroup);

    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => this.render());
    window.addEventListener('resize', () => this.resize());
    this.listenToClicks(canvas);
    this.recolour();
    this.resize();
    this.look([-1, -1.4, 0.8]);
  }

  material(extra) {
    return new THREE.MeshPhongMaterial({
      vertexColors: THREE.VertexColors, flatShading: true, side: THREE.DoubleSide, specular: 0x181818, shininess: 25,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...extra,
    });
  }

  // One mesh and its lines a patch, so that a patch can be hidden.
  buildPatches(key, lineColour) {
    const surface = this.surfaces[key];
    const lists = surface.names.map(() => ({ faces: [], lines: [], length: 0 }));
    for (let f = 0; f < surface.name.length; ++f) {
      const list = lists[surface.name[f]];
      list.faces.push(f);
      for (let c = 0; c < 4; ++c) {
        const a = surface.faces[4 * f + c];
        const b = surface.faces[4 * f + (c + 1) % 4];
        if (a === b || key === 'cad') continue;
        const [p, q] = [pointOf(surface.points, a), pointOf(surface.points, b)];
        list.lines.push(...p, ...q);
        list.length += Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
      }
    }
    return lists.map((list, index) => {
      const mesh = new THREE.Mesh(new THREE.BufferGeometry(), this.material({ clippingPlanes: [this.clip] }));
      const lines = new THREE.LineSegments(segmentGeometry(list.lines), new THREE.LineBasicMaterial({
        color: lineColour, transparent: true, clippingPlanes: [this.clip] }));
      const spacing = list.lines.length ? list.length / (list.lines.length / 6) : 0;
      this.world.add(mesh, lines);
      return { key: `${key} ${index}`, surface, index, faces: list.faces, mesh, lines, spacing, source: [] };
    });
  }

  addLines(polylines, color) {
    const positions = [];
    for (const text of polylines) {
      const points = decodeNumbers(text, Float32Array);
      for (let i = 3; i + 2 < points.length; i += 3) positions.push(...points.subarray(i - 3, i + 3));
    }
    const lines = new THREE.LineSegments(segmentGeometry(positions),
      new THREE.LineBasicMaterial({ color, clippingPlanes: [this.clip] }));
    this.world.add(lines);
    return lines;
  }

  // Lines in the colour of the mark, and its number at its place.
  addMarks(marks) {
    marks.forEach(({ place, color, lines }, index) => {
      const colour = new THREE.Color(...color);
      this.addLines(lines, colour).renderOrder = 1;
      const sprite = this.sprite((context) => {
        context.fillStyle = colour.getStyle();
        context.beginPath();
        context.arc(32, 32, 26, 0, 2 * Math.PI);
        context.fill();
        context.fillStyle = '#ffffff';
        context.font = 'bold 34px sans-serif';
        context.textAlign = 'center';
        context.textBaseline = 'middle';
        context.fillText(String(index + 1), 32, 34, 46);
      }, 0.024);
      sprite.position.set(...place.map((x, axis) => x - this.origin[axis]));
    });
  }

  addWorst(cells) {
    const triangles = new TriangleList();
    const lines = [];
    const red = this.colours.colors.failure;
    for (const cell of cells) {
      const points = decodeNumbers(cell.corners, Float32Array);
      for (const face of hexFaces) triangles.face(face.map((c) => pointOf(points, c)), [red, red, red, red], -1);
      for (const [a, b] of hexEdges) lines.push(...pointOf(points, a), ...pointOf(points, b));
    }
    this.worst = new THREE.Group();
    this.worst.add(new THREE.Mesh(triangles.geometry(), this.material({ transparent: true, opacity: 0.45 })));
    this.worst.add(new THREE.LineSegments(segmentGeometry(lines), new THREE.LineBasicMaterial({ color: 0xb000b0 })));
    this.world.add(this.worst);
  }

  // A picture of constant size on the screen, seen through everything. `paint` draws it, 64 x 64 pixels.
  sprite(paint, scale) {
    const picture = document.createElement('canvas');
    picture.width = picture.height = 64;
    paint(picture.getContext('2d'));
    const sprite = new THREE.Sprite(new THREE.SpriteMaterial({
      map: new THREE.CanvasTexture(picture), depthTest: false, sizeAttenuation: false, transparent: true }));
    sprite.scale.setScalar(scale);
    sprite.renderOrder = 10;
    this.world.add(sprite);
    return sprite;
  }

  addMarker() {
    this.marker = this.sprite((context) => {
      for (const [width, colour] of [[9, '#ffffff'], [5, '#d0006f']]) {
        context.beginPath();
        context.arc(32, 32, 24, 0, 2 * Math.PI);
        context.lineWidth = width;
        context.strokeStyle = colour;
        context.stroke();
      }
    }, 0.035);
    this.marker.visible = false;
  }

  // Fills every mesh with the colours of the mode.
  recolour() {
    for (const part of [...this.parts.cad, ...this.parts.mesh]) {
      const { surface } = part;
      const triangles = new TriangleList();
      for (const f of part.faces) {
        const corners = [...surface.faces.subarray(4 * f, 4 * f + 4)];
        if (corners[2] === corners[3]) corners.pop();
        triangles.face(corners.map((p) => pointOf(surface.points, p)),
          corners.map((p) => this.colours.of(surface, this.mode, f, p)), f);
      }
      part.mesh.geometry.dispose();
      part.mesh.geometry = triangles.geometry();
      part.source = triangles.source;
    }
    this.rebuildCut();
  }

  // What the plane cuts of the cells, or these whole, and the plane that hides what is before it.
  rebuildCut() {
    for (const child of [...this.cutGroup.children]) {
      child.geometry.dispose();
      child.material.dispose();
      this.cutGroup.remove(child);
    }
    const { axis, value, keep } = this.cut;
    if (axis < 0 || !this.volume) {
      this.clip.constant = Infinity;
      this.render();
      return;
    }
    this.clip.normal.set(0, 0, 0).setComponent(axis, keep);
    this.clip.constant = -keep * value;
    const { points, quality } = this.volume;
    const triangles = new TriangleList();
    const lines = [];
    let length = 0;
    const add = (polygon, colour, cell) => {
      triangles.face(polygon, polygon.map(() => colour), cell);
      polygon.forEach((p, c) => {
        const q = polygon[(c + 1) % polygon.length];
        lines.push(...p, ...q);
        length += Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
      });
    };
    this.volume.visitCut(axis, value, (block, cell, corners, neighbourCut) => {
      let colour = this.colours.colors.neutral;
      if (this.mode === 'quality') colour = this.colours.verdict(this.colours.colors.quality, quality[cell]);
      if (this.mode === 'block') colour = this.colours.block(block);
      const at = corners.map((p) => pointOf(points, p));
      if (!this.cut.whole) add(cutPolygon(at, axis, value), colour, cell);
      else hexFaces.forEach((face, number) => neighbourCut(number) || add(face.map((c) => at[c]), colour, cell));
    });
    const mesh = new THREE.Mesh(triangles.geometry(), this.material({}));
    mesh.userData.source = triangles.source;
    const edges = new THREE.LineSegments(segmentGeometry(lines),
      new THREE.LineBasicMaterial({ color: 0x10181f, transparent: true }));
    edges.userData.spacing = lines.length ? length / (lines.length / 6) : 0;
    this.cutGroup.add(mesh, edges);
    this.render();
  }

  setMode(mode) {
    this.mode = mode;
    this.recolour();
  }
  setLayer(name, on) {
    this.layers[name] = on;
    this.render();
  }
  // surface: 'cad' or 'mesh'; index: into its names.
  setPatch(surface, index, on) {
    if (on) this.hidden.delete(`${surface} ${index}`);
    else this.hidden.add(`${surface} ${index}`);
    this.render();
  }
  // axis -1: off. Without `keep` the side away from the viewer is kept. `value` as in the CAD file.
  setCut(axis, value, keep) {
    const inside = axis < 0 ? 0 : value - this.origin[axis];
    const seenFrom = axis < 0 ? 0 : this.camera.position.getComponent(axis) - inside;
    this.cut = { ...this.cut, axis, value: inside, keep: keep || (seenFrom > 0 ? -1 : 1) };
    this.rebuildCut();
  }
  setWholeCells(on) {
    this.cut.whole = on;
    this.rebuildCut();
  }
  // [low, high] of the body and of the whole mesh along an axis, as in the CAD file.
  ranges(axis) {
    const shifted = (range) => range.map((x) => x + this.origin[axis]);
    return { body: shifted(this.body[axis]), all: shifted(this.volume ? this.volume.bounds[axis] : this.body[axis]) };
  }

  // The whole body, seen from a direction and as large as the picture allows.
  look(direction) {
    const toward = new THREE.Vector3(...direction).normalize();
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(toward);
    this.camera.lookAt(this.controls.target);
    const half = 0.85 * Math.tan(this.camera.fov * Math.PI / 360);
    const turn = this.camera.quaternion.clone().inverse();
    let distance = 1e-6 * this.diagonal;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(...this.body.map((range, axis) => range[corner >> axis & 1])).applyQuaternion(turn);
      distance = Math.max(distance, p.z + Math.abs(p.y) / half, p.z + Math.abs(p.x) / (half * this.camera.aspect));
    }
    this.camera.position.copy(toward.multiplyScalar(distance));
    this.marker.visible = false;
    this.controls.update();
    this.render();
  }

  // The outward normal of the nearest face, so that the way to a place ends before the surface, not inside of it.
  normalNear(place) {
    const surface = this.surfaces.mesh || this.surfaces.cad;
    let nearest = Infinity;
    let face = -1;
    for (let f = 0; f < surface.name.length; ++f) {
      if (surface.names[surface.name[f]].type === 'farfield') continue;
      const p = pointOf(surface.points, surface.faces[4 * f]);
      const distance = (p[0] - place.x) ** 2 + (p[1] - place.y) ** 2 + (p[2] - place.z) ** 2;
      if (distance < nearest) [nearest, face] = [distance, f];
    }
    if (face < 0) return new THREE.Vector3(0, 0, 1);
    const [a, b, c, d] = [0, 1, 2, 3].map((i) => new THREE.Vector3(...pointOf(surface.points, surface.faces[4 * face + i])));
    if (surface.faces[4 * face + 2] === surface.faces[4 * face + 3]) return b.sub(a).cross(c.sub(a)).normalize();
    return c.sub(a).cross(d.sub(b)).normalize();
  }

  // Moves the camera before a place and marks it. `reach`: metres that the picture shows about there.
  flyTo(place, reach = 0.08 * this.diagonal) {
    const target = new THREE.Vector3(...place.map((x, axis) => x - this.origin[axis]));
    const toward = this.camera.position.clone().sub(this.controls.target).normalize();
    const normal = this.normalNear(target);
    if (toward.dot(normal) < 0.35) toward.multiplyScalar(0.6).addScaledVector(normal, 1.2).normalize();
    const end = toward.multiplyScalar(reach / (2 * Math.tan(this.camera.fov * Math.PI / 360))).add(target);
    this.marker.position.copy(target);
    this.marker.visible = true;
    const [from, aim] = [this.camera.position.clone(), this.controls.target.clone()];
    const start = performance.now();
    const still = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
    const flight = {};
    this.flight = flight;  // a later one ends this
    const step = (now) => {
      if (this.flight !== flight) return;
      const t = still ? 1 : Math.min(1, Math.max(0, (now - start) / 700));
      const s = t * t * (3 - 2 * t);
      this.camera.position.lerpVectors(from, end, s);
      this.controls.target.lerpVectors(aim, target, s);
      this.controls.update();
      this.render();
      if (t < 1) requestAnimationFrame(step);
    };
    step(start);
  }

  // What is under the pointer at a click (not at the end of a turn): to onPick, null for nothing.
  listenToClicks(canvas) {
    let down = null;
    const hit = (event) => {
      const box = canvas.getBoundingClientRect();
      const pointer = new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1,
        1 - 2 * (event.clientY - box.top) / box.height);
      return this.pick(pointer);
    };
    canvas.addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener('pointerup', (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) this.onPick(hit(event));
    });
    canvas.addEventListener('dblclick', (event) => {
      const found = hit(event);
      if (found) this.flyTo(found.place);
    });
  }

  pick(pointer) {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(pointer, this.camera);
    const meshes = [];
    this.world.traverse((object) => {
      let shown = object.isMesh && object.parent !== this.worst;
      for (let o = object; o; o = o.parent) shown = shown && o.visible;
      if (shown) meshes.push(object);
    });
    const kept = (hit) => hit.object.parent === this.cutGroup || this.clip.distanceToPoint(hit.point) >= 0;
    const first = caster.intersectObjects(meshes).find(kept);
    if (!first) return null;
    const place = [0, 1, 2].map((axis) => first.point.getComponent(axis) + this.origin[axis]);
    if (first.object.parent === this.cutGroup) {
      return { place, cell: { quality: this.volume.quality[first.object.userData.source[first.faceIndex]] } };
    }
    const part = [...this.parts.cad, ...this.parts.mesh].find((p) => p.mesh === first.object);
    const { surface } = part;
    const f = part.source[first.faceIndex];
    const face = { name: surface.names[part.index].name, type: surface.names[part.index].type };
    if (surface.deviation.length) {
      face.deviation = Math.max(...[0, 1, 2, 3].map((c) => surface.deviation[surface.faces[4 * f + c]]));
    }
    if (surface.quality.length) face.quality = surface.quality[f];
    if (surface.region.length) face.region = surface.region[f];
    if (surface.block.length) face.block = surface.block[f];
    return { place, face };
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement.parentElement;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  render() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  draw() {
    const { camera, layers } = this;
    const distance = camera.position.distanceTo(this.controls.target);
    const far = camera.position.length() + Math.hypot(...(this.volume ? this.volume.bounds : this.body).flat());
    camera.near = Math.max(0.02 * distance, 1e-5 * far);
    camera.far = far;
    camera.updateProjectionMatrix();
    this.light.position.copy(camera.position).sub(this.controls.target).normalize()
      .addScaledVector(camera.up, 0.35);
    const pixels = this.renderer.domElement.clientHeight /
      (2 * Math.tan(camera.fov * Math.PI / 360) * distance);
    // Lines closer than a few pixels would make all black.
    const showLines = (lines, spacing, on) => {
      lines.material.opacity = 0.65 * Math.min(1, Math.max(0, (pixels * spacing - 1.5) / 10));
      lines.visible = on && layers.lines && lines.material.opacity > 0.02;
    };
    for (const part of this.parts.cad) {
      part.mesh.visible = layers.cad && !this.hidden.has(part.key);
      part.mesh.material.transparent = layers.mesh && this.parts.mesh.length > 0;
      part.mesh.material.opacity = part.mesh.material.transparent ? 0.4 : 1;
      showLines(part.lines, part.spacing, false);
    }
    for (const part of this.parts.mesh) {
      part.mesh.visible = layers.mesh && !this.hidden.has(part.key);
      showLines(part.lines, part.spacing, part.mesh.visible);
    }
    if (this.cutGroup.children.length) {
      const [, lines] = this.cutGroup.children;
      showLines(lines, lines.userData.spacing, true);
    }
    this.edges.visible = layers.edges;
    this.worst.visible = layers.worst;
    this.renderer.render(this.world, camera);
    this.onRender(camera);
  }
}
