// The picture: two views with a line between them, and the metering region, which is set by pointer or keys.

class Picture {
    constructor(stage, canvas, box, onRegion) {
        Object.assign(this, { stage, canvas, box, onRegion });
        this.region = null; // { x, y, width, height } in shares of the picture
        this.split = 0;
        this.context = canvas.getContext("2d");
        this.buffer = new OffscreenCanvas(1, 1);
        this.listen();
    }

    // right: ImageData; left: ImageData or null
    draw(right, left) {
        const { width, height } = right;
        if (this.canvas.width !== width || this.canvas.height !== height) {
            Object.assign(this.canvas, { width, height });
            this.stage.style.aspectRatio = `${width} / ${height}`;
        }
        const edge = left ? Math.round(this.split * width) : 0;
        this.context.putImageData(right, 0, 0, edge, 0, width - edge, height);
        if (edge)
            this.context.putImageData(left, 0, 0, 0, 0, edge, height);
    }

    listen() {
        let from = null;
        const at = (event) => {
            const box = this.stage.getBoundingClientRect(), share = (v, size) => Math.min(1, Math.max(0, v / size));
            return [share(event.clientX - box.left, box.width), share(event.clientY - box.top, box.height)];
        };
        this.stage.addEventListener("pointerdown", (event) => {
            from = at(event);
            this.stage.setPointerCapture(event.pointerId);
        });
        this.stage.addEventListener("pointermove", (event) => {
            if (!from)
                return;
            const to = at(event), width = Math.abs(to[0] - from[0]), height = Math.abs(to[1] - from[1]);
            if (width > 0.02 && height > 0.02)
                this.setRegion({ x: Math.min(from[0], to[0]), y: Math.min(from[1], to[1]), width, height });
        });
        for (const name of ["pointerup", "pointercancel"])
            this.stage.addEventListener(name, (event) => {
                const to = from && at(event);
                if (to && Math.hypot(to[0] - from[0], to[1] - from[1]) < 0.01)
                    this.setRegion(null);
                from = null;
            });
        this.stage.addEventListener("keydown", (event) => this.key(event));
    }

    key(event) {
        const step = 1 / 32, moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
        const move = moves[event.key], r = this.region ?? { x: 0.375, y: 0.375, width: 0.25, height: 0.25 };
        if (event.key === "Escape" || event.key === "Delete")
            this.setRegion(null);
        else if (event.key === "Enter")
            this.setRegion(r);
        else if (move && event.shiftKey)
            this.setRegion({ ...r, width: Math.min(1 - r.x, Math.max(step, r.width + move[0])),
                height: Math.min(1 - r.y, Math.max(step, r.height + move[1])) });
        else if (move)
            this.setRegion({ ...r, x: Math.min(1 - r.width, Math.max(0, r.x + move[0])),
                y: Math.min(1 - r.height, Math.max(0, r.y + move[1])) });
        else
            return;
        event.preventDefault();
    }

    setRegion(region) {
        this.region = region;
        this.box.hidden = !region;
        if (region)
            Object.assign(this.box.style, { left: `${100 * region.x}%`, top: `${100 * region.y}%`,
                width: `${100 * region.width}%`, height: `${100 * region.height}%` });
        this.onRegion(region);
    }
}
