// A setup program for the rehearsal server: believable answers without calibration. The page cannot tell the difference, except that
// every field is found after two seconds.
import { BLUE, ORANGE, PATCHES, YELLOW, project } from './game.js';
import { makePicture } from './picture.js';
import { encodePng } from './png.js';

const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const CORNERS = [[-1.1, -0.9], [1.1, -0.9], [1.1, 0.9], [-1.1, 0.9]];
const unknown = { level: 'none', text: '' };
const NAMES = ['red', 'green', 'magenta', 'cyan', 'violet'];
const COLORS = [['orange', ORANGE], ['blue', BLUE], ['yellow', YELLOW], ...NAMES.map((name, i) => [name, PATCHES[i]])];

const patch = (role, x_m, y_m) => ({ role, outline: 'square', x_m, y_m, length_m: 0.034, width_m: 0.034, turn_rad: 0 });
const LAYOUTS = [
  { name: 'two-squares', patches: [patch('team', 0.0175, 0.0175), patch('identification', -0.0175, -0.0175)] },
  { name: 'vsss-bar', patches: [{ ...patch('team', -0.019, 0), length_m: 0.03, width_m: 0.07 }, patch('identification', 0.0175, 0.0175), patch('identification', 0.0175, -0.0175)] },
  { name: 'ssl-butterfly', patches: [[0, 0], [0.04, 0.03], [0.04, -0.03], [-0.04, 0.03], [-0.04, -0.03]].map(([x, y], i) => ({ ...patch(i ? 'identification' : 'team', x, y), outline: 'circle' })) },
];

/** What the robots and the ball need, and what of it is not known yet. */
function neededColors({ robots: { own, opponent, ball }, colors: { names } }) {
  const needed = [...new Set([own.color, opponent.color, ball, ...[...own.robots, ...opponent.robots].flatMap(({ colors }) => colors)])];
  return { needed, wanted: needed.filter((name) => !names.some((known) => known.name === name)) };
}

function measuredDrive() {
  const value = (name, value, sigma, unit, known = true) => ({ name, value, sigma, unit, known });
  const key = (key, file, now, measured, unit, differs) => ({ key, file, now, measured, unit, differs, written: false });
  return {
    robot: 3,
    wiring: 'the wheels are exchanged: the command for the left wheel drives the right one; exchange the motors',
    wiring_ok: false,
    values: [value('delay', 62.3, 0.4, 'ms'), value('gain of the left wheel', 1.0842, 0.0031, ''), value('dead zone', 4.2, 0.8, 'mm/s'), value('wheel base', null, null, 'mm', false)],
    keys: [key('radio.delay_s', 'board.toml', '0.02', '0.0623', 's', true), key('own.robot[3].wheel_gain', 'team.toml', '[1, 1]', '[1.0842, 0.9713]', '', true), key('tracking.robot.wheel_lag_s', 'team.toml', '0.08', '0.0803', 's', false)],
  };
}

function fresh() {
  const team = (color) => ({ layout: 'two-squares', color, robots: NAMES.map((name, id) => ({ id, colors: [color === 'yellow' && id === 3 ? NAMES[2] : name] })) });
  return {
    camera: {
      done: false, quality: unknown, notes: [],
      values: { backend: 'v4l2', device: '/dev/v4l/by-id/usb-Rehearsal_Camera-video-index0', format: 'rgb24', width_px: 640, height_px: 480, rate_hz: 60, exposure_us: 12000, gain: 0, white_balance_k: 4600, power_line: 'leave' },
    },
    field: {
      done: false, quality: unknown, notes: [], values: { length_m: 2.2, width_m: 1.8 }, camera_height_m: null, corners_px: null,
      presets: [{ name: 'mirosot-middle', title: 'FIRA MiroSot middle league', length_m: 2.2, width_m: 1.8 }, { name: 'vsss', title: 'IEEE very small size', length_m: 1.5, width_m: 1.3 }, { name: 'ssl-b', title: 'RoboCup small size, division B', length_m: 9, width_m: 6 }],
    },
    light: { done: false, quality: unknown, notes: [], surface: null },
    colors: { done: false, quality: unknown, notes: [], names: [], wanted: COLORS.map(([name]) => name), pictures: [], clicks: [] },
    robots: { done: false, quality: unknown, notes: [], layouts: LAYOUTS, own: team('blue'), opponent: team('yellow'), ball: 'orange', ball_radius_m: 0.02135, problems: [], similar: [] },
    radio: { done: false, quality: { level: 'ok', text: '2400 packets sent, none lost' }, notes: [], values: { backend: 'serial', device: '/dev/serial/by-id/usb-Rehearsal_Radio-if00-port0', baud: 115200 }, devices: ['/dev/ttyUSB0', '/dev/ttyAMA0'], drive: measuredDrive() },
  };
}

