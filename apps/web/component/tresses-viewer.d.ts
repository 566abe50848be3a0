/** State of a viewer. */
export interface ViewerState {
  /** Name of the hair. */
  file: string;
  /** 0 for cards. */
  strands: number;
  /** Number of cards of the finest level, and index of the drawn level; only for cards. */
  cards?: number;
  level?: number;
  /** Current step of the running job, or empty. */
  step: string;
  /** The last error, or empty. */
  error: string;
  playing: boolean;
  /** Time of the motion, seconds. */
  time: number;
  /** Size of the displayed frame, pixels. */
  size: [number, number];
  /** Number of frames drawn so far. */
  frames: number;
  /** Duration of the last frame, milliseconds. */
  milliseconds: number;
  adapter: string;
  lost: boolean;
}

export interface LoadedFile {
  file: string;
  /** 0 for cards. */
  strands: number;
  /** Number of cards of the finest level; only for cards. */
  cards?: number;
}

export interface ViewerEvents {
  /** The viewer runs. */
  ready: CustomEvent<void>;
  /** Files have been loaded and are shown. */
  load: CustomEvent<LoadedFile>;
  /** An error message. */
  error: CustomEvent<string>;
  /** Loaded bytes; `total` is 0 if unknown. */
  progress: CustomEvent<{ what: "viewer" | "files"; loaded: number; total: number }>;
  /** The state has changed, other than time and frame counts. */
  change: CustomEvent<ViewerState>;
}

export declare class TressesViewer extends HTMLElement {
  open(): Promise<void>;
  close(): void;
  load(...urls: (string | URL)[]): Promise<LoadedFile>;
  loadBytes(files: (string | Uint8Array)[]): Promise<LoadedFile>;
  /** Sets `playing`, `motion`, `animation`, `camera`, or a parameter by its path. Cards have only `playing`, `animation` and `camera`. */
  set(name: string, value: string | number | boolean): void;
  readonly state: Partial<ViewerState>;
  addEventListener<K extends keyof ViewerEvents>(type: K, listener: (event: ViewerEvents[K]) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
}

/** Returns why this browser cannot simulate and draw strands, or null. Such browsers may still draw cards. */
export declare function unsupported(): Promise<string | null>;
/** Fetches files as alternating names and bytes, for `loadBytes`. */
export declare function fetchFiles(urls: (string | URL)[], progress?: (loaded: number, total: number) => void): Promise<(string | Uint8Array)[]>;

declare global {
  interface HTMLElementTagNameMap { "tresses-viewer": TressesViewer }
}
