// What the page shows at the start: a room with a window and a lamp, over 10 stops, in linear light. It is a frame of
// floats, computed once; the light slider and the steps scale it.

function testScene() {
    const width = 480, height = 270, data = new Float32Array(width * height * 3);
    const patches = [[0.42, 0.13, 0.08], [0.75, 0.52, 0.41], [0.11, 0.30, 0.07], [0.06, 0.10, 0.33], [0.60, 0.50, 0.05],
        [0.35, 0.35, 0.35]];
    const colourAt = (x, y) => {
        const wall = 0.12 + 0.25 * Math.exp(-((x - 0.28) ** 2 + (y - 0.35) ** 2) / 0.12);
        const toLamp = Math.hypot((x - 0.83) * 1.78, y - 0.3), lamp = 0.5 * Math.exp(-toLamp / 0.13);
        if (toLamp < 0.035)
            return [40, 30, 18];
        if (x > 0.12 && x < 0.44 && y > 0.12 && y < 0.58) {
            const bar = Math.abs(x - 0.28) < 0.006 || Math.abs(y - 0.35) < 0.009;
            const cloud = 1 + 0.5 * Math.sin(21 * x + 4 * Math.sin(9 * y));
            return bar ? [0.10, 0.08, 0.06] : y > 0.46 ? [0.5, 0.8, 0.3] : [1.8 * cloud, 2.4 * cloud, 3.4];
        }
        if (y > 0.78) {
            const board = 0.7 + 0.3 * Math.sign(Math.sin(60 * (x - 0.5) / (y - 0.4)));
            return [0.16, 0.10, 0.06].map((c) => c * board * (0.4 + wall * 4 + lamp));
        }
        const i = Math.floor((x - 0.52) / 0.07);
        if (y > 0.55 && y < 0.68 && i >= 0 && i < patches.length && (x - 0.52) % 0.07 < 0.06)
            return patches[i].map((c) => c * (0.25 + wall + lamp));
        return [wall + lamp, 0.94 * wall + 0.8 * lamp, 0.85 * wall + 0.5 * lamp];
    };
    for (let i = 0; i < width * height; i++)
        data.set(colourAt((i % width + 0.5) / width, (Math.floor(i / width) + 0.5) / height), 3 * i);
    return { width, height, pixel: PIXEL.RGB32F, data };
}