export class Setup {
  saved = fresh();
  steps = fresh();
  open = false;
  busy = null;
  canceled = false;
  error = null;
  trying = false;
  past = []; // {name, steps}
  future = [];
  pictures = new Map();
  nextPicture = 1;
  source = 'saved';

  /** `tell(message)` and `send(kind, id, content)` reach every client that watches. */
  constructor(game, tell, send) {
    Object.assign(this, { game, tell, send });
  }

  state() {
    this.describeRobots();
    const { open, busy, steps, error, trying } = this;
    return {
      type: 'setup',
      state: {
        open, board: '/etc/touchline/board.toml', busy, steps, error, trying, preview: { source: this.source, ok: true, error: '' }, undo: this.past.map(({ name }) => name), redo: this.future.map(({ name }) => name),
        changed_files: this.past.length ? ['board.toml', 'venue.toml'] : [],
      },
    };
  }

  show() {
    this.tell(this.state());
  }

  picture(width, height, pixelAt) {
    const id = this.nextPicture++;
    this.pictures.set(id, encodePng(width, height, pixelAt));
    this.send(id, this.pictures.get(id));
    return id;
  }

  change(name, step, values) {
    this.past.push({ name, steps: structuredClone(this.steps) });
    this.future = [];
    Object.assign(this.steps[step], values);
  }

  async work(command, text, seconds) {
    this.canceled = false;
    for (let i = 0; i < 10; i += 1) {
      this.busy = { command, text, progress: i / 10 };
      this.show();
      await wait(seconds * 100);
      if (this.canceled) break;
    }
    this.busy = null;
    if (this.canceled) throw new Error('canceled; nothing was changed');
  }

  async run(message) {
    const { command } = message;
    if (this.busy && !['cancel', 'camera.quality'].includes(command)) throw new Error(`busy: ${this.busy.text}`);
    if (!this.open && !['begin', 'import', 'export'].includes(command)) throw new Error('nothing is being set up: begin first');
    const handler = handlers[command];
    if (!handler) throw new Error(`unknown command: ${command}`);
    try {
      return await handler(this, message);
    } finally {
      if (!['differences', 'export', 'camera.quality', 'drive'].includes(command)) this.show();
    }
  }

  describeRobots() {
    const { robots } = this.steps;
    robots.problems = [];
    for (const team of ['own', 'opponent']) {
      for (const [i, a] of robots[team].robots.entries()) {
        for (const b of robots[team].robots.slice(i + 1)) {
          if (a.colors.join() === b.colors.join()) robots.problems.push({ text: `${team} robots ${a.id} and ${b.id} have the same colors`, robots: [{ team, id: a.id }, { team, id: b.id }] });
        }
      }
    }
    robots.similar = [{ a: { team: 'own', id: 2 }, b: { team: 'own', id: 4 }, levels: 14 }, { a: { team: 'own', id: 0 }, b: { team: 'own', id: 1 }, levels: 88 }];
    robots.quality = robots.problems.length ? { level: 'bad', text: robots.problems[0].text } : { level: 'warning', text: '10 robots; own 2 and 4 look alike' };
  }

