/** Where a tool draws. */
export interface Surface {
  /** From pixels of the camera's full picture to the canvas. */
  toCanvas: (u_px: number, v_px: number) => [number, number];
  unit: number; // canvas pixels of a CSS pixel
  picture: [number, number, number, number]; // left, top, width, height of the picture on the canvas
}

/** What a page does with the picture beside zooming and moving it. Coordinates are pixels of the camera's full picture. */
export interface PictureTool {
  draw(context: CanvasRenderingContext2D, surface: Surface): void;
  still?: ImageBitmap | null; // shown instead of the live picture
  fullResolution?: boolean; // the camera's own pixels, although nobody has zoomed in
  /** The point that the magnifier shows, or null. */
  magnified?(): [number, number] | null;
  /** Returns whether the press takes hold of something within `reach` pixels; it is then dragged and released. */
  grab?(u: number, v: number, reach: number): boolean;
  drag?(u: number, v: number): void;
  release?(): void;
  /** A press that neither moved nor took hold. */
  click?(u: number, v: number): void;
  /** Returns whether the key was used. */
  key?(event: KeyboardEvent): boolean;
}
