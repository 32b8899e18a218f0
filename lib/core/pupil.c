/* The object's life, and the calls that take a frame: each checks everything before it touches anything. */
#include "object.h"

#include "base/versioned.h"
#include "image.h"
#include "read.h"

/* --- life --- */

/* From a configuration that has been checked. */
static void configure(pupil_object *object, const pupil_config *theirs)
{
    const pupil_config *config = &object->config;
    (void)pupil_config_read(&object->config, theirs);
    object->histogram = config->histogram || config->white_mode == PUPIL_WHITE_FOLLOW || config->trim_low > 0.0f ||
                        config->trim_high < 1.0f || config->curve != PUPIL_CURVE_REINHARD;
    object->level = pupil_level_choose(config->levels);
    pupil_primaries_derive(object);
}

static void forget(pupil_object *object)
{
    object->adaptation = (pupil_adaptation){0};
    object->progress = (pupil_in_progress){0};
    pupil_stats_clear(&object->stats);
}

int pupil_init(pupil_t *pupil, const pupil_config *config)
{
    if (!pupil || !config)
        return PUPIL_ERR_NULL;
    int error = pupil_config_check(config, 0);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    unsigned char *byte = (unsigned char *)pupil; /* bytes, whose writes no compiler moves behind those of members */
    for (size_t i = 0; i < sizeof *pupil; i++)
        byte[i] = 0; /* padding too: two objects with one history are equal byte for byte */
    object->magic = PUPIL_MAGIC;
    configure(object, config);
    forget(object);
    return PUPIL_OK;
}

int pupil_retune(pupil_t *pupil, const pupil_config *config)
{
    int error = pupil_object_check(pupil);
    if (!error)
        error = pupil_config_check(config, 0);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (object->progress.active)
        return PUPIL_ERR_ORDER;
    uint32_t old_law = object->config.law;
    configure(object, config);
    pupil_adaptation_change_law(object, old_law);
    if (object->config.white_mode != PUPIL_WHITE_FOLLOW)
        object->adaptation.white_seen = 0; /* a white from before would be stale when it follows again */
    if (object->config.curve == PUPIL_CURVE_REINHARD)
        object->adaptation.knots.seen = 0; /* so would the knots */
    return PUPIL_OK;
}

int pupil_get_level(const pupil_t *pupil, uint32_t *level)
{
    const int error = level ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (!error)
        *level = pupil_object_of_const(pupil)->level;
    return error;
}

int pupil_reset(pupil_t *pupil)
{
    int error = pupil_object_check(pupil);
    if (!error)
        forget(pupil_object_of(pupil));
    return error;
}

/* --- rows, on any thread --- */

static int read_in(const pupil_t *pupil, pupil_input *ours, const pupil_image_const *theirs)
{
    const int error = pupil_object_check(pupil);
    return error ? error : pupil_input_read(ours, theirs);
}

static int read_out(const pupil_image_const *in, pupil_output *ours, const pupil_image *theirs)
{
    const pupil_image *out = &ours->image;
    const int error = pupil_output_read(ours, theirs);
    if (error)
        return error;
    if (in->width == out->width && in->height == out->height)
        return PUPIL_OK;
    const int halved = in->width == 2 * out->width && in->height == 2 * out->height;
    return halved && pupil_pixel_is_mosaic(in->pixel) ? PUPIL_OK : PUPIL_ERR_SIZE;
}

