/** How a viewer is. */
export interface ViewerState {
  /** What is shown. */
  file: string;
  strands: number;
  /** What is being done, or empty. */
  step: string;
  /** The last sentence about something that went wrong, or empty. */
  error: string;
  playing: boolean;
  /** Seconds of the motion. */
  time: number;
  /** Pixels of the picture. */
  size: [number, number];
  /** Pictures so far. */
  frames: number;
  /** Milliseconds of the last one. */
  milliseconds: number;
  adapter: string;
  lost: boolean;
}

export interface ViewerEvents {
  /** The program runs. */
  ready: CustomEvent<void>;
  /** Files are shown. */
  load: CustomEvent<{ file: string; strands: number }>;
  /** A sentence about what went wrong. */
  error: CustomEvent<string>;
  /** Bytes loaded so far; `total` is 0 where nobody says. */
  progress: CustomEvent<{ what: "viewer" | "files"; loaded: number; total: number }>;
  /** Anything but time and frames has changed. */
  change: CustomEvent<ViewerState>;
}

export declare class TressesViewer extends HTMLElement {
  open(): Promise<void>;
  close(): void;
  load(...urls: (string | URL)[]): Promise<{ file: string; strands: number }>;
  loadBytes(files: (string | Uint8Array)[]): Promise<{ file: string; strands: number }>;
  /** `playing`, `motion`, `animation`, `camera`, or a parameter by its path. */
  set(name: string, value: string | number | boolean): void;
  readonly state: Partial<ViewerState>;
  addEventListener<K extends keyof ViewerEvents>(type: K, listener: (event: ViewerEvents[K]) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
}

/** Why this browser cannot show hair, or null. */
export declare function unsupported(): Promise<string | null>;
/** Names and bytes in turn, for `loadBytes`. */
export declare function fetchFiles(urls: (string | URL)[], progress?: (loaded: number, total: number) => void): Promise<(string | Uint8Array)[]>;

declare global {
  interface HTMLElementTagNameMap { "tresses-viewer": TressesViewer }
}
