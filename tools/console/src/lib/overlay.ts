import { drawLabel } from './canvas_label';
import { LAYER_COLORS, type LayerKey } from './layers';
import { fieldLines } from './field_lines';
import type { TeamName } from './message_types';
import type { PixelMap } from './projection';
import type { Hello, Regions, State } from './protocol';
import type { Trails } from './trails';

type Point = [number, number];

export interface OverlayInput {
  state: State;
  hello: Hello;
  pixels: PixelMap | null;
  trails: Trails;
  regions: Regions | null;
  layers: ReadonlySet<LayerKey>;
  /** From pixels of the camera's full picture to the canvas. */
  toCanvas: (u_px: number, v_px: number) => Point;
  lineWidth: number; // of the canvas' pixels, for one CSS pixel
  detailed: boolean; // there is room for confidences
}

/** Draws the chosen layers over the picture that `state` belongs to. */
export function drawOverlay(context: CanvasRenderingContext2D, input: OverlayInput): void {
  const pen = new Pen(context, input.lineWidth);
  const on = (layer: LayerKey) => input.layers.has(layer);
  if (on('interest')) drawInterest(pen, input);
  if (on('regions')) drawRegions(pen, input);
  if (on('lines')) drawLines(pen, input);
  if (on('trails')) drawTrails(pen, input);
  if (on('tracks')) drawTracks(pen, input);
  if (on('action')) drawAction(pen, input);
  if (on('truth')) drawTruth(pen, input);
  if (on('play')) drawPlay(pen, input);
  if (on('ball')) drawBall(pen, input);
  if (on('robots')) drawRobots(pen, input);
  if (on('refusals')) drawRefusals(pen, input);
}

/** Every line has a dark edge, so that it shows on any picture. */
class Pen {
  constructor(
    private readonly context: CanvasRenderingContext2D,
    readonly unit: number,
  ) {}

  line(points: readonly Point[], color: string, options: { closed?: boolean; dash?: number[]; width?: number } = {}): void {
    if (points.length < 2) return;
    const { context, unit } = this;
    context.beginPath();
    points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    if (options.closed) context.closePath();
    const width = options.width ?? 1.75;
    context.lineJoin = 'round';
    context.setLineDash((options.dash ?? []).map((length) => length * unit));
    context.strokeStyle = 'rgb(0 0 0 / 0.6)';
    context.lineWidth = (width + 1.75) * unit;
    context.stroke();
    context.strokeStyle = color;
    context.lineWidth = width * unit;
    context.stroke();
    context.setLineDash([]);
  }

  text(text: string, [x, y]: Point, color: string, size = 13): void {
    const { context, unit } = this;
    context.font = `600 ${size * unit}px system-ui, sans-serif`;
    drawLabel(context, text, x, y, { color: 'rgb(0 0 0 / 0.75)', width: 3.5 * unit }, color);
  }
}

function heightOf(hello: Hello, team: TeamName): number {
  return hello.robots.find((robot) => robot.team === team)?.height_m ?? 0;
}

/** The parts of a line on the field that the camera sees. */
function project(input: OverlayInput, points: readonly Point[], height_m: number): Point[][] {
  const parts: Point[][] = [[]];
  for (const [x, y] of points) {
    const pixel = input.pixels?.toPixel(x, y, height_m);
    if (pixel) parts.at(-1)!.push(input.toCanvas(pixel.u, pixel.v));
    else if (parts.at(-1)!.length > 0) parts.push([]);
  }
  return parts;
}

function drawLines(pen: Pen, input: OverlayInput): void {
  for (const line of fieldLines(input.hello.field)) {
    for (const part of project(input, line, 0)) pen.line(part, LAYER_COLORS.lines, { dash: [7, 5], width: 1.5 });
  }
}

function drawTrails(pen: Pen, input: OverlayInput): void {
  for (const [key, trail] of input.trails.entries()) {
    const height = key === 'ball' ? (input.hello.ball?.radius_m ?? 0) : heightOf(input.hello, key.startsWith('own') ? 'own' : 'opponent');
    const points = trail.filter((point) => point.at_s <= input.state.captured_s).map(({ x, y }): Point => [x, y]);
    for (const part of project(input, points, height)) pen.line(part, key === 'ball' ? LAYER_COLORS.ball : LAYER_COLORS.trails, { width: 1.5 });
  }
}