/* Whether rows of a frame can be added to stats. */
static int check_place(const pupil_object *object, const pupil_image_const *rows, uint32_t first_row,
                       uint32_t frame_height, const pupil_stats *stats, const pupil_image *out)
{
    if (!stats)
        return PUPIL_ERR_NULL;
    if (!frame_height || frame_height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    if (first_row >= frame_height || rows->height > frame_height - first_row)
        return PUPIL_ERR_ROWS;
    uint32_t together = pupil_pixel_rows(rows->pixel);
    if (out && pupil_pixel_planes(out->pixel) > 1)
        together = 2 * (rows->height / out->height); /* pairs of out's rows, of which a mosaic may have half as many */
    if (first_row % together || (rows->height % together && first_row + rows->height != frame_height))
        return PUPIL_ERR_ROWS;
    if (pupil_pixel_is_mosaic(rows->pixel) && frame_height % 2)
        return PUPIL_ERR_SIZE;
    const int error = pupil_stats_check_sums(stats);
    if (error)
        return error;
    if (stats->rows && (stats->frame_height != frame_height || stats->has_histogram != object->histogram))
        return PUPIL_ERR_STATS;
    return stats->rows > frame_height - rows->height ? PUPIL_ERR_ROWS : PUPIL_OK;
}

int pupil_meter_rows(const pupil_t *pupil, const pupil_image_const *rows, uint32_t first_row, uint32_t frame_height,
                     pupil_stats *stats)
{
    pupil_input in;
    int error = read_in(pupil, &in, rows);
    if (!error)
        error = check_place(pupil_object_of_const(pupil), &in.image, first_row, frame_height, stats, 0);
    if (!error)
        pupil_work_rows(pupil_object_of_const(pupil), &in.image, first_row, frame_height, stats, 0, 0);
    return error;
}

int pupil_map_rows(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                   const pupil_image *out)
{
    pupil_input in;
    pupil_output to;
    pupil_tone by;
    int error = read_in(pupil, &in, rows);
    if (!error)
        error = read_out(&in.image, &to, out);
    if (!error)
        error = pupil_curve_read(&by, curve);
    if (!error)
        pupil_work_rows(pupil_object_of_const(pupil), &in.image, by.first_row, in.image.height, 0, &by, &to.image);
    return error;
}

int pupil_fused_rows(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows, uint32_t first_row,
                     uint32_t frame_height, const pupil_image *out, pupil_stats *stats)
{
    pupil_input in;
    pupil_output to;
    pupil_tone by;
    int error = read_in(pupil, &in, rows);
    if (!error)
        error = read_out(&in.image, &to, out);
    if (!error)
        error = pupil_curve_read(&by, curve);
    if (!error)
        error = check_place(pupil_object_of_const(pupil), &in.image, first_row, frame_height, stats, &to.image);
    if (!error)
        pupil_work_rows(pupil_object_of_const(pupil), &in.image, first_row, frame_height, stats, &by, &to.image);
    return error;
}

/* --- a frame as its rows arrive --- */

int pupil_frame_begin(pupil_t *pupil, uint32_t width, uint32_t height, const pupil_frame_info *info)
{
    pupil_frame_info own;
    int error = pupil_object_check(pupil);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (object->progress.active)
        return PUPIL_ERR_ORDER;
    if (!width || !height || width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    error = pupil_info_read(&own, info);
    if (error)
        return error;
    object->progress = (pupil_in_progress){.active = 1, .width = width, .height = height, .info = own};
    pupil_stats_clear(&object->stats);
    return PUPIL_OK;
}

int pupil_frame_rows(pupil_t *pupil, const pupil_image_const *rows, uint32_t first_row, const pupil_image *out)
{
    pupil_input in;
    pupil_curve curve;
    int error = read_in(pupil, &in, rows);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (!object->progress.active)
        return PUPIL_ERR_ORDER;
    if (in.image.width != object->progress.width)
        return PUPIL_ERR_SIZE;
    if (!out)
        return pupil_meter_rows(pupil, rows, first_row, object->progress.height, &object->stats);
    error = pupil_get_curve(pupil, &object->progress.info, &curve);
    if (!error)
        error = pupil_fused_rows(pupil, &curve, rows, first_row, object->progress.height, out, &object->stats);
    return error;
}

static void drop_frame(pupil_object *object)
{
    object->progress.active = 0;
    pupil_stats_clear(&object->stats); /* half a frame's statistics are of no use to anyone */
}

int pupil_frame_end(pupil_t *pupil)
{
    int error = pupil_object_check(pupil);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (!object->progress.active)
        return PUPIL_ERR_ORDER;
    if (object->stats.rows != object->progress.height) {
        drop_frame(object);
        return PUPIL_ERR_ROWS;
    }
    object->progress.active = 0;
    return pupil_adapt(pupil, &object->stats, &object->progress.info);
}

int pupil_frame_cancel(pupil_t *pupil)
{
    int error = pupil_object_check(pupil);
    if (error)
        return error;
    if (!pupil_object_of(pupil)->progress.active)
        return PUPIL_ERR_ORDER;
    drop_frame(pupil_object_of(pupil));
    return PUPIL_OK;
}

int pupil_get_stats_sized(const pupil_t *pupil, pupil_stats *stats, size_t stats_bytes)
{
    const int error = stats ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const pupil_stats *last = &pupil_object_of_const(pupil)->stats;
    return pupil_versioned_write(stats, stats_bytes, last, sizeof *last);
}

/* --- a frame at once --- */

int pupil_meter(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info)
{
    pupil_input from;
    pupil_frame_info own;
    int error = read_in(pupil, &from, in);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (object->progress.active)
        return PUPIL_ERR_ORDER;
    pupil_stats_clear(&object->stats);
    pupil_work_rows(object, &from.image, 0, from.image.height, &object->stats, 0, 0);
    return pupil_adapt(pupil, &object->stats, info ? &own : 0);
}

/* The frame has been checked. A function of its own, because the checks' curves and images would fill the stack,
 * too. */
static __attribute__((noinline)) void process(pupil_object *object, const pupil_image_const *in,
                                              const pupil_frame_info *info, const pupil_image *out)
{
    pupil_t *pupil = (pupil_t *)(void *)object;
    pupil_curve curve;
    pupil_tone by;
    const int fused = object->config.order == PUPIL_ORDER_FUSED && pupil_get_curve(pupil, info, &curve) == PUPIL_OK;
    if (fused)
        (void)pupil_curve_read(&by, &curve);
    pupil_stats_clear(&object->stats);
    pupil_work_rows(object, in, 0, in->height, &object->stats, fused ? &by : 0, fused ? out : 0);
    const int error = pupil_adapt(pupil, &object->stats, info);
    PUPIL_ASSERT(!error); /* our own metering is never refused */
    if (fused)
        return;
    if (pupil_get_curve(pupil, info, &curve) != PUPIL_OK)
        (void)pupil_curve_before_light(pupil, &curve);
    (void)pupil_curve_read(&by, &curve);
    pupil_work_rows(object, in, 0, in->height, 0, &by, out);
}

int pupil_process(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info, const pupil_image *out)
{
    pupil_input from;
    pupil_output to;
    pupil_frame_info own;
    int error = read_in(pupil, &from, in);
    if (!error)
        error = read_out(&from.image, &to, out);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    pupil_object *object = pupil_object_of(pupil);
    if (object->progress.active)
        return PUPIL_ERR_ORDER;
    process(object, &from.image, info ? &own : 0, &to.image);
    return PUPIL_OK;
}
