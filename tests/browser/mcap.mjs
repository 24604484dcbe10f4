// SPDX-License-Identifier: BSD-3-Clause
// Reads a recording of `run --mcap`, or with STORED of `store extract --mcap`, with @mcap/core, decodes every message of every channel by the schema in the file, and
// compares types with those that Foxglove publishes, and contents with the files of the run. Run by mcap.sh.
import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import * as support from "@mcap/support";
import * as published from "@foxglove/schemas/jsonschema.js";
import Ajv from "ajv";

const { MCAP, RUN, SEQUENCE, IMAGES, STORED } = process.env;
const decompressHandlers = await support.loadDecompressHandlers();
const rows = async (file, separator = ",") =>
  (await readFile(file, "utf8")).split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(separator));
const records = async (file) => {
  const [header, ...body] = await rows(file);
  return body.map((row) => Object.fromEntries(row.map((value, i) => [header[i], value])));
};

// --- the container ---
const file = await open(MCAP);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const { buffer } = await file.read(Buffer.alloc(Number(size)), 0, Number(size), Number(offset));
      return buffer;
    },
  },
  decompressHandlers,
});
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(await readFile(MCAP));
const streamed = new Map();
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  if (record.type === "Message") streamed.set(record.channelId, (streamed.get(record.channelId) ?? 0) + 1);
}
assert.ok(stream.done(), "the file ends with its end mark");
assert.ok(reader.chunkIndexes.every((chunk) => chunk.compression === "zstd"));

// --- the types ---
/// What a type of Protocol Buffers is in the JSON Schema of Foxglove.
function jsonType(field) {
  if (field.repeated) return "array";
  if (["double", "int64", "int32", "fixed32"].includes(field.type)) return field.type === "double" ? "number" : "integer";
  if (["string", "bytes"].includes(field.type)) return "string";
  return field.resolvedType.values ? undefined : "object";
}

function compareType(type, schema) {
  for (const field of type.fieldsArray) {
    const property = schema.properties[field.name];
    assert.ok(property, `${type.fullName}.${field.name} is published`);
    const expected = jsonType(field);
    if (expected) assert.equal(property.type, expected, `${type.fullName}.${field.name}`);
    if (field.resolvedType?.values) {
      const values = Object.fromEntries(property.oneOf.map(({ title, const: value }) => [title, value]));
      for (const [name, value] of Object.entries(field.resolvedType.values)) {
        if (name !== "UNKNOWN") assert.equal(values[name], value, `${type.fullName}.${name}`);
      }
    } else if (field.resolvedType && field.resolvedType.name !== "Timestamp") {
      compareType(field.resolvedType, field.repeated ? property.items : property);
    }
  }
}

/// The message as the JSON that Foxglove describes: times with sec and nsec, bytes in base64.
function toJson(value) {
  if (value instanceof Uint8Array) return Buffer.from(value).toString("base64");
  if (Array.isArray(value)) return value.map(toJson);
  if (value === null || typeof value !== "object") return value;
  if ("seconds" in value) return { sec: Number(value.seconds), nsec: value.nanos };
  return Object.fromEntries(Object.entries(value).map(([name, member]) => [name, toJson(member)]));
}

const ajv = new Ajv({ strict: false });
const channels = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  assert.deepEqual([channel.messageEncoding, schema.encoding], ["protobuf", "protobuf"]);
  const type = support.protobufFromBinaryDescriptor(schema.data).lookupType(schema.name);
  type.root.resolveAll();
  const [scope, name] = schema.name.split(".");
  if (scope === "foxglove") compareType(type, published[name]);
  channels.set(channel.id, {
    topic: channel.topic,
    type,
    messages: [],
    isValid: scope === "foxglove" ? ajv.compile(published[name]) : () => true,
  });
}