  fieldFound(name, corners_px, message) {
    const error_map = this.picture(220, 180, (x, y) => {
      const error = Math.min(1, Math.hypot(x - 110, y - 90) / 160 + 0.06 * Math.sin(x / 9) * Math.cos(y / 11));
      return [Math.round(255 * error), Math.round(200 * (1 - error)), Math.round(80 + 100 * (1 - error)), 255];
    });
    const line = (a, b) => Array.from({ length: 30 }, (_, i) => project(a[0] + ((b[0] - a[0]) * i) / 29, a[1] + ((b[1] - a[1]) * i) / 29));
    this.change(name, 'field', {
      done: true, values: sizeOf(message), camera_height_m: message.camera_height_m || 2.31, camera_height_sigma_m: message.camera_height_m ? 0 : 0.06, corners_px,
      overlay: [...CORNERS.map((corner, i) => line(corner, CORNERS[(i + 1) % 4])), line([0, -0.9], [0, 0.9])], rms_mm: 0.29, p95_mm: 0.54, max_mm: 0.81, top_sigma_mm: 2.1, error_map,
      quality: { level: 'ok', text: '0.3 mm on the floor, 2.1 mm at a robot\'s top in a corner' }, notes: message.camera_height_m ? [] : [{ level: 'warning', text: 'Measure the height of the lens above the floor: without it, a robot\'s top in a corner may be 2.1 mm off.' }],
      report: '975 points of border and markings: 0.06 px RMS, p95 0.14, max 0.19\nmarkings: 8 of 12 used, 4 not visible',
    });
  }

  catch(name, more) {
    const spots = more.map(([x, y]) => [Math.round(x), Math.round(y)]);
    for (const robot of this.game.robots) {
      const [u, v] = project(robot.x, robot.y);
      if (NAMES[robot.id] === name || (name === 'blue' && robot.team === 'own') || (name === 'yellow' && robot.team !== 'own')) spots.push([u, v]);
    }
    return this.picture(640, 480, (x, y) => (spots.some(([u, v]) => Math.abs(x - u) < 5 && Math.abs(y - v) < 5) ? [255, 0, 255, 255] : [0, 0, 0, 0]));
  }

  /** The camera's picture of now, for clicks. */
  take() {
    const id = this.nextPicture++;
    this.pictures.set(id, makePicture(this.game).subarray(32));
    this.send(id, this.pictures.get(id));
    return id;
  }

  measure() {
    const { exposure_us } = this.steps.camera.values;
    const exposure = exposure_us || 4000;
    const brightness = Math.min(1.3, exposure / 9000);
    const bins = (center) => Array.from({ length: 32 }, (_, i) => 0.05 * Math.exp(-(((i - 31 * Math.min(1, center * brightness)) / 4) ** 2)) + (i === 31 ? 0.03 * Math.max(0, brightness - 0.7) : 0) + 0.001);
    const clipped = Math.max(0, 0.12 * (brightness - 0.8));
    const blur_px = (exposure * 1.5e-6) / 0.0042;
    return {
      histogram: [0.55, 0.5, 0.42].map(bins), clipped: [clipped, 0.6 * clipped, 0.2 * clipped], black: [0.004, 0.005, 0.01], focus: 0.41 + 0.03 * Math.sin(Date.now() / 3000), blur_px, exposure_limit_us: 2800,
      quality: clipped > 0.02 ? { level: 'warning', text: `${(100 * clipped).toFixed(1)} % of the pixels are clipped` } : blur_px > 1 ? { level: 'warning', text: `a fast robot blurs by ${blur_px.toFixed(1)} px` } : { level: 'ok', text: 'sharp, neither too bright nor too dark' },
    };
  }
}

const PRESETS = Object.fromEntries(fresh().field.presets.map((preset) => [preset.name, preset]));
const sizeOf = ({ preset, length_m, width_m }) => (preset ? { length_m: PRESETS[preset].length_m, width_m: PRESETS[preset].width_m } : { length_m, width_m });

const lightPicture = (setup, even) => setup.picture(320, 240, (x, y) => {
  const value = even ? 170 : 110 + 0.4 * x - 0.1 * y;
  return [value, value, value * 0.97, 255].map(Math.round);
});

