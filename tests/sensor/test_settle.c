/* The sensor's controller around a small camera: how soon it is right, that it stays there, and that no step of the
 * sensor can be seen. Prints tables. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;

typedef struct answer {
    int frames;       /* until the sensor is within 0.1 EV (and the law's step below) and stays there, from the first
                       * frame with the new light */
    double overshoot; /* stops beyond, on the other side, once it has moved */
} answer;

/* The error that the law leaves in a right setting: it is rounded down; where gains are further apart than 0.2 EV, to
 * the nearest, so that it may be above, too. */
static double above_ev(int law)
{
    return law == LAW_THIRD ? 1.0 / 3.0 - 0.2 : 0.0;
}

static double below_ev(int law)
{
    return law == LAW_THIRD ? 0.2 : law == LAW_SIXTEENTH ? log2(17.0 / 16.0) : law == LAW_DB ? 0.05 : 0.01;
}

static answer watch(int law, double direction)
{
    answer a = {0, 0};
    for (int i = 0; i < 60; i++) {
        double off = plant_turn(&p, &sensor, &s, NULL);
        if (off > 0.1 + above_ev(law) || off < -0.1 - below_ev(law) - 0.05)
            a.frames = i + 1;
        if (i >= (int)p.delay[0]) /* a darker scene needs more exposure, so an overshoot is too bright */
            a.overshoot = fmax(a.overshoot, direction > 0 ? -off - below_ev(law) - 0.05 : off - above_ev(law));
    }
    CHECK(s.state == PUPIL_SENSOR_CONVERGED);
    return a;
}

/* The light changes by this many stops while the loop is at rest. */
static answer step(int law, uint32_t delay, double ev, int lies, uint32_t flash_frames)
{
    pupil_sensor_config c = plant_config(law);
    c.flash_frames = flash_frames;
    /* from the middle of the camera's range, so that no limit is met */
    const double middle = 0.5 * (log2(PLANT_LINE_S) + log2(20.0 / 30.0));
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - middle - 0.5 * ev, delay);
    p.lies = lies;
    for (int i = 0; i < 60; i++)
        plant_turn(&p, &sensor, &s, NULL);
    p.light_ev += ev;
    return watch(law, ev);
}

/* From the start of the stream, with a first setting this many stops too bright. */
static answer start(int law, uint32_t delay, double ev, int lies, uint32_t flash_frames)
{
    pupil_sensor_config c = plant_config(law);
    c.flash_frames = flash_frames;
    const double middle = 0.5 * (log2(PLANT_LINE_S) + log2(20.0 / 30.0));
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    CHECK(pupil_sensor_start(&sensor, exp2(middle + 0.5 * ev), 1.0) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18) - middle + 0.5 * ev, delay);
    p.lies = lies;
    return watch(law, ev);
}

/* D + 1 frames, and those needed to recognise a flash; where more than 97 % are clipped (+6 EV, white), 2 D + 1 where
 * that is more. A start looks at nothing twice. From white, with info that reports what was asked for, nothing shows
 * how long a second look has to wait: it waits for the configured delay. */
static void answered(const char *what, int law, uint32_t delay, const answer a[2], int most, int most_lying)
{
    for (int lies = 0; lies < 2; lies++) {
        most = lies ? most_lying : most;
        CHECK_MSG(a[lies].frames <= most, "%s, D %u, %s, lies %d: %d frames, %d allowed", law_name[law], delay, what,
                  lies, a[lies].frames, most);
        /* the nearest setting may be half a step above, for exposures below half a mains period would have bands */
        CHECK_MSG(a[lies].overshoot <= (law == LAW_FINE ? 0.1 : 0.05), "%s, D %u, %s, lies %d: overshoot %g EV",
                  law_name[law], delay, what, lies, a[lies].overshoot);
    }
    printf("%8d", a[0].frames);
}

static void check_settling(uint32_t flash_frames)
{
    static const double steps[] = {-6, -3, -1, 1, 3, 6};
    printf("frames to +-0.1 EV after a step of the light, delay_frames 4, flash_frames %u (and from white, black)\n",
           flash_frames);
    printf("%-12s D ", "gain");
    for (int i = 0; i < 6; i++)
        printf("%+5.0f EV", steps[i]);
    printf("   white   black  overshoot EV\n");
    for (int law = 0; law < LAWS; law++)
        for (uint32_t delay = 1; delay <= 4; delay++) {
            const int seen = (int)(delay + 1 + flash_frames), blind = 2 * (int)delay + 1;
            double overshoot = 0;
            printf("%-12s %u ", law_name[law], delay);
            for (int i = 0; i < 8; i++) {
                answer a[2];
                char what[16] = "white";
                for (int lies = 0; lies < 2; lies++)
                    a[lies] = i < 6 ? step(law, delay, steps[i], lies, flash_frames)
                                    : start(law, delay, i == 6 ? 10 : -10, lies, flash_frames);
                if (i != 6)
                    snprintf(what, sizeof what, i < 6 ? "%+g EV" : "black", i < 6 ? steps[i] : 0.0);
                const int most = i == 6 ? blind : i == 7 ? (int)delay + 1 : i == 5 && blind > seen ? blind : seen;
                answered(what, law, delay, a, most, i == 6 && most < (int)delay + 4 ? (int)delay + 4 : most);
                overshoot = fmax(overshoot, fmax(a[0].overshoot, a[1].overshoot));
            }
            printf("   %.3f\n", overshoot);
        }
}

