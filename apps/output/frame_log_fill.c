#include "frame_log_fill.h"

#include <math.h>

#include "display_stats.h"

static const char *state_word(uint32_t state)
{
    static const char *const words[] = {"empty", "adapting", "settled", "limited", "locked"};
    return state < sizeof words / sizeof words[0] ? words[state] : "?";
}

static const char *reason_word(uint32_t reason)
{
    static const char *const words[] = {
        [PUPIL_REASON_NONE] = "",
        [PUPIL_REASON_EV_MIN] = "ev_min",
        [PUPIL_REASON_EV_MAX] = "ev_max",
        [PUPIL_REASON_NO_LIGHT] = "no_light",
        [PUPIL_REASON_CLOCK_BACK] = "clock_back",
        [PUPIL_REASON_LOCK] = "lock",
        [PUPIL_REASON_CLOCK_UNIT] = "clock_unit",
        [PUPIL_REASON_HIGHLIGHTS] = "highlights",
        [PUPIL_REASON_NO_HISTOGRAM] = "no_histogram",
        [PUPIL_REASON_AMPLIFICATION] = "amplification",
        [PUPIL_REASON_RANGE] = "range",
    };
    return reason < sizeof words / sizeof words[0] ? words[reason] : "?";
}

/* W; 0: no white point. */
static double white_of(const pupil_curve *curve)
{
    return curve->inverse_white_squared > 0.0f ? 1.0 / sqrt((double)curve->inverse_white_squared) : 0.0;
}

/* log2 of the scene's light over the frame's values, if exposure and gain are known. */
static double light_of(const frame_pipeline *p, double scale)
{
    const float adapted = p->adapted.scale;
    if (!p->has_light || adapted == (float)scale || !(adapted > 0.0f) || !(scale > 0.0))
        return 0.0;
    return log2((double)adapted / scale);
}

/* As the picture's own figures count it: a display cannot show less than code 0, nor more than white. */
static double log2_shown(const pupil_curve *curve, double scaled)
{
    const double shown = scaled * (1.0 + scaled * (double)curve->inverse_white_squared) / (1.0 + scaled);
    return log2(fmin(fmax(shown, DISPLAY_STATS_LOWEST), 1.0));
}

double frame_log_aimed_level(const frame_pipeline *p, double key)
{
    const pupil_stats *stats = &p->stats;
    pupil_exposure e;
    double sum = 0.0;
    if (!stats->has_histogram || !stats->weight || pupil_get_exposure(&p->pupil, &e))
        return exp2(log2_shown(&p->curve, key));
    const double mean = e.metered_ev - e.flicker_ev - light_of(p, e.scale); /* in the frame's units */
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++) {
        const double step = (i % PUPIL_HISTOGRAM_BINS_PER_STOP + 0.5) / PUPIL_HISTOGRAM_BINS_PER_STOP;
        const double light = ldexp(1.0 + step, i / PUPIL_HISTOGRAM_BINS_PER_STOP + PUPIL_HISTOGRAM_MIN_EV);
        if (stats->bin[i])
            sum += (double)stats->bin[i] * log2_shown(&p->curve, light * key * exp2(-mean));
    }
    return exp2(sum / (double)stats->weight);
}

frame_log_entry frame_log_fill(const frame_pipeline *p, const pupil_frame *frame, int with_figures)
{
    pupil_exposure e;
    display_stats d = {0};
    const pupil_stats *stats = &p->stats;
    const double pixels = stats->pixels ? (double)stats->pixels : 1.0;
    if (with_figures) {
        const pupil_image_const display = pupil_image_as_const(p->display);
        d = display_stats_measure(&display);
    }
    frame_log_entry entry = {
        .name = frame->name,
        .time_s = (double)frame->info.timestamp_ns * 1e-9,
        .scale = (double)p->curve.scale,
        .white = white_of(&p->curve),
        .output_level = d.level,
        .black_share = (double)stats->black / pixels,
        .clipped_share = (double)stats->clipped / pixels,
        .bad_share = (double)stats->bad / pixels,
        .output_black_share = d.black_share,
        .output_white_share = d.white_share,
    };
    pupil_get_exposure(&p->pupil, &e);
    entry.key =
        e.frames ? e.scale * exp2(e.adapted_ev - e.held_back_ev) : p->config.key * exp2(p->config.ev_compensation);
    if (with_figures)
        entry.aimed_level = frame_log_aimed_level(p, entry.key);
    entry.dt_s = e.dt_s;
    entry.metered_ev = e.metered_ev;
    entry.held_back_ev = e.held_back_ev;
    entry.adapted_ev = e.adapted_ev;
    entry.state = state_word(e.state);
    entry.reason = reason_word(e.reason);
    pupil_stats_quantile(stats, 0.01, &entry.p01_ev); /* refused without light: then the quantiles stay 0 */
    pupil_stats_quantile(stats, 0.50, &entry.p50_ev);
    pupil_stats_quantile(stats, 0.99, &entry.p99_ev);
    const double light_ev = light_of(p, e.scale);
    entry.p01_ev += light_ev;
    entry.p50_ev += light_ev;
    entry.p99_ev += light_ev;
    return entry;
}
