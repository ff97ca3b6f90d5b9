// Reads the files of write_recordings.cpp with @mcap/core and compares them with what the program says they contain, in
// NAME.json beside NAME.mcap: node read_recordings.js FOLDER
'use strict';

const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const {McapIndexedReader, McapStreamReader} = require('@mcap/core');

const folder = process.argv[2];

// Messages of a file that may be cut off, in the order of the file. Checksums are compared.
function streamed(bytes) {
  const reader = new McapStreamReader({validateCrcs: true});
  reader.append(bytes);
  const messages = [], channels = new Map(), schemas = new Map();
  for (let record; (record = reader.nextRecord());) {
    if (record.type === 'Schema') schemas.set(record.id, record);
    if (record.type === 'Channel') channels.set(record.id, record);
    if (record.type === 'Message') messages.push(record);
  }
  return {messages, channels, schemas, isComplete: reader.done()};
}

async function indexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  };
  const reader = await McapIndexedReader.Initialize({readable});
  const messages = [];
  for await (const message of reader.readMessages({validateCrcs: true})) messages.push(message);
  return {reader, messages};
}

function compare(messages, expected, channels) {
  assert.equal(messages.length, expected.length);
  messages.forEach((message, i) => {
    assert.equal(channels.get(message.channelId).topic, expected[i].topic);
    assert.equal(message.sequence, expected[i].sequence);
    assert.equal(message.logTime, BigInt(expected[i].time_ns));
    assert.equal(Buffer.from(message.data).toString('base64'), expected[i].data);
  });
}

async function main() {
  let whole = 0, cut = 0;
  for (const name of fs.readdirSync(folder).filter((file) => file.endsWith('.mcap'))) {
    const bytes = new Uint8Array(fs.readFileSync(path.join(folder, name)));
    const expected = JSON.parse(fs.readFileSync(path.join(folder, name.replace(/mcap$/, 'json')), 'utf8'));
    const stream = streamed(bytes);
    assert.equal(stream.isComplete, expected.is_complete, name);
    compare(stream.messages, expected.messages, stream.channels);
    if (!expected.is_complete) {
      ++cut;
      continue;
    }
    ++whole;
    const {reader, messages} = await indexed(bytes);
    // The index is read in the order of time, which is the order of these files.
    compare(messages, expected.messages, reader.channelsById);
    assert.equal(reader.statistics.messageCount, BigInt(expected.messages.length));
    assert.equal(reader.chunkIndexes.length, expected.chunks);
    for (const channel of reader.channelsById.values()) assert.ok(reader.schemasById.has(channel.schemaId));
  }
  assert.ok(whole > 0 && cut > 0);
  console.log(`@mcap/core reads ${whole} whole and ${cut} cut recordings`);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
