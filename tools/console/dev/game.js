// Robots that follow curves, instead of a game: enough to look at every part of the page.
const FIELD = { length_m: 2.2, width_m: 1.8, goal_width_m: 0.4, goal_depth_m: 0.15, margin_m: 0.1, center_circle_m: 0.25 };
const CAMERA = { width_px: 640, height_px: 480, rate_hz: 60, description: 'simulated camera, RGB24 640 x 480' };
export const BLUE = [40, 90, 220];
export const YELLOW = [240, 200, 40];
export const ORANGE = [240, 120, 30];
export const PATCHES = [[220, 40, 40], [40, 180, 70], [210, 60, 190], [40, 190, 210], [130, 70, 200]];
const SCALE = 240; // pixels per meter

/** A camera that looks straight down, with barrel distortion. */
export function project(x, y) {
  const r2 = x * x + y * y;
  const k = SCALE * (1 - 0.035 * r2);
  return [319.5 + k * x, 239.5 - k * y];
}

export class Game {
  number = 0;
  time = 0;
  halt = new Set();
  stops = 0;
  events = [{ type: 'event', time_s: Date.now() / 1000, level: 'info', text: 'simulated game of the page\'s rehearsal server' }];
  score = { own: 1, opponent: 0 };
  driven = null;
  lost = []; // devices that cannot be opened
  adaptation = 'follow';
  began = Date.now() / 1000;
  moved = 0; // seconds of motion
  robots = ['own', 'opponent'].flatMap((team, t) => PATCHES.map((rgb, id) => ({ team, id, rgb, phase: id * 1.3 + t * 2.1, x: 0, y: 0, heading: 0, v: 0, w: 0 })));
  ball = { x: 0, y: 0, vx: 0, vy: 0 };

  constructor() {
    this.step(0.001);
  }

  log(level, text) {
    this.events.push({ type: 'event', time_s: Date.now() / 1000, level, text });
    this.events = this.events.slice(-100);
    this.onevent?.(this.events.at(-1));
  }

  stop(client) {
    if (!this.halt.has('console')) this.log('warning', `robots halted: Stop was pressed on screen ${client}`);
    this.halt.add('console');
    this.stops += 1;
  }

  /** Returns why not; undefined: started. */
  start(stopNumber) {
    if (stopNumber !== this.stops) return `it answers stop ${stopNumber}, but stop ${this.stops} has come since: see why the robots are stopped, then start again`;
    this.halt.delete('console');
    this.log('info', 'robots may move');
  }

  drive(id, speed, turn) {
    this.driven = { id, speed, turn, until: this.time + 0.3, pose: this.driven?.id === id ? this.driven.pose : null };
  }

  step(dt) {
    this.number += 1;
    this.time += dt;
    const moving = this.halt.size === 0;
    if (moving) this.moved += dt;
    const t = this.moved;
    for (const robot of this.robots) {
      if (robot.team === 'own' && this.driven?.id === robot.id) {
        // In the setup, only the robot that is driven moves.
        const active = [...this.halt].every((word) => word === 'setup') && this.time < this.driven.until;
        robot.v = active ? this.driven.speed : 0;
        robot.w = active ? this.driven.turn : 0;
        robot.heading += robot.w * dt;
        robot.x = Math.max(-1, Math.min(1, robot.x + robot.v * Math.cos(robot.heading) * dt));
        robot.y = Math.max(-0.8, Math.min(0.8, robot.y + robot.v * Math.sin(robot.heading) * dt));
        continue;
      }
      const a = 0.45 + 0.06 * robot.id;
      const place = (s) => [0.95 * Math.sin(a * s + robot.phase), 0.75 * Math.sin(1.37 * a * s + 2 * robot.phase)];
      const [x, y] = place(t);
      const [nx, ny] = place(t + 0.02);
      const heading = Math.atan2(ny - y, nx - x);
      const turn = Math.atan2(Math.sin(heading - robot.heading), Math.cos(heading - robot.heading));
      Object.assign(robot, { x, y, heading, v: moving ? Math.hypot(nx - x, ny - y) / 0.02 : 0, w: moving && dt > 0.002 ? turn / dt : 0 });
    }
    const place = (s) => [0.9 * Math.sin(0.9 * s), 0.7 * Math.cos(0.61 * s)];
    const [x, y] = place(t);
    const [nx, ny] = place(t + 0.01);
    this.ball = { x, y, vx: moving ? (nx - x) * 100 : 0, vy: moving ? (ny - y) * 100 : 0 };
  }

  hello() {
    const [step, columns, rows] = [0.1, 27, 21];
    const uv = [];
    for (let row = 0; row < rows; row += 1) for (let column = 0; column < columns; column += 1) uv.push(...project(-1.3 + column * step, -1 + row * step));
    return {
      type: 'hello', board: 'rehearsal', venue: 'venue.toml', team: 'team.toml', time_s: Date.now() / 1000, field: FIELD, camera: CAMERA,
      projection: { x_min_m: -1.3, y_min_m: -1, step_m: step, columns, rows, planes: [{ height_m: 0, uv_px: uv }] },
      robots: this.robots.map(({ team, id }) => ({ team, id, color: team === 'own' ? 'blue' : 'yellow', rgb: team === 'own' ? BLUE : YELLOW, length_m: 0.075, width_m: 0.075, height_m: 0.05 })),
      classes: [{ name: 'orange', rgb: ORANGE }], ball: { color: 'orange', rgb: ORANGE, radius_m: 0.021 }, stop_after_s: 0.1, max_speed_mps: 1, max_turn_radps: 8,
    };
  }

