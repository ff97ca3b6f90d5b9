// Decodes the packets of write_packets.cpp with protobufjs, as a receiver in JavaScript does, and compares them with the JSON line of the
// same frame: node read_packets.js PACKETS PROTO
'use strict';

const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const protobuf = require('protobufjs');

const [packets, definitions] = process.argv.slice(2);

// decode() throws a ProtocolError if a required field is absent.
function decoded(packet, file, message) {
  const type = protobuf.loadSync(path.join(definitions, file)).lookupType(message);
  return type.decode(fs.readFileSync(path.join(packets, packet)));
}
function near(actual, expected, tolerance) {
  assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected} within ${tolerance}`);
}

const line = JSON.parse(fs.readFileSync(path.join(packets, 'json'), 'utf8'));
assert.equal(line.schema, 1);

const detection = decoded('ssl_detection', 'ssl_vision.proto', 'SSL_WrapperPacket').detection;
assert.equal(detection.frameNumber, line.frame);
near(detection.tCapture, line.timestamp, 1e-6);
near(detection.tSent, line.sent, 1e-6);
assert.equal(detection.balls.length, 1);
near(detection.balls[0].x, 1000 * line.sightings.ball.x, 0.011);
near(detection.balls[0].y, 1000 * line.sightings.ball.y, 0.011);
near(detection.balls[0].pixelX, line.sightings.ball.u, 1e-3);
const colors = {blue: detection.robotsBlue, yellow: detection.robotsYellow};
for (const [color, robots] of Object.entries(colors)) {
  const expected = line.sightings.robots.filter((robot) => robot.team === color);
  assert.equal(robots.length, expected.length);
  robots.forEach((robot, i) => {
    near(robot.x, 1000 * expected[i].x, 0.011);
    near(robot.y, 1000 * expected[i].y, 0.011);
    assert.equal(Object.hasOwn(robot, 'robotId') ? robot.robotId : null, expected[i].id);
    if (expected[i].theta === null) assert.ok(!Object.hasOwn(robot, 'orientation'));
    else near(robot.orientation, expected[i].theta, 1e-5);
  });
}

const geometry = decoded('ssl_geometry', 'ssl_vision.proto', 'SSL_WrapperPacket').geometry;
assert.equal(geometry.field.fieldLength, 2200);
assert.equal(geometry.field.fieldLines.length, 6);
assert.equal(geometry.calib.length, 1);
assert.equal(geometry.calib[0].cameraId, detection.cameraId);

const tracker = decoded('ssl_tracked', 'ssl_tracked.proto', 'TrackerWrapperPacket');
assert.equal(tracker.sourceName, 'Touchline');
near(tracker.trackedFrame.balls[0].pos.x, line.tracks.ball.x, 1e-5);
near(tracker.trackedFrame.balls[0].vel.y, line.tracks.ball.vy, 1e-4);
const known = line.tracks.robots.filter((robot) => robot.id !== null);
assert.equal(tracker.trackedFrame.robots.length, known.length);
tracker.trackedFrame.robots.forEach((robot, i) => {
  assert.equal(robot.robotId.id, known[i].id);
  assert.equal(robot.robotId.teamColor, known[i].team === 'yellow' ? 1 : 2);
  near(robot.pos.x, known[i].x, 1e-5);
  near(robot.orientation, known[i].theta, 1e-5);
  near(robot.vel.x, known[i].v * Math.cos(known[i].theta), 1e-4);
  near(robot.velAngular, known[i].w, 1e-4);
});

const environment = decoded('firasim', 'firasim.proto', 'fira_message.Environment');
near(environment.frame.ball.x, line.tracks.ball.x, 1e-5);
for (const [color, robots] of Object.entries({blue: environment.frame.robotsBlue, yellow: environment.frame.robotsYellow})) {
  assert.deepEqual(robots.map((robot) => robot.robotId), Object.keys(line.robots[color]).map(Number).sort((a, b) => a - b));
  for (const robot of robots) {
    near(robot.x, line.robots[color][robot.robotId].x, 1e-5);
    near(robot.orientation, line.robots[color][robot.robotId].theta, 1e-5);
  }
}
console.log('protobufjs reads all packets');
