// Foxglove's protocol, read with Foxglove's own client, from the real program, TOUCHLINE_PROGRAM, and its arena, TOUCHLINE_BOARD.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';
import { startProgram } from './console_server.mjs';

const require = createRequire(new URL('../../tools/console/package.json', import.meta.url));
const { FoxgloveClient } = require('@foxglove/ws-protocol');
const { WebSocket } = require('ws');

let server;
before(async () => {
  server = await startProgram(process.env.TOUCHLINE_PROGRAM, process.env.TOUCHLINE_BOARD);
});
after(() => server?.end());

/** Connects and collects what arrives. Waits end after a minute, which no working test reaches. */
async function connect() {
  const socket = new WebSocket(server.url.replace('http', 'ws') + 'foxglove', [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  const client = new FoxgloveClient({ ws: socket });
  const errors = [];
  client.on('error', (error) => errors.push(error));
  client.on('status', ({ message }) => errors.push(new Error(message)));
  const [info, channels] = await Promise.all([new Promise((done) => client.on('serverInfo', done)), new Promise((done) => client.on('advertise', done))]);
  return { client, info, channels, errors };
}

/** Subscribes to topics and returns the first messages for which `isEnough` holds. */
function read({ client, channels }, topics, isEnough) {
  const subscriptions = new Map(topics.map((topic) => [client.subscribe(channels.find((channel) => channel.topic === topic).id), topic]));
  const messages = [];
  return new Promise((resolve, reject) => {
    const limit = setTimeout(() => reject(new Error(`only ${messages.length} messages`)), 60_000);
    client.on('message', ({ subscriptionId, timestamp, data }) => {
      messages.push({ topic: subscriptions.get(subscriptionId), timestamp, content: JSON.parse(new TextDecoder().decode(data)) });
      if (!isEnough(messages)) return;
      clearTimeout(limit);
      resolve(messages);
    });
  });
}

/** Members of the message that the schema does not have, or of another type. */
function misfits(schema, value, path = '') {
  if (schema.type === 'object') return Object.entries(value).flatMap(([name, member]) => (schema.properties[name] ? misfits(schema.properties[name], member, `${path}.${name}`) : [`${path}.${name}`]));
  if (schema.type === 'array') return value.flatMap((element, i) => misfits(schema.items, element, `${path}[${i}]`));
  const fits = schema.type === 'integer' ? Number.isInteger(value) : typeof value === schema.type;
  return fits ? [] : [path];
}

test('picture, annotations and scene are those of the game, and fit their schemas', async () => {
  const connection = await connect();
  assert.deepEqual(connection.info.capabilities, []);
  const topics = ['/camera/picture', '/camera/annotations', '/field/scene'];
  const messages = await read(connection, topics, (all) => topics.every((topic) => all.filter((message) => message.topic === topic).length >= 5));
  for (const { topic, content } of messages) {
    const schema = JSON.parse(connection.channels.find((channel) => channel.topic === topic).schema);
    assert.deepEqual(misfits(schema, content), [], topic);
  }
  const newest = (topic) => messages.filter((message) => message.topic === topic).at(-1);
  const jpeg = Buffer.from(newest('/camera/picture').content.data, 'base64');
  const { width, height } = require('jpeg-js').decode(jpeg);
  assert.deepEqual([width, height], [640, 480]);
  const { points, texts } = newest('/camera/annotations').content;
  assert.ok(points.length >= 8 && texts.length >= 8, `${points.length} outlines`);
  assert.ok(texts.some(({ text }) => text === 'own 1'), JSON.stringify(texts));
  for (const outline of points) {
    assert.ok(outline.points.length === 4 && outline.points.every(({ x, y }) => x > 0 && x < width && y > 0 && y < height));
  }
  const game = newest('/field/scene').content.entities.find(({ id }) => id === 'game');
  assert.ok(game.cubes.length >= 8, `${game.cubes.length} robots`);
  assert.ok(game.cubes.every(({ pose }) => Math.abs(pose.position.x) < 1.3 && Math.abs(pose.position.y) < 1.1));
  assert.ok(messages.some(({ content }) => content.entities?.some(({ id, lines }) => id === 'lines' && lines.length >= 2)));
  // Every picture has the annotations of its frame.
  const pictures = messages.filter(({ topic }) => topic === '/camera/picture');
  for (const picture of pictures) assert.ok(messages.some(({ topic, timestamp }) => topic === '/camera/annotations' && timestamp === picture.timestamp));
  assert.deepEqual(connection.errors, []);
  connection.client.close();
});

test('the state is plain JSON', async () => {
  const connection = await connect();
  const messages = await read(connection, ['/state'], (all) => all.length >= 5);
  const { content, timestamp } = messages.at(-1);
  assert.equal(content.type, 'state');
  assert.ok(content.tracks.length >= 8);
  assert.ok(Math.abs(Number(timestamp) / 1e9 - content.captured_s) < 1e-3);
  connection.client.close();
});
