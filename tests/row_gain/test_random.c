/* Random cameras, lamps and daylight, with an event halfway: gains never add a band to any part of a frame. The second
 * argument is how many.
 */
#include "lamp_rig.h"

enum { USUAL_CASES = 100, FEW_CASES = 40 /* under the sanitizers */, FRAMES = 75, EVENT = 45 };

static int one_in(unsigned n)
{
    return check_random() % n == 0;
}

static rig random_rig(void)
{
    static const double fps[] = {12, 15, 24, 25, 29.97, 30, 48, 50, 60, 90};
    rig r = rig_default();
    r.fps = fps[check_random() % 10];
    if (one_in(2))
        r.mains_hz = 60, r.light_hz = 120;
    r.light_hz *= 1 + 0.004 * (check_uniform() - 0.5);
    r.modulation = one_in(4) ? 0 : 0.5 * check_uniform();
    r.wave = (rig_wave)(check_random() % RIG_WAVES);
    r.readout_share = 0.3 + 0.7 * check_uniform();
    r.exposure_s = 3e-4 * pow(30, check_uniform());
    r.pan_px = one_in(2) ? 0 : 4 * check_uniform();
    r.texture_ev = 0.3 + check_uniform();
    r.jitter_s = one_in(3) ? 5e-4 * check_uniform() : 0;
    r.noise = 0.03 * check_uniform();
    if (one_in(2)) {
        const double w = 0.1 + 0.85 * check_uniform(), h = one_in(3) ? 1 : 0.1 + 0.85 * check_uniform();
        r.day_inside = 0.1 + 0.9 * check_uniform();
        r.x0 = (1 - w) * check_uniform(), r.x1 = r.x0 + w;
        r.y0 = (1 - h) * check_uniform(), r.y1 = r.y0 + h;
    }
    return r;
}

typedef enum event { LAMPS_OFF, EXPOSURE, CUT, DAY_ENDS, DAY_BEGINS, STROBES, EVENTS } event;
static const char *const event_name[EVENTS] = {"lamps off",         "another exposure",    "a cut",
                                               "no daylight there", "daylight in columns", "strobes"};

static void happen(rig_camera *c, event what)
{
    switch (what) {
    case LAMPS_OFF:
        c->r.modulation = 0;
        break;
    case EXPOSURE:
        c->r.exposure_s = 3e-4 * pow(30, check_uniform());
        break;
    case CUT:
        c->scene_x += 50;
        break;
    case DAY_ENDS:
        c->r.day_inside = 0;
        break;
    case DAY_BEGINS:
        c->r.day_inside = 1;
        c->r.x0 = 0.1 + 0.5 * check_uniform(), c->r.x1 = c->r.x0 + 0.3;
        c->r.y0 = 0, c->r.y1 = 1;
        break;
    default:
        break;
    }
}

int main(int argc, char **argv)
{
    static rig_camera c;
    long with_gains = 0;
    double most = 0;
    check_begin(argc, argv);
    const int usual = CHECK_SANITIZED ? FEW_CASES : USUAL_CASES;
    const int cases = argc > 2 && !check_state.all ? atoi(argv[2]) : usual / check_every(4);
    rig_make_wall();
    for (int k = 0; k < cases; k++) {
        const rig r = random_rig();
        const event what = (event)(check_random() % EVENTS);
        rig_open(&c, &r);
        for (int i = 0; i < FRAMES; i++) {
            if (i == EVENT)
                happen(&c, what);
            if (what == STROBES && i >= EVENT && one_in(5))
                c.flash = 10 * check_uniform(), c.flash_from = (int)(RIG_H * check_uniform());
            const rig_seen s = rig_next(&c);
            const double worse = fmax(s.after - s.before, s.day_after - s.day_before);
            most = fmax(most, worse);
            with_gains += s.after < 0.5 * s.before;
            CHECK_MSG(worse <= 0.01,
                      "camera %d, frame %d (%s): gains add %.3f EV; %g Hz, %g frames a second, modulation %.2f of %s, "
                      "readout %.2f, %.2g s, pan %.2f",
                      k, i, event_name[what], worse, r.light_hz, r.fps, r.modulation, rig_wave_name[r.wave],
                      r.readout_share, r.exposure_s, r.pan_px);
        }
    }
    printf("%d cameras, %d frames, %ld of them with less than half of their bands: gains add at most %.4f EV\n", cases,
           cases * FRAMES, with_gains, most);
    CHECK(with_gains > cases); /* it is about something */
    return check_end();
}
