// SPDX-License-Identifier: BSD-3-Clause
// schemas.mjs SCHEMAS OUTPUTS: validates OUTPUTS/NAME/*.json by SCHEMAS/NAME.json, and requires that each schema is that of
// the last row of its version in SCHEMAS/versions.txt (rows NAME VERSION SHA256). Run by schemas.sh.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, readdirSync } from "node:fs";
import Ajv from "ajv";

const [schemas, outputs] = process.argv.slice(2);
const read = (file) => JSON.parse(readFileSync(file, "utf8"));
const names = readdirSync(schemas).filter((file) => file.endsWith(".json")).map((file) => file.slice(0, -5));
assert.ok(names.length >= 5);

const rows = readFileSync(`${schemas}/versions.txt`, "utf8").split("\n").filter((row) => row && !row.startsWith("#")).map((row) => row.split(" "));
/// The version that outputs of a schema contain.
const versionOf = (schema) =>
  (schema.properties?.schema ?? schema.properties?.stillpoint_store ?? schema.definitions.run.properties.schema).const;
/// Without what changes no output.
const digestOf = ({ title, $id, $schema, ...rest }) => createHash("sha256").update(JSON.stringify(rest)).digest("hex");

function requireVersion(name, schema) {
  const known = rows.filter(([of]) => of === name);
  const versions = known.map(([, version]) => Number(version));
  assert.deepEqual(versions, [...new Set(versions)].sort((a, b) => a - b), `versions of ${name} ascend`);
  const [, version, digest] = known.at(-1);
  assert.ok(Number(version) === versionOf(schema) && digest === digestOf(schema),
    `${name}.json differs from version ${version}: raise the version in the program and the schema, and add the row\n${name} ${Number(version) + 1} SHA256\n` +
    `(the digest of the current text is ${digestOf(schema)})`);
}

let documents = 0;
for (const name of names) {
  const schema = read(`${schemas}/${name}.json`);
  requireVersion(name, schema);
  const isValid = new Ajv({ strict: true, allowUnionTypes: true, strictRequired: false, strictTypes: false }).compile(schema);
  const files = readdirSync(`${outputs}/${name}`);
  assert.ok(files.length > 0, name);
  for (const file of files) {
    const output = read(`${outputs}/${name}/${file}`);
    assert.ok(isValid(output), `${name}/${file}: ${JSON.stringify(isValid.errors, null, 1)}`);
    ++documents;
    // The schema notices a member that is added or renamed, and another version.
    assert.ok(!isValid({ ...output, added: 1 }), `${file} with another member`);
    // Of a table, a column.
    for (const [column, value] of Object.entries(output.kind ? (output.rows[0] ?? {}) : {})) {
      const { [column]: removed, ...rest } = output.rows[0];
      assert.ok(!isValid({ ...output, rows: [rest] }), `${file} without ${column}`);
      assert.ok(!isValid({ ...output, rows: [{ ...rest, [`${column}_`]: value }] }), `${file} with another name of ${column}`);
    }
    const key = "stillpoint_store" in output ? "stillpoint_store" : "schema";
    assert.ok(!isValid({ ...output, [key]: output[key] + 1 }), `${file} of another version`);
    for (const required of schema.required ?? ["schema"]) {
      const { [required]: value, ...rest } = output;
      assert.ok(!isValid({ ...rest, [`${required}_`]: value }), `${file} with another name of ${required}`);
      assert.ok(!isValid(rest), `${file} without ${required}`);
    }
  }
}
console.log(`${names.length} schemas, ${documents} outputs`);
