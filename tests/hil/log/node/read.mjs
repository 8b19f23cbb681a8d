// Reads logs with the libraries that web viewers use and prints what it found as JSON.
//
//   node read.mjs stream|indexed FILE...
//
// For each file: whether it has an end, how many messages each topic has, and of every raw force
// sample the stamp in ns and the bits of the wrench. Every message of every topic is decoded.

import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { readFile } from "node:fs/promises";

const decompressHandlers = await loadDecompressHandlers();

class Findings {
  complete = false;
  counts = {};
  rawForce = [];
  #readers = new Map();
  #topics = new Map();

  addChannel(channel, schema) {
    const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
    this.#readers.set(channel.id, new MessageReader(definition));
    this.#topics.set(channel.id, channel.topic);
  }

  addMessage({ channelId, data }) {
    const topic = this.#topics.get(channelId);
    const message = this.#readers.get(channelId).readMessage(data);
    this.counts[topic] = (this.counts[topic] ?? 0) + 1;
    if (topic === "/force/raw") {
      const { header, wrench } = message;
      const { force, torque } = wrench;
      const stamp = BigInt(header.stamp.sec) * 1_000_000_000n + BigInt(header.stamp.nanosec);
      this.rawForce.push([String(stamp), ...[force, torque].flatMap(({ x, y, z }) => [x, y, z].map(bits))]);
    }
  }
}

function bits(number) {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, number);
  return view.getBigUint64(0).toString(16).padStart(16, "0");
}

function readAsStream(bytes) {
  const findings = new Findings();
  const schemas = new Map();
  const channels = new Set();
  const reader = new McapStreamReader({ decompressHandlers });
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") {
      schemas.set(record.id, record);
    } else if (record.type === "Channel" && !channels.has(record.id)) {
      channels.add(record.id);
      findings.addChannel(record, schemas.get(record.schemaId));
    } else if (record.type === "Message") {
      findings.addMessage(record);
    }
  }
  findings.complete = reader.done();
  return findings;
}

async function readByIndex(bytes) {
  const findings = new Findings();
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  for (const channel of reader.channelsById.values()) {
    findings.addChannel(channel, reader.schemasById.get(channel.schemaId));
  }
  for await (const message of reader.readMessages()) {
    findings.addMessage(message);
  }
  findings.complete = true;
  return findings;
}

const [mode, ...paths] = process.argv.slice(2);
const read = { stream: readAsStream, indexed: readByIndex }[mode];
const found = {};
for (const path of paths) {
  found[path] = await read(new Uint8Array(await readFile(path)));
}
console.log(JSON.stringify(found));