/** Points of the ellipse of three standard deviations around a position. */
export function ellipse(x: number, y: number, xx: number, yy: number, xy: number): Point[] {
  const middle = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  const major = 3 * Math.sqrt(Math.max(0, middle + spread));
  const minor = 3 * Math.sqrt(Math.max(0, middle - spread));
  const angle = 0.5 * Math.atan2(2 * xy, xx - yy);
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return Array.from({ length: 33 }, (_, i): Point => {
    const t = (i / 32) * 2 * Math.PI;
    const [a, b] = [major * Math.cos(t), minor * Math.sin(t)];
    return [x + c * a - s * b, y + s * a + c * b];
  });
}

function drawPose(pen: Pen, input: OverlayInput, pose: { x_m: number; y_m: number; heading_rad: number }, team: TeamName, color: string, dash?: number[]): void {
  const height = heightOf(input.hello, team);
  const size = (input.hello.robots.find((robot) => robot.team === team)?.length_m ?? 0.08) / 2;
  const [c, s] = [Math.cos(pose.heading_rad), Math.sin(pose.heading_rad)];
  const at = (forward: number, left: number): Point => [pose.x_m + c * forward - s * left, pose.y_m + s * forward + c * left];
  const corners = [at(-size, -size), at(size, -size), at(size, size), at(-size, size), at(-size, -size)];
  for (const part of project(input, corners, height)) pen.line(part, color, dash ? { dash } : {});
  for (const part of project(input, [at(0, 0), at(1.6 * size, 0)], height)) pen.line(part, color);
}

function drawTracks(pen: Pen, input: OverlayInput): void {
  const color = LAYER_COLORS.tracks;
  for (const track of input.state.tracks) {
    const height = heightOf(input.hello, track.team);
    const outline = ellipse(track.x_m, track.y_m, track.sigma_x_m ** 2, track.sigma_y_m ** 2, track.covariance_xy_m2);
    for (const part of project(input, outline, height)) pen.line(part, color);
    drawPose(pen, input, track, track.team, color, track.seen ? undefined : [3, 3]);
  }
  const ball = input.state.ball_track;
  if (ball) {
    const outline = ellipse(ball.x_m, ball.y_m, ball.sigma_m ** 2, ball.sigma_m ** 2, 0);
    const height = input.hello.ball?.radius_m ?? 0;
    for (const part of project(input, outline, height)) pen.line(part, color);
    for (const part of project(input, [[ball.x_m, ball.y_m], [ball.x_m + 0.25 * ball.vx_mps, ball.y_m + 0.25 * ball.vy_mps]], height)) pen.line(part, color);
  }
}

function drawAction(pen: Pen, input: OverlayInput): void {
  for (const track of input.state.tracks) drawPose(pen, input, track.action, track.team, LAYER_COLORS.action);
}

/** Thin and dashed, so that what was recognized shows below it. */
function drawTruth(pen: Pen, input: OverlayInput): void {
  const { truth } = input.state;
  if (!truth) return;
  const color = LAYER_COLORS.truth;
  for (const robot of truth.robots) drawPose(pen, input, robot, robot.team, color, [4, 3]);
  const { x_m, y_m } = truth.ball;
  const radius = input.hello.ball?.radius_m ?? 0;
  const outline = ellipse(x_m, y_m, (radius / 3) ** 2, (radius / 3) ** 2, 0);
  for (const part of project(input, outline, radius)) pen.line(part, color, { dash: [4, 3] });
}

// Length of the arrow that shows the direction of the motion at a target.
const ARROW_M = 0.08;

/** A straight line from each robot to its target, and there a cross with the direction of the motion. */
function drawPlay(pen: Pen, input: OverlayInput): void {
  const color = LAYER_COLORS.play;
  for (const { id, skill, target } of input.state.play ?? []) {
    const robot = input.state.tracks.find((track) => track.team === 'own' && track.id === id);
    if (!robot || !target) continue;
    const height = heightOf(input.hello, 'own');
    const at: Point = [target.x_m, target.y_m];
    for (const part of project(input, [[robot.x_m, robot.y_m], at], height)) pen.line(part, color, { dash: [2, 4] });
    if (target.heading_rad !== undefined) {
      const [c, s] = [Math.cos(target.heading_rad), Math.sin(target.heading_rad)];
      const tip: Point = [at[0] + ARROW_M * c, at[1] + ARROW_M * s];
      const barb = (side: number): Point => [tip[0] - 0.3 * ARROW_M * (c - side * s), tip[1] - 0.3 * ARROW_M * (s + side * c)];
      for (const line of [[at, tip], [barb(1), tip, barb(-1)]]) for (const part of project(input, line, height)) pen.line(part, color);
    }
    const center = project(input, [at], height)[0]?.[0];
    if (!center) continue;
    const arm = 5 * pen.unit;
    for (const side of [1, -1]) pen.line([[center[0] - arm, center[1] - side * arm], [center[0] + arm, center[1] + side * arm]], color);
    if (input.detailed) pen.text(`${id} ${skill ?? ''}`, [center[0], center[1] - 14 * pen.unit], color, 12);
  }
}

