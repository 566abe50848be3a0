// Hair cards in WebGL 2, for browsers without WebGPU. <tresses-viewer> loads this module only to draw cards. See README.md.

import * as THREE from "./three/three.module.min.js";
import { GLTFLoader } from "./three/GLTFLoader.js";
import { OrbitControls } from "./three/OrbitControls.js";

/** Azimuth toward the head's left and elevation of each view, degrees. */
const VIEWS = { front: [0, 4], "three-quarter": [32, 4], side: [90, 4], back: [180, 6] };
/** Vertical field of view, degrees. */
const FOV = 30;
/** Height of the screen that MSFT_screencoverage assumes, pixels. */
const LINES = 720;
/** A finer level returns at a size that is larger by this factor than the size at which it was left. */
const HYSTERESIS = 1.1;
/** Color of bodies without a material, linear. */
const SKIN = new THREE.Color(0.35, 0.27, 0.22);

/** A viewer of cards with the interface of the WebAssembly module's `Viewer`. */
export class CardsViewer {
  #canvas; #onChange; #renderer; #controls; #observer; #request;
  #model; #levels; #sizes; #animations; #mixer; #action;
  #animation = "";
  #scene = new THREE.Scene();
  #lights = new THREE.Group();
  #camera = new THREE.PerspectiveCamera(FOV, 1, 0.02, 100);
  #bounds = new THREE.Box3();
  #view = "three-quarter";
  #last = 0;
  #changed = true;
  #loads = 0;
  #state = { file: "", strands: 0, cards: 0, level: 0, step: "", error: "", playing: true, time: 0, size: [0, 0], frames: 0, seen: 0, milliseconds: 0, adapter: "WebGL 2", lost: false };