// --- the messages ---
const ns = ({ seconds, nanos }) => BigInt(seconds.toString()) * 1000000000n + BigInt(nanos);
for await (const { channelId, logTime, data } of reader.readMessages()) {
  const { topic, type, messages, isValid } = channels.get(channelId);
  const decoded = type.decode(data);
  const message = type.toObject(decoded, { defaults: true });
  assert.ok(isValid(toJson(message)), `${topic}: ${JSON.stringify(isValid.errors)}`);
  assert.equal(Buffer.compare(Buffer.from(type.encode(decoded).finish()), Buffer.from(data)), 0, `${topic}: fields in their order`);
  messages.push({ ...message, logTime });
}
for (const [id, { topic, messages }] of channels) assert.equal(messages.length, streamed.get(id), topic);
const topics = Object.fromEntries([...channels.values()].map(({ topic, messages }) => [topic, messages]));
const count = (topic) => topics[topic]?.length ?? 0;

// --- the content: that of the run ---
const secondsOf = (stamp) => {
  const digits = ns(stamp).toString().padStart(10, "0");
  return `${digits.slice(0, -9)}.${digits.slice(-9)}`;
};
const tumRow = (timestamp, { position: p, orientation: q }) =>
  [secondsOf(timestamp), ...[p.x, p.y, p.z, q.x, q.y, q.z, q.w].map((value) => value.toFixed(9))];
const withoutSign = (row) => row.map((text) => text.replace(/^-(0\.0*)$/, "$1"));
const isNear = (a, b, tolerance, what) => assert.ok(Math.abs(a - b) <= tolerance, `${what}: ${a} and ${b}`);

const trajectory = await rows(`${RUN}/trajectory.tum`, " ");
assert.ok(trajectory.length > 40);
assert.equal(count("/estimate"), trajectory.length);
topics["/estimate"].forEach(({ timestamp, pose, frame_id, logTime }, i) => {
  assert.equal(frame_id, "world");
  assert.equal(ns(timestamp), logTime);
  const row = tumRow(timestamp, pose);
  assert.equal(row[0], trajectory[i][0]);
  row.slice(1).forEach((value, k) => isNear(value, trajectory[i][k + 1], 1.1e-9, `pose ${i}`));
});
assert.deepEqual(topics["/estimate/path"][0].poses, topics["/estimate"].map(({ pose }) => pose));

const claims = await records(`${RUN}/status.csv`);
const counters = await records(`${RUN}/counters.csv`);
assert.equal(count("/status"), claims.length);
topics["/status"].forEach((status, i) => {
  assert.equal(Number(status.frame), Number(claims[i].frame));
  assert.equal(status.status, claims[i].status);
  assert.equal(status.segment, Number(claims[i].segment));
  for (const name of ["tracked_features", "window_landmarks", "depth_landmarks", "dynamic_features", "solver_iterations"])
    assert.equal(status[name], Number(counters[i][name]), name);
});

const times = await records(`${RUN}/timings.csv`);
const recordedTimes = topics["/timings"].flatMap(({ frame, modules }) =>
  modules.filter(({ module }) => module !== "image_decoding").map((time) => [Number(frame), time.module, Math.round(time.ms * 1e6), time.calls]));
assert.deepEqual(recordedTimes, times.map((row) => [Number(row.frame), row.module, Number(row.ns), Number(row.calls)]));

if (STORED) {
  assert.deepEqual(topics["/claims"].map((claim) => [Number(claim.frame), claim.status, claim.sigma_m, claim.sigma_rad]),
    claims.map((row) => [Number(row.frame), row.status, Number(row.sigma_m), Number(row.sigma_rad)]));
  assert.ok(topics["/claims"].some(({ sigma_m }) => sigma_m > 0));
  assert.equal(count("/camera/image"), 3);
  const transforms = topics["/tf"].filter(({ child_frame_id }) => child_frame_id === "camera");
  assert.deepEqual(transforms.map(({ translation }) => translation), topics["/estimate"].map(({ pose }) => pose.position));
  assert.equal(topics["/tf"].filter(({ child_frame_id }) => child_frame_id === "truth").length, 1);
  assert.ok(count("/truth") > 40);
  assert.deepEqual(topics["/truth/path"][0].poses, topics["/truth"].map(({ pose }) => pose));
  console.log(`${channels.size} channels of a stored run, ${[...streamed.values()].reduce((a, b) => a + b)} messages`);
  process.exit(0);
}