function ring(center: Point, radius: number): Point[] {
  return Array.from({ length: 25 }, (_, i): Point => [center[0] + radius * Math.cos((i * Math.PI) / 12), center[1] + radius * Math.sin((i * Math.PI) / 12)]);
}

function drawBall(pen: Pen, input: OverlayInput): void {
  const { ball } = input.state;
  if (!ball) return;
  const center = input.toCanvas(ball.u_px, ball.v_px);
  pen.line(ring(center, 11 * pen.unit), LAYER_COLORS.ball, { width: 2.25 });
  if (input.detailed) pen.text(`${Math.round(100 * ball.confidence)} %`, [center[0], center[1] - 20 * pen.unit], LAYER_COLORS.ball, 12);
}

function drawRobots(pen: Pen, input: OverlayInput): void {
  for (const robot of input.state.robots) {
    const outline = robot.outline_px.map(([u, v]) => input.toCanvas(u, v));
    const center = input.toCanvas(robot.u_px, robot.v_px);
    const own = robot.team === 'own';
    const color = own ? '#ffffff' : '#ffd9a0';
    pen.line(outline.length > 1 ? outline : ring(center, 12 * pen.unit), color, { closed: true });
    const bottom = outline.reduce((y, point) => Math.max(y, point[1]), center[1]);
    const id = robot.id === null ? '?' : String(robot.id);
    const text = input.detailed ? `${own ? '' : 'opp. '}${id} · ${Math.round(100 * robot.confidence)} %` : id;
    pen.text(text, [center[0], bottom + 11 * pen.unit], color, 12);
  }
}

const UNDECIDED = { text: '', refused: false };

/** The edges of a box of pixels. */
function boxCorners(input: OverlayInput, [left, top, right, bottom]: readonly number[]): Point[] {
  const [l, t, r, b] = [left! - 0.5, top! - 0.5, right! + 0.5, bottom! + 0.5];
  return [input.toCanvas(l, t), input.toCanvas(r, t), input.toCanvas(r, b), input.toCanvas(l, b)];
}

function drawInterest(pen: Pen, input: OverlayInput): void {
  const polygon = input.hello.region_of_interest ?? [];
  const { width_px, height_px } = input.hello.camera;
  const corners: Point[] = polygon.length >= 3 ? polygon.map(([u, v]) => [u, v]) : [[-0.5, -0.5], [width_px - 0.5, -0.5], [width_px - 0.5, height_px - 0.5], [-0.5, height_px - 0.5]];
  pen.line(corners.map(([u, v]) => input.toCanvas(u, v)), LAYER_COLORS.interest, { closed: true, width: 2.25 });
}

function drawRegions(pen: Pen, input: OverlayInput): void {
  for (const region of input.regions?.regions ?? []) {
    const rgb = input.hello.classes[region[4] - 1]?.rgb;
    pen.line(boxCorners(input, region), rgb ? `rgb(${rgb.join(' ')})` : LAYER_COLORS.regions, { closed: true, width: 1.25 });
  }
}

function drawRefusals(pen: Pen, input: OverlayInput): void {
  const color = LAYER_COLORS.refusals;
  for (const region of input.regions?.regions ?? []) {
    const verdict = input.hello.verdicts?.[region[6]] ?? UNDECIDED;
    if (!verdict.refused) continue;
    const corners = boxCorners(input, region);
    pen.line(corners, color, { closed: true });
    pen.text(verdict.text, [(corners[0]![0] + corners[1]![0]) / 2, corners[0]![1] - 9 * pen.unit], color, 11);
  }
  for (const robot of input.state.robots) {
    if (!robot.doubt) continue;
    const [x, y] = input.toCanvas(robot.u_px, robot.v_px);
    pen.line(ring([x, y], 16 * pen.unit), color);
    pen.text(robot.doubt, [x, y - 25 * pen.unit], color, 12);
  }
}
