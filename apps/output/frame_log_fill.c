#include "frame_log_fill.h"

#include <math.h>

#include "display_stats.h"

static const char *state_word(uint32_t state)
{
    static const char *const words[] = {"empty", "adapting", "settled", "limited", "locked"};
    return state < sizeof words / sizeof words[0] ? words[state] : "?";
}

/* W; 0 where there is no white point. */
static double white_of(const pupil_curve *curve)
{
    return curve->inverse_white_squared > 0.0f ? 1.0 / sqrt((double)curve->inverse_white_squared) : 0.0;
}

/* log2 of the scene's light over the frame's values, where exposure and gain are known. */
static double light_of(const pupil_t *pupil, const pupil_frame_info *info, double scale)
{
    pupil_curve curve;
    if (pupil_get_curve(pupil, info, &curve) || curve.scale == (float)scale || !(curve.scale > 0.0f) || !(scale > 0.0))
        return 0.0;
    return log2((double)curve.scale / scale);
}

frame_log_entry frame_log_fill(const pupil_t *pupil, const pupil_config *config, const pupil_stats *stats,
                               const pupil_curve *curve, const pupil_frame *frame, const pupil_image_const *display)
{
    pupil_exposure e;
    const display_stats d = display ? display_stats_measure(display) : (display_stats){0};
    const double pixels = stats->pixels ? (double)stats->pixels : 1.0;
    frame_log_entry record = {
        .name = frame->name,
        .time_s = (double)frame->info.timestamp_ns * 1e-9,
        .scale = (double)curve->scale,
        .white = white_of(curve),
        .output_level = d.level,
        .key = config->key * exp2(config->ev_compensation),
        .black_share = (double)stats->black / pixels,
        .clipped_share = (double)stats->clipped / pixels,
        .bad_share = (double)stats->bad / pixels,
        .output_black_share = d.black_share,
        .output_white_share = d.white_share,
    };
    pupil_get_exposure(pupil, &e);
    record.dt_s = e.dt_s;
    record.metered_ev = e.metered_ev;
    record.adapted_ev = e.adapted_ev;
    record.state = state_word(e.state);
    pupil_stats_quantile(stats, 0.01, &record.p01_ev); /* refused without light: the quantiles stay 0 */
    pupil_stats_quantile(stats, 0.50, &record.p50_ev);
    pupil_stats_quantile(stats, 0.99, &record.p99_ev);
    const double light_ev = light_of(pupil, &frame->info, e.scale);
    record.p01_ev += light_ev;
    record.p50_ev += light_ev;
    record.p99_ev += light_ev;
    return record;
}