  state() {
    const corners = (robot) => [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([f, l]) => {
      const [c, s] = [Math.cos(robot.heading) * 0.0375, Math.sin(robot.heading) * 0.0375];
      return project(robot.x + c * f - s * l, robot.y + s * f + c * l);
    });
    const at = project(this.ball.x, this.ball.y);
    return {
      type: 'state', number: this.number, frame: this.number, captured_s: this.began + this.time, latency_ms: 10.8 + Math.sin(this.number) * 0.4,
      ball: { x_m: this.ball.x, y_m: this.ball.y, u_px: at[0], v_px: at[1], confidence: 0.98 },
      robots: this.robots.map((robot) => {
        const [u, v] = project(robot.x, robot.y);
        return { team: robot.team, id: robot.id === 3 && robot.team === 'opponent' ? null : robot.id, x_m: robot.x, y_m: robot.y, heading_rad: robot.heading, u_px: u, v_px: v, confidence: 0.99, outline_px: corners(robot) };
      }),
      truth: {
        ball: { x_m: this.ball.x + 0.0004, y_m: this.ball.y },
        robots: this.robots.map(({ team, id, x, y, heading }) => ({ team, id, x_m: x, y_m: y - 0.0002, heading_rad: heading + 0.002 })),
      },
      ball_track: { seen: true, x_m: this.ball.x, y_m: this.ball.y, vx_mps: this.ball.vx, vy_mps: this.ball.vy, sigma_m: 0.002, action: { x_m: this.ball.x + 0.05 * this.ball.vx, y_m: this.ball.y + 0.05 * this.ball.vy }, confidence: 0.98 },
      tracks: this.robots.map((robot) => ({
        team: robot.team, id: robot.id, seen: robot.id !== 4 || robot.team === 'own', x_m: robot.x, y_m: robot.y, heading_rad: robot.heading, speed_mps: robot.v, turn_radps: robot.w,
        sigma_x_m: 0.004, sigma_y_m: 0.006, covariance_xy_m2: 1e-5, sigma_heading_rad: 0.05, confidence: 0.97,
        action: { x_m: robot.x + 0.05 * robot.v * Math.cos(robot.heading), y_m: robot.y + 0.05 * robot.v * Math.sin(robot.heading), heading_rad: robot.heading + 0.05 * robot.w },
      })),
      commands: this.robots.filter((robot) => robot.team === 'own').map((robot) => ({ id: robot.id, left_mps: robot.v - robot.w * 0.0375, right_mps: robot.v + robot.w * 0.0375, source: this.driven?.id === robot.id ? 'console' : 'play' })),
      stop: this.halt.size > 0, halt: [...this.halt], stop_number: this.stops, waits_for_start: this.halt.has('console'), referee: { phase: 'no referee' }, score: this.score, brightness: 1.02, stages_ms: [0.31, 0.12, 0.08, 0.05, 0.01],
      roles: [{ id: 0, role: 'goalkeeper' }, { id: 2, role: 'attacker' }, { id: 1, role: 'supporter' }, { id: 3, role: 'supporter' }, { id: 4, role: 'supporter' }],
      play: [
        { id: 0, skill: 'keep', why: 'between ball and goal, on the line', target: { x_m: -1.05, y_m: 0.3 * this.ball.y } },
        { id: 2, job: 'attack', skill: 'strike', why: 'first at a usable contact', target: { x_m: this.ball.x - 0.06, y_m: this.ball.y, heading_rad: 0 }, time_s: 0.62 },
        { id: 1, job: 'cover', skill: 'cover', why: 'between ball and own goal', target: { x_m: -0.5, y_m: 0.5 * this.ball.y }, time_s: 0.9 },
        { id: 3, job: 'support', skill: 'support', why: 'for rebounds', target: { x_m: 0.4, y_m: -0.4 }, time_s: 1.4 },
        { id: 4, job: 'back up', skill: 'back up', why: 'behind the attacker', target: { x_m: -0.2, y_m: 0.4 }, time_s: 1.1 },
      ],
    };
  }

  status(clients) {
    const summary = (count) => ({
      count, p50_ms: 10.88, p99_ms: 11.4, p999_ms: 11.9, max_ms: 13.2,
      bins: [[10.2, 10.4, 0.02], [10.4, 10.6, 0.1], [10.6, 10.8, 0.25], [10.8, 11, 0.4], [11, 11.2, 0.15], [11.2, 11.6, 0.07], [11.6, 12, 0.009], [12.8, 13.2, 0.001]].map(([from, to, share]) => [from, to, Math.max(1, Math.round(count * share))]),
    });
    return {
      type: 'status', time_s: Date.now() / 1000, elapsed_s: this.time, rate_hz: 60, latency: { start: summary(this.number), minute: summary(Math.min(3600, this.number)) },
      deadline_ms: 16.67, deadlines_missed: 0, frames: this.number, frames_lost: 0, overloads: 0, faults: 0, cpu_percent: 18, temperature_c: null, memory_mb: 46,
      recording: { on: true, file: 'touchline-0044-20261128-173005.mcap', duration_s: this.time, bytes: 2.7e6 * this.time, frames: this.number, pictures: this.number, lost_frames: 0, lost_pictures: 12, ended: '' },
      lost: this.lost, radio: { packets: this.number, dropped: 0, refused: 0, stop_packets: 5 }, adaptation: this.adaptation, clients, halt: [...this.halt], stop_number: this.stops, waits_for_start: this.halt.has('console'),
      telemetry: [0, 1, 2, 3, 4].map((id) => ({ id, battery_v: 7.9 - id * 0.12, battery_low: id === 4, link_percent: 99 - id, age_s: 0.2 + 0.1 * id })),
    };
  }
}
