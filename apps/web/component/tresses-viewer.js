// <tresses-viewer src="hair.glb">: hair in a web page, simulated and rendered with WebGPU, or cards without it. See README.md.

const module = new URL("./tresses.js", import.meta.url);

/** The WebAssembly module, loaded once for all elements of a page. `progress(loaded, total)` receives bytes. */
let program;
const listeners = new Set();
function loadProgram(progress) {
  if (progress) listeners.add(progress);
  program ??= (async () => {
    const { default: init, Viewer } = await import(module);
    const wasm = await fetchBytes(new URL("./tresses_bg.wasm", import.meta.url), (loaded, total) => {
      for (const listener of listeners) listener(loaded, total);
    });
    await init({ module_or_path: wasm });
    return Viewer;
  })();
  // Allow another attempt after a failure.
  program.catch(() => { program = undefined; }).finally(() => listeners.clear());
  return program;
}

/** Fetches a file. `progress(loaded, total)` receives bytes; `total` is 0 if the server does not send the length. */
async function fetchBytes(url, progress) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} cannot be loaded (${response.status} ${response.statusText})`);
  const encoded = response.headers.get("Content-Encoding");
  const total = encoded ? 0 : Number(response.headers.get("Content-Length") ?? 0);
  const parts = [];
  let loaded = 0;
  for (const reader = response.body.getReader(); ;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    loaded += value.length;
    progress?.(loaded, total);
  }
  const bytes = new Uint8Array(loaded);
  let at = 0;
  for (const part of parts) { bytes.set(part, at); at += part.length; }
  return bytes;
}

/** Fetches files as alternating names and bytes, for `loadBytes`. */
export async function fetchFiles(urls, progress) {
  const counts = urls.map(() => [0, 0]);
  const files = await Promise.all(urls.map(async (url, i) => {
    const bytes = await fetchBytes(url, (loaded, total) => {
      counts[i] = [loaded, total];
      progress?.(counts.reduce((sum, c) => sum + c[0], 0), counts.every(c => c[1]) ? counts.reduce((sum, c) => sum + c[1], 0) : 0);
    });
    return [decodeURIComponent(new URL(url, document.baseURI).pathname.split("/").pop()), bytes];
  }));
  return files.flat();
}

/** Returns why this browser cannot show hair, or null. */
export async function unsupported() {
  if (!navigator.gpu)
    return "This browser has no WebGPU. Use a current version of Chrome, Edge, Firefox or Safari, and open the page by https or from localhost.";
  return await navigator.gpu.requestAdapter() ? null : "This browser has WebGPU, but no usable GPU.";
}

const words = text => text ? text.split(/\s+/).filter(Boolean) : [];
const FILES = ["src", "head", "preset"];
const ATTRIBUTES = [...FILES, "cards", "render", "motion", "animation", "camera", "paused"];

export class TressesViewer extends HTMLElement {
  static observedAttributes = ATTRIBUTES;

  #viewer = null;
  /** Whether the viewer shows cards. */
  #cards = false;
  #opening = null;
  #state = {};
  #canvas = null;
  #message = null;

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    root.innerHTML = `<style>
      :host { display: block; position: relative; min-height: 10em; background: #242629; color: #c9cbd0; overflow: hidden }
      canvas { position: absolute; inset: 0; width: 100%; height: 100%; outline: none; touch-action: none }
      div { position: absolute; inset: 0; display: grid; place-items: center; padding: 1em; text-align: center; font: 16px/1.5 system-ui, sans-serif; pointer-events: none }
      div[hidden] { display: none }
    </style><slot name="canvas"></slot><div part="message" role="status" hidden></div>`;
    this.#message = root.querySelector("div");
  }

  connectedCallback() { this.open().catch(() => {}); }

  disconnectedCallback() {
    // Keep running if the element was only moved within the page.
    queueMicrotask(() => { if (!this.isConnected) this.close(); });
  }

  attributeChangedCallback(name, before, now) {
    if (before === now || !this.#opening) return;
    if (name === "render") {
      this.close();
      this.open().catch(() => {});
    } else if (!this.#viewer) return;
    else if (name === "cards" || FILES.includes(name)) {
      if (this.#cards === (name === "cards")) this.load(...this.#urls()).catch(error => this.#fail(error));
    } else this.#attempt(name);
  }

  /** Opens the viewer unless it is open. Resolves when the viewer runs. */
  open() {
    if (this.#opening) return this.#opening;
    const isCurrent = () => this.#opening === opening;
    const opening = this.#open(isCurrent).catch(error => {
      if (isCurrent()) {
        this.close();
        this.#fail(error);
      }
      throw error;
    });
    return this.#opening = opening;
  }

  async #open(isCurrent) {
    const forcesCards = this.getAttribute("render") === "cards";
    const reason = forcesCards ? 'render="cards" needs a file of cards: set the attribute cards.' : await unsupported();
    this.#cards = reason !== null && words(this.getAttribute("cards")).length > 0;
    if (reason && !this.#cards) throw new Error(reason);
    const [Viewer, files] = await Promise.all([
      this.#cards
        ? import("./tresses-cards.js").then(({ CardsViewer }) => CardsViewer)
        : loadProgram((loaded, total) => this.#progress("viewer", loaded, total)),
      fetchFiles(this.#urls(), (loaded, total) => this.#progress("files", loaded, total)),
    ]);
    const check = () => { if (!isCurrent() || !this.isConnected) throw new Error("the element was removed from the page or closed"); };
    check();
    // Use the page's own canvas if there is one, else create one.
    this.#canvas = this.querySelector("canvas[slot=canvas]");
    if (!this.#canvas) {
      this.#canvas = document.createElement("canvas");
      this.shadowRoot.insertBefore(this.#canvas, this.#message);
    }
    this.#canvas.tabIndex = 0;
    const viewer = await Viewer.open(this.#canvas, this.getAttribute("query") ?? "", files, true, text => this.#update(JSON.parse(text)));
    try { check(); } catch (error) { viewer.close(); throw error; }
    this.#viewer = viewer;
    this.#say("");
    for (const name of ["motion", "animation", "camera", "paused"]) this.#attempt(name);
    this.dispatchEvent(new CustomEvent("ready"));
  }

  /** Closes the viewer and frees its resources. */
  close() {
    this.#viewer?.close();
    this.#viewer = this.#opening = null;
    this.#state = {};
    if (this.#canvas?.parentNode === this.shadowRoot) this.#canvas.remove();
  }

  /** Loads the files at `urls`: grooms, heads, presets, maps, environments. Resolves when they are shown. */
  async load(...urls) {
    await this.open();
    const files = await fetchFiles(urls, (loaded, total) => this.#progress("files", loaded, total));
    return this.loadBytes(files);
  }

  /** Loads files given as alternating names and `Uint8Array`s. */
  async loadBytes(files) {
    await this.open();
    const shown = new Promise((resolve, reject) => {
      const end = new AbortController();
      const once = (name, then) => this.addEventListener(name, event => { end.abort(); then(event); }, { signal: end.signal });
      once("load", event => resolve(event.detail));
      once("error", event => reject(new Error(event.detail)));
    });
    this.#viewer.load(files);
    this.#attempt("animation");
    return shown;
  }

  /** Sets `playing`, `motion`, `animation`, `camera`, or a parameter by its path, such as `wind.speed`. */
  set(name, value) {
    if (!this.#viewer) throw new Error("the viewer is not open yet: await viewer.open()");
    try { this.#viewer.set(name, String(value)); } catch (error) { throw new Error(error?.message ?? String(error)); }
  }

  /** The current state: file, strands, step, error, playing, size, frames, milliseconds. */
  get state() { return this.#viewer ? JSON.parse(this.#viewer.state()) : {}; }

  #urls() { return (this.#cards ? ["cards"] : FILES).flatMap(name => words(this.getAttribute(name))); }

  #attempt(name) {
    const value = this.getAttribute(name);
    try {
      if (name === "paused") this.set("playing", value === null);
      // Cards have no motion. The attribute is for browsers with WebGPU.
      else if (value !== null && !(this.#cards && name === "motion")) this.set(name, value);
    } catch (error) { this.#fail(error); }
  }

  #update(state) {
    const before = this.#state;
    this.#state = state;
    if (state.error && state.error !== before.error) this.dispatchEvent(new CustomEvent("error", { detail: state.error }));
    const arrived = state.seen > 0 && !state.step && (before.step || !(before.seen > 0) || state.file !== before.file);
    if (arrived && !state.error) {
      const cards = this.#cards ? { cards: state.cards } : {};
      this.dispatchEvent(new CustomEvent("load", { detail: { file: state.file, strands: state.strands, ...cards } }));
    }
    this.dispatchEvent(new CustomEvent("change", { detail: state }));
  }

  #progress(what, loaded, total) {
    const mb = bytes => (bytes / 1e6).toFixed(1);
    if (!this.#viewer) this.#say(total ? `loading ${mb(loaded)} of ${mb(total)} MB` : `loading ${mb(loaded)} MB`);
    this.dispatchEvent(new CustomEvent("progress", { detail: { what, loaded, total } }));
  }

  #say(text) { this.#message.textContent = text; this.#message.hidden = !text; }

  #fail(error) {
    const text = error?.message ?? String(error);
    if (!this.#viewer) this.#say(text);
    this.dispatchEvent(new CustomEvent("error", { detail: text }));
  }
}

customElements.define("tresses-viewer", TressesViewer);
