// The picture of the simulated game, as JPEG behind the protocol's header.
import jpeg from 'jpeg-js';
import { ORANGE, project } from './game.js';

const [width, height] = [640, 480];
const background = makeBackground();

function makeBackground() {
  const pixels = Buffer.alloc(width * height * 4, 255);
  for (let i = 0; i < width * height; i += 1) pixels.set([52, 58, 55], 4 * i);
  const line = (from, to) => {
    for (let i = 0; i <= 800; i += 1) square(pixels, ...project(from[0] + ((to[0] - from[0]) * i) / 800, from[1] + ((to[1] - from[1]) * i) / 800), 1, [225, 228, 224]);
  };
  line([-1.1, -0.9], [1.1, -0.9]);
  line([1.1, -0.9], [1.1, 0.9]);
  line([1.1, 0.9], [-1.1, 0.9]);
  line([-1.1, 0.9], [-1.1, -0.9]);
  line([0, -0.9], [0, 0.9]);
  return pixels;
}

function square(pixels, u, v, half, rgb) {
  for (let y = Math.round(v - half); y <= v + half; y += 1) {
    for (let x = Math.round(u - half); x <= u + half; x += 1) {
      if (x >= 0 && y >= 0 && x < width && y < height) pixels.set(rgb, 4 * (y * width + x));
    }
  }
}

export function makePicture(game) {
  const pixels = Buffer.from(background);
  const state = game.state();
  state.robots.forEach((robot, i) => {
    const [c, s] = [Math.cos(robot.heading_rad), Math.sin(robot.heading_rad)];
    square(pixels, robot.u_px, robot.v_px, 8, [20, 20, 20]);
    square(pixels, robot.u_px + 4 * c, robot.v_px - 4 * s, 3, robot.team === 'own' ? [40, 90, 220] : [240, 200, 40]);
    square(pixels, robot.u_px - 4 * c, robot.v_px + 4 * s, 3, game.robots[i].rgb);
  });
  square(pixels, state.ball.u_px, state.ball.v_px, 4, ORANGE);
  const { data } = jpeg.encode({ data: pixels, width, height }, 80);
  const header = Buffer.alloc(32);
  header.writeUInt32LE(0x43504c54, 0);
  header.writeUInt8(1, 4);
  header.writeUInt8(1, 5);
  header.writeUInt16LE(width, 6);
  header.writeUInt16LE(height, 8);
  header.writeUInt16LE(width, 10);
  header.writeBigUInt64LE(BigInt(state.number), 16);
  header.writeBigInt64LE(BigInt(Math.round(state.captured_s * 1e6)), 24);
  return Buffer.concat([header, data]);
}