const handlers = {
  begin(setup) {
    setup.open = true;
  },
  use(setup, { source }) {
    setup.source = source;
    if (source === 'draft') setup.game.halt.add('setup');
    else setup.game.halt.delete('setup');
  },
  discard(setup) {
    Object.assign(setup, { open: false, steps: structuredClone(setup.saved), past: [], future: [], trying: false });
    if (setup.source === 'draft') setup.game.halt.add('console');
    handlers.use(setup, { source: 'saved' });
  },
  undo(setup) {
    const last = setup.past.pop();
    if (!last) throw new Error('there is nothing to undo');
    setup.future.push({ name: last.name, steps: setup.steps });
    setup.steps = last.steps;
  },
  redo(setup) {
    const next = setup.future.pop();
    if (!next) throw new Error('there is nothing to redo');
    setup.past.push({ name: next.name, steps: setup.steps });
    setup.steps = next.steps;
  },
  cancel(setup) {
    setup.canceled = true;
  },
  differences: (setup) => ({
    files: setup.past.length
      ? [
          { name: 'board.toml', diff: '--- board.toml\n+++ board.toml (new)\n@@ -9,3 +9,3 @@\n rate_hz = 60.0\n-exposure_us = 12000\n+exposure_us = 2000\n gain = 1.0' },
          { name: 'venue.toml', diff: `--- venue.toml\n+++ venue.toml (new)\n@@ -1,2 +1,4 @@\n version = 1\n+# ${setup.past.length} changes\n+[camera_model]\n+kind = "full"` },
          { name: 'venue-light.png', diff: '' },
        ]
      : [],
    conflicts: [],
    problems: '',
  }),
  save(setup) {
    setup.saved = structuredClone(setup.steps);
    handlers.discard(setup);
    setup.game.log('info', 'setup saved: board.toml, venue.toml');
  },
  try(setup, { on }) {
    setup.trying = on;
    if (on) setup.game.halt.clear();
    else setup.game.halt.add('setup');
  },
  drive() {},
  export: (setup) => ({ name: 'touchline-setup.json', text: JSON.stringify(setup.steps) }),
  import(setup, { part, parts, text }) {
    setup.incoming = part === 0 ? [] : setup.incoming;
    setup.incoming.push(text);
    if (part < parts - 1) return;
    let steps;
    try {
      steps = JSON.parse(setup.incoming.join(''));
    } catch {
      throw new Error('this file is not a setup of Touchline');
    }
    setup.open = true;
    setup.change('import', 'camera', {});
    setup.steps = steps;
  },
  set(setup, { key, value, continues }) {
    const [section, name] = key.split('.');
    if (name === 'exposure_us' && (value < 0 || value > 1000000)) throw new Error(`board.toml: ${key} = ${value} is out of range: 0 to 1000000`);
    const former = continues && setup.past.at(-1)?.name.startsWith(`${key} `) ? setup.past.pop().steps : structuredClone(setup.steps);
    setup.change(`${key} = ${value}`, section, { values: { ...setup.steps[section].values, [name]: value } });
    setup.past.at(-1).steps = former;
  },
  'camera.quality'(setup) {
    const measure = setup.measure();
    Object.assign(setup.steps.camera, measure);
    return measure;
  },
  confirm(setup, { step }) {
    if (step === 'robots' && setup.steps.robots.quality.level === 'bad') throw new Error(setup.steps.robots.quality.text);
    setup.change(`${step} confirmed`, step, { done: true });
  },
  async 'field.find'(setup, message) {
    await setup.work('field.find', 'Looking for the border of the field', 2);
    const { length_m, width_m } = sizeOf(message);
    if (length_m === width_m) throw new Error('the field looks the same when rotated by 90 degrees: give the corners');
    setup.fieldFound('field found', CORNERS.map(([x, y]) => project(x, y)), message);
  },
  async 'field.corners'(setup, message) {
    await setup.work('field.corners', 'Fitting the camera model', 0.4);
    setup.fieldFound('corners moved', message.corners_px, message);
  },
  async 'light.measure'(setup, { surface }) {
    await setup.work('light.measure', 'Measuring the light', 1);
    setup.change('light measured', 'light', { done: true, surface, before: lightPicture(setup, false), after: lightPicture(setup, true), least: [0.71, 0.7, 0.72], most: [1.24, 1.25, 1.24], quality: { level: 'ok', text: '70 to 125 % of the middle, evened out' } });
  },
  'colors.picture'(setup) {
    setup.change('picture taken', 'colors', { pictures: [...setup.steps.colors.pictures, setup.take()] });
  },
  async 'colors.find'(setup) {
    await setup.work('colors.find', 'Looking for the patches of the robots', 2);
    const names = COLORS.filter(([name]) => name !== 'yellow').map(([name, shown_rgb]) => ({ name, shown_rgb, boxes: [] }));
    setup.change('colors found', 'colors', {
      done: true, names, wanted: ['yellow'], pictures: [setup.take()], confusion: { names: names.map(({ name }) => name), rows: names.map((_, i) => [0.004, ...names.map((__, j) => (i === j ? 0.97 : i === 0 && j === 2 ? 0.06 : 0))]) },
      margins: [{ a: 'orange', b: 'red', levels: 9 }, { a: 'magenta', b: 'violet', levels: 14 }], self_check: '8 of 10 robots and the ball are recognized in the picture of this step.',
      quality: { level: 'warning', text: '7 of 8 colors found; orange and red are hard to tell apart' }, advice: ['Click on a yellow patch: yellow was not found.', 'Exchange the red paint of robot 0: it is only 9 levels from orange. A darker red would do.'],
    });
  },
  'colors.click'(setup, { name, u_px, v_px }) {
    const { names, wanted, clicks, pictures, quality } = setup.steps.colors;
    const known = names.some((color) => color.name === name) ? names : [...names, { name, shown_rgb: COLORS.find(([candidate]) => candidate === name)?.[1], boxes: [] }];
    const rest = wanted.filter((candidate) => candidate !== name);
    setup.change(`${name}: click`, 'colors', {
      names: known, wanted: rest, clicks: [...clicks, { name, u_px, v_px, picture: pictures.at(-1), used: true }], done: true, mask: setup.catch(name, [[u_px, v_px]]), quality: rest.length ? quality : { level: 'ok', text: '8 of 8 colors found' },
      advice: setup.steps.colors.advice?.filter((text) => !text.includes(`${name} was not found`)) ?? [],
    });
  },
  'colors.remove'(setup, { click }) {
    setup.change('click removed', 'colors', { clicks: setup.steps.colors.clicks.filter((_, i) => i !== click) });
  },
  'robots.set'(setup, { own, opponent, ball, layout }) {
    const { robots } = setup.steps;
    const layouts = layout ? [{ ...layout, own: true }, ...robots.layouts.filter(({ name }) => name !== layout.name)] : robots.layouts;
    const colors = { ball: ball?.color ?? robots.ball, ball_radius_m: ball?.radius_m ?? robots.ball_radius_m };
    setup.change('robots', 'robots', { ...(own ? { own } : {}), ...(opponent ? { opponent } : {}), ...colors, layouts, done: false });
    setup.steps.colors = { ...setup.steps.colors, ...neededColors(setup.steps) };
  },
  'camera.set'(setup, { command: _, type: __, request: ___, ...values }) {
    setup.change(`camera ${values.device}`, 'camera', { done: false, values: { ...setup.steps.camera.values, ...values } });
    setup.game.lost = [];
  },
  'radio.write'(setup, { key }) {
    const { drive } = setup.steps.radio;
    setup.change(`measured ${key}`, 'radio', { drive: { ...drive, keys: drive.keys.map((one) => (one.key === key ? { ...one, written: true } : one)) } });
  },
  'radio.set'(setup, { command: _, type: __, request: ___, ...values }) {
    setup.change('radio', 'radio', { values: { ...setup.steps.radio.values, ...values } });
  },
};
