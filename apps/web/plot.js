// Plots the levels of the last seconds on a canvas, in EV.

const PLOT_SECONDS = 20;

class Plot {
    constructor(canvas) {
        this.canvas = canvas;
        this.points = [];
    }

    // levels: { name: EV }
    add(seconds, levels) {
        if (this.points.length && seconds <= this.points.at(-1).seconds)
            this.points = [];
        this.points.push({ seconds, levels });
        while (this.points[0].seconds < seconds - PLOT_SECONDS)
            this.points.shift();
    }

    // lines: [name, colour, width]
    draw(lines) {
        const scale = window.devicePixelRatio || 1, box = this.canvas.getBoundingClientRect();
        const width = Math.max(1, Math.round(box.width * scale)), height = Math.max(1, Math.round(box.height * scale));
        if (this.canvas.width !== width || this.canvas.height !== height)
            Object.assign(this.canvas, { width, height });
        const context = this.canvas.getContext("2d"), style = getComputedStyle(this.canvas);
        context.setTransform(scale, 0, 0, scale, 0, 0);
        context.clearRect(0, 0, box.width, box.height);
        const all = this.points.flatMap((p) => lines.map(([name]) => p.levels[name]).filter(Number.isFinite));
        if (!all.length)
            return;
        const low = Math.floor(Math.min(...all) - 0.5), high = Math.ceil(Math.max(...all) + 0.5);
        const left = 46, bottom = box.height - 22, top = 8, right = box.width - 8, end = this.points.at(-1).seconds;
        const x = (s) => right - ((end - s) / PLOT_SECONDS) * (right - left);
        const y = (ev) => bottom - ((ev - low) / (high - low)) * (bottom - top);
        this.axes(context, style, { low, high, left, right, top, bottom, x, y, end });
        context.save();
        context.beginPath();
        context.rect(left, top, right - left, bottom - top);
        context.clip();
        for (const [name, colour, thick] of lines)
            this.line(context, style.getPropertyValue(colour), thick, name, x, y);
        context.restore();
    }

    axes(context, style, a) {
        context.font = "12px system-ui, sans-serif";
        context.fillStyle = style.getPropertyValue("--soft");
        context.strokeStyle = style.getPropertyValue("--line");
        context.lineWidth = 1;
        const step = Math.max(1, Math.ceil((a.high - a.low) / 6));
        for (let ev = a.low; ev <= a.high; ev += step) {
            context.beginPath();
            context.moveTo(a.left, a.y(ev));
            context.lineTo(a.right, a.y(ev));
            context.stroke();
            context.fillText(`${ev} EV`, 2, a.y(ev) + 4);
        }
        for (let s = 0; s <= PLOT_SECONDS; s += 5) {
            const text = s ? `−${s} s` : "now", wide = context.measureText(text).width;
            context.fillText(text, Math.min(a.x(a.end - s) - wide / 2, a.right - wide), a.bottom + 16);
        }
    }

    line(context, colour, thick, name, x, y) {
        context.strokeStyle = colour;
        context.lineWidth = thick;
        context.beginPath();
        let begun = false;
        for (const p of this.points) {
            const ev = p.levels[name];
            if (!Number.isFinite(ev)) {
                begun = false;
                continue;
            }
            if (begun)
                context.lineTo(x(p.seconds), y(ev));
            else
                context.moveTo(x(p.seconds), y(ev));
            begun = true;
        }
        context.stroke();
    }
}
