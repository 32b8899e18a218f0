// node wasm_run.js PROGRAM: runs a program that was linked with wasm_start.c; its exit status.
"use strict";
const fs = require("fs");

let memory = null;
const board = {
    print(at) {
        const bytes = new Uint8Array(memory.buffer);
        fs.writeSync(1, bytes.slice(at, bytes.indexOf(0, at)));
    },
};

WebAssembly.instantiate(fs.readFileSync(process.argv[2]), { board }).then(({ instance }) => {
    memory = instance.exports.memory;
    process.exitCode = instance.exports.start();
});
