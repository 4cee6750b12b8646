// What the validator of the Khronos Group says of a GLB: one line of JSON. Arguments: folder with node_modules, file.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [, , modules, file] = process.argv;
const validator = createRequire(`${modules}/x.js`)("gltf-validator");
const told = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 100 });
console.log(JSON.stringify(told));
