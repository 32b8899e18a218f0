/* The report of a simulated loop: a line for each frame, and a summary. */
#include <math.h>
#include <string.h>

#include "file/common/pending.h"
#include "refuse.h"
#include "sim.h"

static void line(FILE *out, const sim_run *run, const fixture_loop_frame *f)
{
    const fixture_truth *t = &f->truth;
    fprintf(out,
            "{\"time_s\":%.6f,\"frame\":%llu,\"dropped\":%u,\"light_ev\":%.6f,\"exposure_s\":%.9g,\"gain\":%.9g,"
            "\"digital\":%.9g,\"told_exposure_s\":%.9g,\"told_gain\":%.9g,\"asked_exposure_s\":%.9g,"
            "\"asked_gain\":%.9g,\"asked_digital\":%.9g,\"error_ev\":%.6f,\"shown_ev\":%.6f,\"band_ev\":%.6f,"
            "\"clipped\":%.6f",
            t->time_s, (unsigned long long)t->frame, t->dropped, t->light_ev, t->exposure_s, t->gain, t->digital,
            f->info.exposure_s, f->info.gain, f->setting.exposure_s, f->setting.gain, f->setting.digital, f->error_ev,
            f->shown_ev, t->band_ev, t->clipped_share);
    if (!run->options->loop.law->total)
        fprintf(out, ",\"state\":\"%s\",\"reason\":\"%s\",\"slope\":%.4f,\"exposure_delay\":%u,\"gain_delay\":%u",
                pupil_sensor_state_name(f->setting.state), pupil_sensor_reason_name(f->setting.reason),
                f->setting.slope, f->setting.delay[FIXTURE_EXPOSURE], f->setting.delay[FIXTURE_GAIN]);
    fputs("}\n", out);
}

int sim_stats(const sim_run *run, pupil_why *why)
{
    const char *path = run->options->stats;
    const int standard = strcmp(path, "-") == 0;
    pupil_pending pending = {0};
    FILE *out = stdout;
    if (!standard) {
        if (pupil_pending_file(&pending, path, run->options->overwrite, why))
            return -1;
        out = pupil_pending_stream(&pending);
    }
    for (size_t i = 0; out && i < run->frames; i++)
        line(out, run, &run->frame[i]);
    int failed = !out || ferror(out);
    failed |= out && (standard ? fflush(out) : fclose(out)) != 0;
    if (failed)
        pupil_refuse(why, "%s: the statistics cannot be written", standard ? "standard output" : path);
    else if (!standard)
        failed = pupil_pending_commit(&pending, why);
    pupil_pending_discard(&pending);
    return failed ? -1 : 0;
}

static int cycles(const fixture_loop_sum *sum)
{
    return sum->swings >= 4;
}

static void verdict(const fixture_verdict *v, FILE *out)
{
    if (!v->is_evaluated)
        fprintf(out, "verdict     not: the light is not still for long enough at the end\n");
    else if (v->wrong)
        fprintf(out, "verdict     wrong: %s\n", v->text);
    else if (v->side)
        fprintf(out, "verdict     right, but the aim is %s than the camera can\n", v->side > 0 ? "brighter" : "darker");
    else
        fprintf(out, "verdict     right: shown %+.3f EV from the aim at most, the sensor %+.3f from its best setting\n",
                v->shown_ev, v->sensor_ev);
    if (v->is_evaluated)
        fprintf(out,
                "reach       aim %.3f to %.3f, best level %.3f to %.3f, this one %.3f; all settings %.2f to %.2f EV\n",
                v->reach.aim_low, v->reach.aim_high, fmin(v->reach.best_low, v->reach.best_high),
                fmax(v->reach.best_low, v->reach.best_high), v->level_ev, v->reach.least, v->reach.most);
}

void sim_summary(const sim_run *run, FILE *out)
{
    const sim_options *o = run->options;
    const fixture_loop_sum *s = &run->sum;
    const fixture_loop_frame *last = &run->frame[run->frames - 1];
    char camera[1024];
    fixture_plant_text(&o->loop.plant, camera, sizeof camera);
    if (o->json) {
        fprintf(out,
                "{\"controller\":\"%s\",\"frames\":%zu,\"settle_frames\":%ld,\"overshoot_ev\":%.6f,\"aim_ev\":%.6f,"
                "\"rest_pp_ev\":%.6f,\"shown_pp_ev\":%.6f,\"shown_rms_ev\":%.6f,\"asked_pp_ev\":%.6f,\"evaluated\":%d,"
                "\"wrong\":\"%s\",\"swings\":%u}\n",
                o->loop.law->name, run->frames, s->settle_frames, s->overshoot_ev, s->aim_ev, s->rest_pp_ev,
                s->shown_pp_ev, s->shown_rms_ev, s->asked_pp_ev, run->verdict.is_evaluated, run->verdict.text,
                s->swings);
        return;
    }
    fprintf(out, "controller  %s, which expects controls to act after %u frames\n", o->loop.law->name,
            o->loop.sensor.delay_frames);
    fprintf(out, "camera      %s\n", *camera ? camera : "as usual");
    fprintf(out, "light       %s\n", o->light);
    if (s->settle_frames >= 0)
        fprintf(out, "settled     %ld frames after frame %zu, the last at which something happened\n", s->settle_frames,
                run->event);
    else
        fprintf(out, "settled     never\n");
    fprintf(out, "overshoot   %.4f EV\n", s->overshoot_ev);
    fprintf(
        out,
        "at rest     %.3f EV off the key; the exposure moves within %.4f EV, the picture within %.4f, by %.5f EV RMS "
        "from frame to frame\n",
        s->aim_ev, s->rest_pp_ev, s->shown_pp_ev, s->shown_rms_ev);
    fprintf(out, "swings      %u of 0.1 EV or more, of the exposure that is asked for, in the last %zu frames%s\n",
            s->swings, run->rest, cycles(s) ? ": a limit cycle" : "");
    verdict(&run->verdict, out);
    fprintf(out, "at the end  %.6g s, gain %.4g, digital %.4f", last->truth.exposure_s, last->truth.gain,
            last->truth.digital);
    if (!o->loop.law->total)
        fprintf(out, "; %s", pupil_sensor_state_name(last->setting.state));
    if (!o->loop.law->total && last->setting.reason)
        fprintf(out, ", %s", pupil_sensor_reason_name(last->setting.reason));
    fputc('\n', out);
    if (!o->loop.law->total)
        fprintf(out, "found       slope %.3f, delay %u/%u (exposure/gain; 0: not seen yet), mains %u Hz%s\n",
                last->setting.slope, last->setting.delay[FIXTURE_EXPOSURE], last->setting.delay[FIXTURE_GAIN],
                last->setting.mains_hz,
                o->mains_hz != PUPIL_SENSOR_MAINS_AUTO ? " (configured)"
                : last->setting.mains_hz               ? ""
                                                       : " (none seen)");
}
