// The page's core and readers under node, as the page has them: require("./core.js")(BUILD).
"use strict";
const fs = require("fs");
const path = require("path");
const vm = require("vm");

const WEB = path.join(__dirname, "../../apps/web");
const SCRIPTS = ["core", "light", "read_png", "read_radiance", "read_piz", "read_exr", "read"];

module.exports = (build) => {
    const module = (name) => fs.readFileSync(path.join(build, "apps/web", `${name}.wasm`)).toString("base64");
    const text = [`const PAGE_WASM128 = "${module("page_wasm128")}", PAGE_SCALAR = "${module("page_scalar")}";`,
        ...SCRIPTS.map((name) => fs.readFileSync(path.join(WEB, `${name}.js`), "utf8")),
        "globalThis.page = { Core, readPicture, stopsForUnit, PIXEL, VIEW };"].join("\n");
    vm.runInThisContext(text);
    return globalThis.page;
};