/* At rest, with noise of the metering: how far the shown level wanders, and how often the camera is written to. */
static void check_rest(void)
{
    /* the filter reduces the deviation of white noise by the factor sqrt(k / (2 - k)); a range of more than eight such
     * deviations is not noise */
    const double k = 1 - exp(-1 / 30.0 / 0.8), most = 8 * 0.02 * sqrt(k / (2 - k));
    printf("at rest, 900 frames with 0.02 EV of metering noise\n%-12s D  p-p EV  RMS EV/frame  settings\n", "gain");
    for (int law = 0; law < LAWS; law++)
        for (uint32_t delay = 1; delay <= 4; delay++)
            for (int lies = 0; lies < 2; lies++) {
                double low = 100, high = -100, last = 0, sum = 0;
                int writes = 0;
                step(law, delay, 1.0, lies, 2);
                p.noise_ev = 0.02;
                for (int i = 0; i < 1000; i++) {
                    double shown;
                    plant_turn(&p, &sensor, &s, &shown);
                    CHECK(s.state == PUPIL_SENSOR_CONVERGED || i < 100);
                    if (i >= 100) {
                        low = fmin(low, shown);
                        high = fmax(high, shown);
                        sum += i > 100 ? (shown - last) * (shown - last) : 0;
                        writes += s.changed != 0;
                    }
                    last = shown;
                }
                if (!lies)
                    printf("%-12s %u  %.4f  %.5f       %d\n", law_name[law], delay, high - low, sqrt(sum / 899),
                           writes);
                CHECK_MSG(high - low <= most, "%s, D %u, lies %d: %g EV", law_name[law], delay, lies, high - low);
            }
}

/* A slow ramp over many settings: with any law and any two delays, no shown frame differs from the one before by more
 * than the ramp and the filter explain. */
static void check_seams(void)
{
    double worst = 0;
    for (int law = 0; law < LAWS; law++)
        for (uint32_t e = 1; e <= 4; e++)
            for (uint32_t g = 1; g <= 4; g++) {
                pupil_sensor_config c = plant_config(law);
                double last = 0;
                if ((law + (int)(e + g)) % check_every(2))
                    continue;
                c.highlight_ev = 0;            /* steps of the sensor alone, without highlights */
                c.mains_hz = law % 2 ? 50 : 0; /* exposures that jump by a factor of two, made up for by the gain */
                CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
                plant_open(&p, &sensor, log2(0.18 * 60), e);
                p.delay[1] = g;
                int settings = 0;
                for (int i = 0; i < 1600; i++) {
                    double shown, ramp = i < 100 ? 0 : i < 850 ? -0.002 : 0.002;
                    p.light_ev += ramp;
                    plant_turn(&p, &sensor, &s, &shown);
                    settings += s.changed != 0;
                    if (i > 100)
                        worst = fmax(worst, fabs(shown - last));
                    last = shown;
                }
                CHECK_MSG(settings > 8, "%s: only %d settings", law_name[law], settings);
            }
    printf("seams: %.5f EV from frame to frame at most, the light moving 0.002\n", worst);
    CHECK(worst <= 0.005);
}

/* Seconds, not frames: the filter at other frame rates. */
static void check_seconds(void)
{
    static const double rates[] = {10, 30, 120, 240};
    for (int i = 0; i < 4; i++)
        for (int drops = 0; drops < 2; drops++) {
            static pupil_stats stats;
            pupil_sensor_config c = plant_config(LAW_FINE);
            c.far_ev = 2.0;
            c.delay_frames = 1;
            c.exposure_max_s = c.frame_s = 1 / rates[i];
            CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
            CHECK(pupil_sensor_start(&sensor, 1.0 / 500, 1.0) == PUPIL_OK);
            plant_open(&p, &sensor, log2(0.18 * 500), 1);
            p.frame_s = 1 / rates[i];
            for (int k = 0; k < 3; k++) /* the first setting is not the filter's */
                plant_turn(&p, &sensor, &s, NULL);
            const double before = log2(s.total_s);
            p.light_ev -= 0.5;
            const int last = (int)(1.6 * rates[i]) - 1;
            for (int k = 0; k <= last; k++) {
                pupil_frame_info info = plant_next(&p, &stats);
                if (k == 0 || k == last || !drops || check_uniform() > 0.2)
                    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK);
                CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
                plant_ask(&p, &s);
            }
            /* 0.5 EV, less the rest after two time constants; the mean of a partly clipped scene is 0.01 lower */
            double way = log2(s.total_s) - before, wanted = 0.5 * (1 - exp(-2.0));
            CHECK_MSG(fabs(way - wanted) < 0.02, "%g fps: %g EV, %g is right", rates[i], way, wanted);
        }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_settling(2);
    check_settling(0);
    check_rest();
    check_seams();
    check_seconds();
    return check_end();
}