// Features with a label, by their colors.
const colors = { stable: [60, 220, 60], dynamic_object: [255, 50, 40], dynamic_motion: [255, 60, 255] };
const isColor = (color, rgb) => rgb.every((value, i) => Math.abs(Object.values(color)[i] - value / 255) < 1e-12);
const recordedLabels = [];
topics["/camera/annotations"].forEach(({ points, texts }) => {
  const boxes = points.filter(({ type }) => type === 2);
  assert.deepEqual(boxes.map(({ points: corners }) => corners.length), boxes.map(() => 4));
  assert.equal(texts.length, boxes.length);
  for (const [label, rgb] of Object.entries(colors)) {
    for (const { points: pixels } of points.filter(({ type, outline_color }) => type === 1 && isColor(outline_color, rgb)))
      recordedLabels.push(...pixels.map(({ x, y }) => `${label} ${(x - 0.5).toFixed(2)} ${(y - 0.5).toFixed(2)}`));
  }
});
const features = await records(`${RUN}/labels.csv`);
const labels = features.map((row) => `${row.label} ${row.u_px} ${row.v_px}`);
assert.ok(labels.some((text) => text.startsWith("dynamic_object")) && labels.length > 1000);
assert.equal(recordedLabels.length, labels.length);
// A few pixels are rounded to another hundredth: 0.5 was added and subtracted.
const known = new Set(labels);
assert.ok(recordedLabels.filter((text) => known.has(text)).length > 0.98 * labels.length);
assert.ok(topics["/camera/annotations"].some(({ texts }) => texts.some(({ text }) => text.startsWith("person"))));

const last = ns(topics["/status"].at(-1).timestamp);
// The samples have the times of the gyroscope; accelerations are interpolated.
const rates = new Map((await rows(`${SEQUENCE}/d400_gyroscope.txt`, " ")).map(([t, ...rate]) => [BigInt(t.replace(".", "")), rate]));
const expected = [...rates.keys()].filter((t) => t <= last);
assert.ok(expected.length > 700);
assert.ok(expected.length - count("/imu") < 5, "only samples without accelerations around them are left out");
for (const { timestamp, angular_velocity: w, linear_acceleration: a } of topics["/imu"]) {
  [w.x, w.y, w.z].forEach((value, k) => isNear(value, rates.get(ns(timestamp))[k], 1e-12, "angular rate"));
  isNear(Math.hypot(a.x, a.y, a.z), 9.81, 5, "acceleration");
}

const truth = (await rows(`${SEQUENCE}/groundtruth.txt`, " ")).filter((row) => BigInt(row[0].replace(".", "")) <= last);
assert.equal(count("/truth"), truth.length);
assert.equal(topics["/truth/path"][0].poses.length, (await rows(`${SEQUENCE}/groundtruth.txt`, " ")).length);

