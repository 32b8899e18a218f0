// node bench.js BUILD [WIDTHxHEIGHT]: ns a pixel of metering (with the histogram) and mapping to RGBA8 as the page does them,
// scalar and by vectors, in turns; the fastest of 15 frames. `pupil bench kernels` has the same of a CPU's own kernels.
"use strict";
const page = require("./core.js")(process.argv[2]);
const [width, height] = (process.argv[3] ?? "1920x1080").split("x").map(Number);
const FRAMES = 15;

globalThis.ImageData = class {};

// Light over ten stops, as codes or floats.
function fill(core, pixel) {
    const bytes = core.bytes(core.frameAt, core.frameBytes);
    if (pixel === page.PIXEL.RGB32F)
        new Float32Array(bytes.buffer, core.frameAt, bytes.length / 4).forEach((_, i, all) => {
            all[i] = 2 ** (5 * Math.sin(i / 997) - 2);
        });
    else
        bytes.forEach((_, i) => {
            bytes[i] = 128 + 100 * Math.sin(i / 997);
        });
}

page.Core.load().then((core) => {
    const levels = [0, 4], pixels = width * height;
    for (const name of ["RGB32F", "RGBA8", "I420"]) {
        const times = { "scalar meter": [], "scalar map": [], "wasm128 meter": [], "wasm128 map": [] };
        core.make(page.PIXEL[name], width, height);
        fill(core, page.PIXEL[name]);
        core.take({ matrix: 0, range: 0 });
        for (let i = 0; i < FRAMES + 3; i++)
            for (const level of levels) {
                core.set("levels", 1 << level);
                const began = process.hrtime.bigint();
                core.meter();
                const metered = process.hrtime.bigint();
                core.adapt(BigInt(i + 1) * 33333333n, 0, 0);
                const adapted = process.hrtime.bigint();
                core.map(page.VIEW.SECONDS, 0);
                const mapped = process.hrtime.bigint();
                if (i < 3)
                    continue;
                times[`${core.level} meter`].push(Number(metered - began) / pixels);
                times[`${core.level} map`].push(Number(mapped - adapted) / pixels);
            }
        const shown = Object.entries(times).map(([key, list]) => `${key} ${Math.min(...list).toFixed(2)}`);
        console.log(`${name} ${width}x${height}, ns a pixel: ${shown.join(", ")}`);
    }
});
