// Validates glTF files with Khronos' validator: node gltf_check.mjs FOLDER_OF_NODE_MODULES FILE..
// Prints one JSON object a file; exit code 1 if there is an error or a warning.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const [folder, ...files] = process.argv.slice(2);
const validator = createRequire(path.join(folder, 'x.js'))('gltf-validator');
let bad = false;
for (const file of files) {
  const beside = (uri) => Promise.resolve(new Uint8Array(readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))));
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { externalResourceFunction: beside });
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(JSON.stringify({ file, numErrors, numWarnings, messages, info: report.info }));
  bad ||= numErrors > 0 || numWarnings > 0;
}
process.exit(bad ? 1 : 0);