// The truth in the world is near the estimate, by the transforms of the file.
const located = topics["/tf"].filter(({ parent_frame_id }) => parent_frame_id === "world");
assert.equal(located.filter(({ child_frame_id }) => child_frame_id === "truth").length, 1);
assert.equal(located.filter(({ child_frame_id }) => child_frame_id === "body").length, trajectory.length);
const rotate = ({ x, y, z, w }, p) => {
  const t = [2 * (y * p.z - z * p.y), 2 * (z * p.x - x * p.z), 2 * (x * p.y - y * p.x)];
  return [p.x + w * t[0] + y * t[2] - z * t[1], p.y + w * t[1] + z * t[0] - x * t[2], p.z + w * t[2] + x * t[1] - y * t[0]];
};
const { translation, rotation } = located.find(({ child_frame_id }) => child_frame_id === "truth");
const truthAt = new Map(topics["/truth"].map(({ timestamp, pose }) => [ns(timestamp), pose.position]));
let compared = 0;
for (const { timestamp, pose } of topics["/estimate"]) {
  const position = truthAt.get(ns(timestamp));
  if (!position) continue;
  const p = rotate(rotation, position);
  const error = Math.hypot(p[0] + translation.x - pose.position.x, p[1] + translation.y - pose.position.y, p[2] + translation.z - pose.position.z);
  assert.ok(error < 0.1, `error ${error} m`);
  ++compared;
}
assert.ok(compared > 10, `${compared} true poses at the times of frames`);

assert.equal(count("/landmarks"), claims.length);
topics["/landmarks"].forEach(({ data, point_stride, fields, frame_id }) => {
  assert.equal(frame_id, "camera");
  assert.equal(data.length % point_stride, 0);
  assert.deepEqual(fields.map(({ name }) => name), ["x", "y", "z", "red", "green", "blue", "alpha"]);
});
assert.ok(topics["/landmarks"].at(-1).data.length > 20 * 16);
assert.equal(topics["/camera/calibration"][0].K[0], 210);
assert.equal(count("/state"), trajectory.length);

if (IMAGES) {
  assert.equal(count("/camera/image"), claims.length);
  for (const { data, format } of topics["/camera/image"]) {
    assert.equal(format, "jpeg");
    assert.deepEqual([...data.subarray(0, 2), ...data.subarray(-2)], [0xff, 0xd8, 0xff, 0xd9]);
  }
  for (const { data, width, height, step, encoding } of topics["/camera/depth"])
    assert.deepEqual([width, height, step, encoding, data.length], [320, 240, 640, "16UC1", 320 * 240 * 2]);
  assert.equal(count("/camera/depth"), claims.length);
  // The mask covers the features that were taken for dynamic by it, with measured depth, at their nearest pixels.
  const masks = new Map(topics["/camera/mask"].map((mask) => [secondsOf(mask.timestamp), mask]));
  for (const { data, width, height, step, encoding } of masks.values()) {
    assert.deepEqual([width, height, step, encoding, data.length], [320, 240, 320, "mono8", 320 * 240]);
    assert.ok(data.every((value) => value === 0 || value === 255));
  }
  const covered = features.filter(({ reason, depth_m }) => reason === "inside_mask" && Number(depth_m) > 0)
    .map(({ t, u_px, v_px }) => masks.get(t).data[Math.round(v_px) * 320 + Math.round(u_px)] === 255);
  assert.ok(covered.length > 100 && covered.filter((is) => is).length > 0.9 * covered.length, `${covered.filter((is) => is).length} of ${covered.length}`);
  assert.equal(topics["/estimate/optimized"][0].poses.length, trajectory.length);
  // The layout names topics and fields of this recording.
  const layout = await readFile(new URL("../../bench/viewers/foxglove.json", import.meta.url), "utf8");
  const names = [...layout.matchAll(/"(\/[a-z_/]+)(?:\.([a-z_]+))?/g)];
  assert.ok(names.length >= 10);
  for (const [, topic, field] of names) {
    assert.ok(count(topic) > 0, `${topic} of the layout`);
    if (field) assert.ok(field in topics[topic][0], `${topic}.${field} of the layout`);
  }
} else {
  assert.equal(count("/camera/image") + count("/camera/depth"), 0);
}
const { size } = await file.stat();
console.log(`${[...channels.values()].length} channels, ${[...streamed.values()].reduce((a, b) => a + b)} messages, ${(size / claims.length / 1e3).toFixed(1)} kB per frame`);
await file.close();
