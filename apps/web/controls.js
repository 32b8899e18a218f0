// The controls of the settings, each with its unit, made from tables.

// name of SETTINGS, label, unit, least, most, step, start, digits shown; `of` converts the shown value to the setting.
// With list() a slider's values are not evenly spaced: its number is an index into the list.
const list = (...values) => ({ values, least: 0, most: values.length - 1, step: 1 });
const SECONDS = list(0, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1.2, 1.5, 2, 3, 5, 7, 10, 20);
const WEIGHTS = list(0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1);
const UNITS = list(0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000, 3000, 10000);
const SLIDERS = [
    { name: "ev_compensation", label: "Compensation", unit: "EV", least: -4, most: 4, step: 0.1, start: 0, digits: 1 },
    { name: "key", label: "Key: mid-grey", unit: "%", least: 4, most: 50, step: 1, start: 18, digits: 0, of: (v) => v / 100 },
    { name: "tau_light_s", label: "Time toward more light", unit: "s", ...SECONDS, start: 0.3, digits: 2 },
    { name: "tau_dark_s", label: "Time toward less light", unit: "s", ...SECONDS, start: 0.9, digits: 2 },
    { name: "frame_weight", label: "Weight of a frame, formulas", unit: "", ...WEIGHTS, start: 0.05, digits: 3 },
    { name: "ev_min", label: "Lowest level", unit: "EV", least: -16, most: 0, step: 0.5, start: -16, digits: 1 },
    { name: "ev_max", label: "Highest level", unit: "EV", least: 0, most: 16, step: 0.5, start: 16, digits: 1 },
    { name: "highlight_ev", label: "Highlights darken by at most", unit: "EV", least: 0, most: 8, step: 0.5, start: 2, digits: 1 },
    { name: "white_quantile", label: "Shown below white", unit: "%", least: 90, most: 100, step: 0.1, start: 99.5, digits: 1,
        of: (v) => v / 100 },
    { name: "eye_unit_cd_m2", label: "The eye: light of 1 is", unit: "cd/m²", ...UNITS, start: 100, digits: 1 },
];
const CHOICES = [
    { name: "metering", label: "Metering", options: ["all of it", "centre", "spot"], start: 0 },
    { name: "white_mode", label: "White", options: ["follows the light", "at 1", "never reached"], start: 0 },
    { name: "curve", label: "Curve", options: ["Reinhard", "normalise", "8 levels", "equalise", "adjust histogram"], start: 0 },
    { name: "lock", label: "Level", options: ["adapts", "locked"], start: 0 },
    { name: "flicker", label: "Flicker of lamps", options: ["stays", "is removed"], start: 1 },
];

class Controls {
    // change(name, value) may throw an Error with a sentence.
    constructor(form, change, fail) {
        Object.assign(this, { form, change, fail, inputs: {} });
        CHOICES.forEach((c) => this.addChoice(c));
        SLIDERS.forEach((s) => this.addSlider(s));
        const reset = document.createElement("button");
        Object.assign(reset, { type: "button", id: "defaults", textContent: "Defaults" });
        reset.addEventListener("click", () => this.defaults());
        form.append(reset);
        form.addEventListener("submit", (event) => event.preventDefault());
    }

    row(name, label, control, output) {
        const row = document.createElement("div"), text = document.createElement("label");
        row.className = "setting";
        text.textContent = label;
        text.htmlFor = control.id = `set-${name}`;
        row.append(...(output ? [text, output, control] : [text, control]));
        this.form.append(row);
        this.inputs[name] = control;
    }

    apply(name, value) {
        try {
            this.change(name, value);
        } catch (error) {
            this.fail(error);
        }
    }

    addSlider(s) {
        const input = document.createElement("input"), output = document.createElement("output");
        const shown = () => (s.values ? s.values[input.valueAsNumber] : input.valueAsNumber);
        Object.assign(input, { type: "range", min: s.least, max: s.most, step: s.step });
        const show = () => {
            output.textContent = `${shown().toFixed(s.digits)} ${s.unit}`.trim();
            input.setAttribute("aria-valuetext", output.textContent);
            this.apply(s.name, s.of ? s.of(shown()) : shown());
        };
        input.addEventListener("input", show);
        input.toDefault = () => {
            input.value = s.values ? s.values.indexOf(s.start) : s.start;
            show();
        };
        this.row(s.name, s.label, input, output);
    }

    addChoice(c) {
        const select = document.createElement("select");
        c.options.forEach((text, i) => select.add(new Option(text, i)));
        select.addEventListener("change", () => this.apply(c.name, Number(select.value)));
        select.toDefault = () => {
            select.value = c.start;
            this.apply(c.name, c.start);
        };
        select.value = c.start;
        this.row(c.name, c.label, select);
    }

    defaults() {
        Object.values(this.inputs).forEach((input) => input.toDefault());
    }
}