  static async open(canvas, _query, files, _hosted, onChange) {
    const viewer = new CardsViewer(canvas, onChange);
    try { await viewer.#show(files); } catch (error) { viewer.close(); throw error; }
    viewer.#request = requestAnimationFrame(viewer.#frame);
    return viewer;
  }

  constructor(canvas, onChange) {
    const context = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!context) throw new Error("This browser has no WebGL 2, which hair cards need.");
    this.#canvas = canvas;
    this.#onChange = onChange;
    this.#renderer = new THREE.WebGLRenderer({ canvas, context });
    this.#renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.#scene.background = new THREE.Color(0x3e4247);
    // The lights of the WebGPU viewer. They follow the camera around the head.
    const light = (r, g, b, ...position) => {
      const light = new THREE.DirectionalLight(new THREE.Color(r, g, b));
      light.position.set(...position);
      this.#lights.add(light);
    };
    light(5.6, 5.3, 4.85, -0.42, 0.62, 0.66);
    light(3.1, 3.25, 3.5, 0.85, 0.28, -0.45);
    this.#scene.add(this.#lights, new THREE.HemisphereLight(new THREE.Color(0.85, 0.87, 0.92), new THREE.Color(0.55, 0.53, 0.52)));
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enablePan = false;
    this.#controls.addEventListener("change", () => { this.#changed = true; });
    this.#observer = new ResizeObserver(() => { this.#changed = true; });
    this.#observer.observe(canvas);
    canvas.addEventListener("webglcontextlost", this.#lose);
    canvas.addEventListener("webglcontextrestored", this.#restore);
  }

  /** Shows the first .glb of `files`, alternating names and bytes. Reports success and errors in the state. */
  load(files) {
    this.#tell({ step: "loading", error: "" });
    const loadId = this.#loads + 1;
    this.#show(files).catch(error => { if (loadId === this.#loads) this.#tell({ step: "", error: error.message }); });
  }

  set(name, value) {
    if (name === "playing") this.#tell({ playing: value !== "false" });
    else if (name === "camera") {
      if (!Object.hasOwn(VIEWS, value)) throw new Error(`camera: ${value} is not one of ${Object.keys(VIEWS).join(", ")}`);
      this.#view = value;
      this.#place();
    } else if (name === "animation") {
      if (!this.#state.step && !this.#animations.some(clip => clip.name === value))
        throw new Error(`animation: ${this.#state.file} has no ${value}; it has ${this.#animations.map(clip => clip.name).join(", ") || "none"}`);
      this.#animation = value;
      if (!this.#state.step) this.#play();
    } else throw new Error(`${name}: cards have only playing, camera and animation; other parameters need WebGPU`);
  }

  state() { return JSON.stringify(this.#state); }

  close() {
    this.#loads++;
    cancelAnimationFrame(this.#request);
    this.#observer.disconnect();
    this.#canvas.removeEventListener("webglcontextlost", this.#lose);
    this.#canvas.removeEventListener("webglcontextrestored", this.#restore);
    this.#controls.dispose();
    this.#clear();
    this.#renderer.dispose();
    // The page's own canvas keeps its only context, for the next time.
    if (!this.#canvas.assignedSlot) this.#renderer.forceContextLoss();
  }

  async #show(files) {
    const loadId = ++this.#loads;
    const at = files.findIndex((name, i) => i % 2 === 0 && /\.glb$/i.test(name));
    if (at < 0) throw new Error(`${files[0] ?? "no file"}: cards are .glb files, as \`tresses cards\` writes them`);
    const name = files[at], bytes = files[at + 1];
    const header = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    // The magic number of a GLB file is followed by its version and length.
    if (bytes.length < 20 || header.getUint32(0) !== 0x676c5446 || header.getUint32(8, true) !== bytes.length)
      throw new Error(`${name}: the file is not a whole .glb; write it again with \`tresses cards\``);
    let gltf, levels, sizes;
    try {
      gltf = await new GLTFLoader().parseAsync(bytes.slice().buffer, "");
      const { nodes } = gltf.parser.json, first = nodes.findIndex(node => node.name === "Hair_LOD0");
      if (first < 0) throw new Error("it has no hair cards; write it with `tresses cards`");
      const ids = [first, ...nodes[first].extensions?.MSFT_lod?.ids ?? []];
      levels = await Promise.all(ids.map(id => gltf.parser.getDependency("node", id)));
      const coverage = nodes[first].extras?.MSFT_screencoverage ?? [];
      sizes = ids.map((_, i) => LINES * Math.sqrt(coverage[i] ?? 0));
    } catch (error) {
      throw new Error(`${name}: the file cannot be shown: ${error.message}`);
    }
    if (loadId !== this.#loads) return dispose(gltf.scene);
    this.#clear();
    this.#model = gltf.scene;
    this.#levels = levels;
    this.#sizes = sizes;
    for (const level of levels) levels[0].parent.add(level);
    const filter = Math.min(8, this.#renderer.capabilities.getMaxAnisotropy());
    this.#model.traverse(mesh => {
      if (!mesh.isMesh) return;
      mesh.frustumCulled = false;
      const { vertexColors } = mesh.material;
      if (!gltf.parser.associations.get(mesh.material))
        mesh.material = new THREE.MeshStandardMaterial({ color: vertexColors ? 0xffffff : SKIN, vertexColors, roughness: 0.6 });
      // Cards are in order from the scalp outwards.
      mesh.material.forceSinglePass = true;
      if (mesh.material.map) mesh.material.map.anisotropy = filter;
    });
    this.#scene.add(this.#model);
    this.#model.updateMatrixWorld(true);
    this.#bounds.setFromObject(levels[0]);
    this.#animations = gltf.animations;
    this.#mixer = new THREE.AnimationMixer(this.#model);
    this.#play();
    this.#place();
    Object.assign(this.#state, { file: name, cards: count(levels[0]), level: 0, step: "loading" });
  }

  #clear() {
    this.#mixer?.stopAllAction();
    if (this.#model) dispose(this.#model);
    this.#model?.removeFromParent();
    this.#model = this.#action = undefined;
  }

  #play() {
    this.#action?.stop();
    const clip = this.#animations.find(clip => clip.name === this.#animation) ?? this.#animations[0];
    this.#action = clip && this.#mixer.clipAction(clip).play();
    this.#changed = true;
  }

  /** Places the camera at the chosen view, so that the hair fills nine tenths of the canvas. */
  #place() {
    const [azimuth, elevation] = VIEWS[this.#view].map(THREE.MathUtils.degToRad);
    const back = new THREE.Vector3(Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation), Math.cos(azimuth) * Math.cos(elevation));
    const right = new THREE.Vector3(back.z, 0, -back.x).normalize(), up = new THREE.Vector3().crossVectors(back, right);
    const half = this.#bounds.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    const tan = 0.9 * Math.tan(THREE.MathUtils.degToRad(FOV / 2)), aspect = this.#canvas.clientWidth / this.#canvas.clientHeight || 1;
    // Fit an elliptic cylinder that is narrower at top and bottom.
    let distance = 0.05;
    for (let i = 0; i < 32; i++) {
      const rim = (radius, y) => new THREE.Vector3(radius * Math.cos(i / 16 * Math.PI), y, radius * Math.sin(i / 16 * Math.PI)).multiply(half);
      const wide = rim(1, 0);
      distance = Math.max(distance, wide.dot(back) + Math.abs(wide.dot(right)) / (tan * aspect),
        ...[-1, 1].map(y => rim(0.7, y)).map(p => p.dot(back) + Math.abs(p.dot(up)) / tan));
    }
    this.#bounds.getCenter(this.#controls.target);
    this.#camera.position.copy(this.#controls.target).addScaledVector(back, distance);
    this.#controls.minDistance = 0.3 * distance;
    this.#controls.maxDistance = 50 * distance;
    this.#controls.update();
    this.#changed = true;
  }

  /** Returns the level for the size of the hair on the screen. */
  #level() {
    const distance = this.#camera.position.distanceTo(this.#controls.target);
    const diameter = this.#bounds.getSize(new THREE.Vector3()).length();
    const pixels = this.#canvas.height * diameter / (2 * distance * Math.tan(THREE.MathUtils.degToRad(FOV / 2)));
    let { level } = this.#state;
    while (level > 0 && pixels > this.#sizes[level - 1] * HYSTERESIS) level--;
    while (level + 1 < this.#levels.length && pixels < this.#sizes[level]) level++;
    return level;
  }

  #frame = now => {
    this.#request = requestAnimationFrame(this.#frame);
    if (this.#state.playing && this.#action) {
      this.#mixer.update(Math.min((now - this.#last) / 1000, 0.1));
      this.#changed = true;
    }
    this.#last = now;
    const { clientWidth, clientHeight } = this.#canvas;
    if (!this.#changed || this.#state.lost || !clientWidth || !clientHeight) return;
    this.#changed = false;
    const begin = performance.now();
    const before = { ...this.#state }, ratio = Math.min(devicePixelRatio, 2);
    const size = [clientWidth, clientHeight].map(length => Math.floor(length * ratio));
    if (`${size}` !== `${before.size}`) {
      this.#renderer.setSize(...size, false);
      this.#camera.aspect = clientWidth / clientHeight;
      this.#camera.updateProjectionMatrix();
    }
    const level = this.#level();
    this.#levels.forEach((object, i) => { object.visible = i === level; });
    this.#lights.rotation.y = this.#controls.getAzimuthalAngle();
    this.#renderer.render(this.#scene, this.#camera);
    const frames = before.frames + 1;
    Object.assign(this.#state, { level, size, frames, seen: frames, time: this.#mixer.time, milliseconds: performance.now() - begin });
    if (before.step || level !== before.level || `${size}` !== `${before.size}`) this.#tell({ step: "" });
  };

  #lose = () => this.#tell({ lost: true, error: "The browser has lost the WebGL context; reload the page if the hair does not return." });
  #restore = () => { this.#changed = true; this.#tell({ lost: false, error: "" }); };

  #tell(change) {
    Object.assign(this.#state, change);
    this.#onChange(this.state());
  }
}

/** Frees geometry, materials, textures and skeletons of a model. */
function dispose(model) {
  model.traverse(mesh => {
    if (!mesh.isMesh) return;
    mesh.geometry.dispose();
    mesh.skeleton?.dispose();
    for (const texture of Object.values(mesh.material).filter(value => value?.isTexture)) {
      texture.dispose();
      texture.image?.close?.();
    }
    mesh.material.dispose();
  });
}

/** Returns the number of cards of a level: of ranges of vertices without a common triangle. */
function count(level) {
  let geometry;
  level.traverse(mesh => { geometry ??= mesh.geometry; });
  const { index, attributes } = geometry, ends = new Uint32Array(attributes.position.count).map((_, i) => i);
  for (let i = 0; i < index.count; i += 3) {
    const corners = [0, 1, 2].map(k => index.getX(i + k)), first = Math.min(...corners);
    ends[first] = Math.max(ends[first], ...corners);
  }
  let cards = 0, end = -1;
  ends.forEach((last, i) => {
    if (i > end) cards++;
    end = Math.max(end, last);
  });
  return cards;
}
