import { drawLabel } from './canvas_label';
import { cssColor } from './format';
import type { Hello, RobotTrack, State } from './protocol';
import type { Trails } from './trails';
import { fieldLines } from './field_lines';

// Commands are drawn as the path over this time.
const COMMAND_S = 0.4;

export interface FieldMapColors {
  field: string;
  line: string;
  text: string;
  ink: string;
}

/** Draws the field from above, to scale: x to the right, y upwards. `selected`: id of the own robot that is driven. */
export function drawFieldMap(
  context: CanvasRenderingContext2D,
  width: number,
  height: number,
  unit: number,
  hello: Hello,
  state: State | null,
  trails: Trails,
  colors: FieldMapColors,
  selected: number | null,
): void {
  const { field } = hello;
  const scale = fieldScale(hello, width, height);
  const at = (x: number, y: number): [number, number] => [width / 2 + x * scale, height / 2 - y * scale];
  context.clearRect(0, 0, width, height);
  context.fillStyle = colors.field;
  context.fillRect(0, 0, width, height);
  context.strokeStyle = colors.line;
  context.lineWidth = 1.5 * unit;
  for (const line of fieldLines(field)) stroke(context, line.map(([x, y]) => at(x, y)));
  if (!state) return;

  const rgbOf = (team: string, id: number | null) => hello.robots.find((robot) => robot.team === team && (id === null || robot.id === id))?.rgb;
  const ballColor = cssColor(hello.ball?.rgb, '#f28c28');
  for (const [key, trail] of trails.entries()) {
    // Team colors may be dark: halfway to white they show on the field.
    const rgb = rgbOf(key.split(' ')[0] ?? '', null)?.map((value) => (value + 255) / 2);
    context.strokeStyle = key === 'ball' ? ballColor : cssColor(rgb, '#ffffff');
    context.lineWidth = 1.5 * unit;
    stroke(context, trail.map(({ x, y }) => at(x, y)));
  }

  const roles = new Map((state.roles ?? []).map(({ id, role }) => [id, role]));
  for (const track of state.tracks) {
    const own = track.team === 'own';
    if (own) drawCommand(context, track, state, hello, at, unit);
    drawRobot(context, track, cssColor(rgbOf(track.team, track.id), own ? '#4a8cff' : '#ffd23f'), own && track.id === selected);
  }
  const ball = state.ball_track;
  if (ball) {
    const [x, y] = at(ball.x_m, ball.y_m);
    context.beginPath();
    context.arc(x, y, Math.max(4 * unit, (hello.ball?.radius_m ?? 0.02) * scale), 0, 2 * Math.PI);
    context.fillStyle = ballColor;
    context.strokeStyle = '#ffffff';
    context.lineWidth = 1.5 * unit;
    if (!ball.seen) context.globalAlpha = 0.5;
    context.fill();
    context.stroke();
    context.globalAlpha = 1;
  }
  // Over everything, so that a robot nearby hides no name.
  for (const track of state.tracks) {
    const role = track.team === 'own' && track.id !== null ? roles.get(track.id) : undefined;
    const [x, y] = at(track.x_m, track.y_m);
    const half = (sizeOf(hello, track) / 2) * scale;
    if (role === 'goalkeeper' || role === 'attacker') label(role, x, y + half * 1.4 + 9 * unit, 11.5);
  }

  function label(text: string, x: number, y: number, size: number): void {
    context.font = `600 ${size * unit}px system-ui, sans-serif`;
    drawLabel(context, text, x, y, { color: colors.field, width: 3 * unit }, colors.text);
  }

  function drawRobot(target: CanvasRenderingContext2D, track: RobotTrack, color: string, isSelected: boolean): void {
    const half = (sizeOf(hello, track) / 2) * scale;
    const [x, y] = at(track.x_m, track.y_m);
    target.save();
    target.translate(x, y);
    target.rotate(-track.heading_rad);
    target.globalAlpha = track.seen ? 1 : 0.5;
    target.fillStyle = color;
    target.fillRect(-half, -half, 2 * half, 2 * half);
    // The front.
    target.fillStyle = colors.ink;
    target.fillRect(half * 0.7, -half, half * 0.3, 2 * half);
    target.strokeStyle = '#ffffff';
    target.lineWidth = 1.5 * unit;
    target.strokeRect(-half, -half, 2 * half, 2 * half);
    if (isSelected) {
      target.strokeStyle = '#ffffff';
      target.lineWidth = 2.5 * unit;
      target.strokeRect(-half * 1.6, -half * 1.6, half * 3.2, half * 3.2);
    }
    target.restore();
    context.font = `700 ${Math.max(11 * unit, half * 1.1)}px system-ui, sans-serif`;
    drawLabel(context, track.id === null ? '?' : String(track.id), x, y, { color: 'rgb(0 0 0 / 0.7)', width: 3 * unit }, '#ffffff');
  }
}

/** Pixels per meter; the goals are visible completely. */
function fieldScale(hello: Hello, width: number, height: number): number {
  const { field } = hello;
  const edge = 0.06;
  return Math.min(width / (field.length_m + 2 * field.goal_depth_m + edge), height / (field.width_m + edge));
}

/** Width of the map divided by its height. */
export function fieldAspect(hello: Hello | null): number {
  if (!hello) return 2.56 / 1.86;
  const { field } = hello;
  return (field.length_m + 2 * field.goal_depth_m + 0.06) / (field.width_m + 0.06);
}

function sizeOf(hello: Hello, track: RobotTrack): number {
  return hello.robots.find((robot) => robot.team === track.team)?.length_m ?? 0.075;
}

/** The path that a robot drives with its present command. Wheels stand as far apart as the robot is wide. */
function drawCommand(context: CanvasRenderingContext2D, track: RobotTrack, state: State, hello: Hello, at: (x: number, y: number) => [number, number], unit: number): void {
  const command = state.commands.find((candidate) => candidate.id === track.id);
  if (!command || state.stop) return;
  const v = (command.left_mps + command.right_mps) / 2;
  const w = (command.right_mps - command.left_mps) / sizeOf(hello, track);
  if (Math.abs(v) < 0.01 && Math.abs(w) < 0.1) return;
  let { x_m: x, y_m: y, heading_rad: heading } = track.action;
  const points: [number, number][] = [at(x, y)];
  const steps = 12;
  for (let i = 0; i < steps; i += 1) {
    const dt = COMMAND_S / steps;
    x += v * dt * Math.cos(heading + (w * dt) / 2);
    y += v * dt * Math.sin(heading + (w * dt) / 2);
    heading += w * dt;
    points.push(at(x, y));
  }
  context.strokeStyle = '#ffffff';
  context.lineWidth = 2 * unit;
  stroke(context, points);
}

function stroke(context: CanvasRenderingContext2D, points: [number, number][]): void {
  if (points.length < 2) return;
  context.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.stroke();
}
