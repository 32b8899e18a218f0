// node readers.js BUILD PROGRAM FILES...: the page's readers and core against `pupil replay`: the same level of each file, to
// the bit, and a sentence where the program has one. Then damaged copies of the files: a sentence, or a picture.
"use strict";
const childProcess = require("child_process");
const fs = require("fs");
const path = require("path");

const [build, program, ...files] = process.argv.slice(2);
const page = require("./core.js")(build);
// What the page says it cannot read, and the program can (DWA with OpenEXR 3.1.13, as of Debian 13).
const LESS = /compressed as (B44|DWA)|Y alone, are read here|several levels|several parts|of its kind does not agree/;
const COPIES = 20, MOST_BYTES = 200000;
let failures = 0, same = 0, refused = 0, damaged = 0;
let seed = 1;

function fail(sentence) {
    console.log(`FAILED: ${sentence}`);
    failures++;
}

// Knuth's MMIX generator, upper bits.
function random(below) {
    seed = Number((BigInt(seed) * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn);
    return Number((BigInt(seed) >> 33n) % BigInt(below));
}

async function levelOf(core, bytes) {
    const still = await page.readPicture(bytes), floats = still.pixel === page.PIXEL.RGB32F;
    const stops = floats && !still.codeLight ? page.stopsForUnit(still.data, still.width, still.height) : 0;
    core.make(still.pixel, still.width, still.height);
    core.bytes(core.lightAt, core.frameBytes).set(new Uint8Array(still.data.buffer, 0, core.frameBytes));
    core.bytes(core.frameAt, core.frameBytes).set(new Uint8Array(still.data.buffer, 0, core.frameBytes));
    if (floats)
        core.calls.light(core.lightAt, core.frameAt, core.frameBytes / 4, 2 ** stops);
    core.calls.reset();
    core.set("metering", 0);
    if (still.window)
        core.calls.region(still.window.x, still.window.y, still.window.width, still.window.height);
    core.codeLight = still.codeLight ?? 0;
    core.take({ matrix: 0, range: 1 });
    core.meter();
    core.adapt(0n, stops ? 1 : 0, stops ? 2 ** stops : 0);
    return ["metered_ev", "adapted_ev"].map((name) => core.result(0, name));
}

function levelByProgram(file) {
    const run = childProcess.spawnSync(program, ["replay", file, "--stats", "-", "-q", "-n", "1"], { encoding: "utf8" });
    if (run.status !== 0)
        return run.stderr.trim().split("\n")[0];
    const line = JSON.parse(run.stdout.split("\n")[0]);
    return [line.metered_ev, line.adapted_ev];
}

async function compare(core, file) {
    const bytes = new Uint8Array(fs.readFileSync(file)), expected = levelByProgram(file);
    let got;
    try {
        got = await levelOf(core, bytes);
    } catch (error) {
        got = error.message;
    }
    if (typeof got === "string" && (typeof expected === "string" || LESS.test(got)))
        refused++;
    else if (String(got) === String(expected))
        same++;
    else
        fail(`${path.basename(file)}: the page has ${got}, the program ${expected}`);
}

async function damage(core, file) {
    const whole = new Uint8Array(fs.readFileSync(file));
    for (let i = 0; i < COPIES && whole.length > 0 && whole.length < MOST_BYTES; i++) {
        seed = i + 1;
        const bytes = whole.slice(0, i % 3 ? whole.length : random(whole.length));
        for (let k = 0; i % 3 && k < 1 + i % 4; k++)
            bytes[random(bytes.length)] = random(256);
        try {
            await levelOf(core, bytes);
        } catch (error) {
            damaged++;
            if (error.constructor !== Error || !error.message)
                fail(`${path.basename(file)}, seed ${i + 1}: no sentence but ${error.stack}`);
        }
    }
}

(async () => {
    const core = await page.Core.load();
    if (core.level !== "wasm128")
        fail(`the level is ${core.level}`);
    for (const file of files) {
        await compare(core, file);
        await damage(core, file);
    }
    console.log(`${same} files with the program's level, ${refused} refused; ${damaged} damaged copies refused`);
    process.exitCode = failures || !same || !damaged ? 1 : 0;
})();
