/* OpenEXR through its C library: which part, which channels, and whether the header can be believed. The library
 * (3.1.5) trusts headers further than a damaged file deserves, hence the checks before anything is decoded. */
#include "read_exr.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* No compression of the library shrinks further: PXR24 drops a quarter of a float's bits before deflate (1032:1). */
#define MAX_RATIO 1400

typedef struct memory_file {
    const uint8_t *bytes;
    size_t size;
    exr_plan *plan;
} memory_file;

static int64_t on_size(exr_const_context_t file, void *user)
{
    (void)file;
    return (int64_t)((memory_file *)user)->size;
}

static int64_t on_read(exr_const_context_t file, void *user, void *buffer, uint64_t count, uint64_t offset,
                       exr_stream_error_func_ptr_t error)
{
    const memory_file *m = user;
    (void)file;
    (void)error;
    if (offset >= m->size)
        return 0;
    if (count > m->size - offset)
        count = m->size - offset;
    memcpy(buffer, m->bytes + offset, (size_t)count);
    return (int64_t)count;
}

/* The first complaint is the one nearest to the cause. */
static void on_error(exr_const_context_t file, exr_result_t code, const char *message)
{
    void *user = NULL;
    (void)code;
    if (file && exr_get_user_data(file, &user) == EXR_ERR_SUCCESS && user) {
        exr_plan *plan = ((memory_file *)user)->plan;
        if (!*plan->library_says)
            snprintf(plan->library_says, sizeof plan->library_says, "%s", message);
    }
}

/* The channel "prefix.name" (or plain "name" where there is no prefix), or -1. */
static int find_channel(const exr_attr_chlist_t *list, const char *prefix, size_t prefix_length, const char *name)
{
    for (int c = 0; c < list->num_channels; c++) {
        const char *given = list->entries[c].name.str;
        if (strncmp(given, prefix, prefix_length) == 0 && strcmp(given + prefix_length, name) == 0)
            return c;
    }
    return -1;
}

/* Whether the channels under this prefix make a picture; fills in kind and places. */
static int match_layer(exr_plan *plan, const char *prefix, size_t length)
{
    static const char *const names[EXR_KIND_COUNT][3] = {
        {"R", "G", "B"}, {"X", "Y", "Z"}, {"Y", NULL, NULL}, {"RY", "Y", "BY"}};
    static const exr_kind order[] = {EXR_KIND_RGB, EXR_KIND_XYZ, EXR_KIND_LUMA_CHROMA, EXR_KIND_LUMINANCE};
    for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
        int complete = 1;
        for (int i = 0; i < 3; i++) {
            const char *name = names[order[k]][i];
            plan->channel[i] = name ? find_channel(plan->channels, prefix, length, name) : -1;
            complete = complete && (!name || plan->channel[i] >= 0);
        }
        if (complete && order[k] == EXR_KIND_XYZ && length)
            return 0; /* X, Y and Z of a layer are normals or positions, so this Y is not grey */
        if (complete) {
            plan->kind = order[k];
            return 1;
        }
    }
    return 0;
}

static int no_picture(exr_plan *plan)
{
    char names[200] = "";
    size_t used = 0;
    for (int c = 0; c < plan->channels->num_channels && used < sizeof names; c++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%.60s", c ? ", " : "",
                                 plan->channels->entries[c].name.str);
    return pupil_still_fail(plan->why,
                            "has the channels %s%s; R, G and B, or Y (with RY and BY), are needed, in one layer, or X, "
                            "Y and Z",
                            names, used >= sizeof names ? "..." : "");
}

static int check_sampling(exr_plan *plan)
{
    plan->step_x = plan->step_y = 1;
    for (int i = 0; i < 3; i++) {
        const exr_attr_chlist_entry_t *entry;
        if (plan->channel[i] < 0)
            continue;
        entry = plan->channels->entries + plan->channel[i];
        if (plan->kind == EXR_KIND_LUMA_CHROMA && i != 1) {
            if (i == 2 && (entry->x_sampling != plan->step_x || entry->y_sampling != plan->step_y))
                return pupil_still_fail(plan->why, "has RY and BY channels of different sampling");
            plan->step_x = entry->x_sampling;
            plan->step_y = entry->y_sampling;
            if (plan->step_x < 1 || plan->step_x > 2 || plan->step_y < 1 || plan->step_y > 2)
                return pupil_still_fail(plan->why, "has chroma sampled every %d x %d pixels; 1 and 2 are read",
                                        plan->step_x, plan->step_y);
        } else if (entry->x_sampling != 1 || entry->y_sampling != 1) {
            return pupil_still_fail(plan->why,
                                    "has channel %.60s sampled every %d x %d pixels; it must be there for each",
                                    entry->name.str, entry->x_sampling, entry->y_sampling);
        }
    }
    return 0;
}

static int choose_channels(exr_plan *plan)
{
    const exr_attr_chlist_t *list = plan->channels;
    int found = match_layer(plan, "", 0);
    for (int c = 0; c < list->num_channels && !found; c++) {
        const char *dot = strrchr(list->entries[c].name.str, '.');
        found = dot && match_layer(plan, list->entries[c].name.str, (size_t)(dot + 1 - list->entries[c].name.str));
    }
    return found ? check_sampling(plan) : no_picture(plan);
}

static int check_windows(exr_plan *plan, size_t size)
{
    const exr_attr_box2i_t *data = &plan->data, *display = &plan->display;
    uint64_t width = (uint64_t)((int64_t)data->max.x - data->min.x + 1), bytes = 0;
    uint64_t height = (uint64_t)((int64_t)data->max.y - data->min.y + 1);
    if (data->max.x < data->min.x || data->max.y < data->min.y || display->max.x < display->min.x ||
        display->max.y < display->min.y)
        return pupil_still_fail(plan->why, "has an empty data window or display window");
    if (pupil_still_size_ok(width, height, plan->why))
        return -1;
    if (data->max.x < display->min.x || data->min.x > display->max.x || data->max.y < display->min.y ||
        data->min.y > display->max.y)
        return pupil_still_fail(plan->why, "has a data window wholly outside its display window");
    for (int c = 0; c < plan->channels->num_channels; c++)
        bytes += plan->channels->entries[c].pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    /* Subsampled channels count in full: the bound need not be tight. */
    if (width * height / MAX_RATIO * (plan->kind == EXR_KIND_LUMA_CHROMA ? 1 : bytes) > size)
        return pupil_still_fail(plan->why,
                                "the header promises %" PRIu64 " x %" PRIu64 " pixels, more than %zu bytes can hold",
                                width, height, size);
    return 0;
}

/* Checks what the library assumes of the layout of chunks. */
static int check_layout(exr_plan *plan)
{
    int32_t lines = 0;
    uint32_t tile_x = 0, tile_y = 0;
    exr_tile_level_mode_t level;
    exr_tile_round_mode_t round;
    if (!plan->is_tiled) {
        /* With a "tiles" attribute in a scanline part the library has no chunk height, and divides by 0. */
        if (exr_get_scanlines_per_chunk(plan->file, plan->part, &lines) != EXR_ERR_SUCCESS || lines < 1 || lines > 256)
            return pupil_exr_fail(plan, "has a scanline part that is described as tiled");
        return 0;
    }
    if (exr_get_tile_descriptor(plan->file, plan->part, &tile_x, &tile_y, &level, &round) != EXR_ERR_SUCCESS ||
        tile_x < 1 || tile_y < 1 || tile_x > PUPIL_MAX_SIDE_PX || tile_y > PUPIL_MAX_SIDE_PX)
        return pupil_exr_fail(plan, "has no sane tile size");
    return 0;
}

/* Whether R, G and B are X, Y and Z. Their equal-energy white then belongs to the axes and not to the scene, so they
 * are read like channels named X, Y and Z: only then does the OpenEXR project's XYZ.exr equal its Rec709.exr. */
static int are_axes_of_xyz(const pupil_chromaticities *given)
{
    static const double axes[8] = {1, 0, 0, 1, 0, 0, 1. / 3, 1. / 3};
    for (int i = 0; i < 8; i++)
        if (!(fabs(given->xy[i] - axes[i]) < 1e-3))
            return 0;
    return 1;
}

static void read_colour(exr_plan *plan)
{
    exr_attr_chromaticities_t c;
    if (plan->kind == EXR_KIND_XYZ) {
        pupil_still_colour_from_xyz(&plan->colour);
    } else if (exr_attr_get_chromaticities(plan->file, plan->part, "chromaticities", &c) != EXR_ERR_SUCCESS) {
        pupil_still_colour_from(NULL, &plan->colour);
    } else {
        const pupil_chromaticities given = {
            {c.red_x, c.red_y, c.green_x, c.green_y, c.blue_x, c.blue_y, c.white_x, c.white_y}};
        if (are_axes_of_xyz(&given))
            pupil_still_colour_from_xyz(&plan->colour);
        else
            pupil_still_colour_from(&given, &plan->colour);
    }
    if (plan->kind == EXR_KIND_LUMINANCE) /* grey is the same in any primaries: it stays as it is, to the bit */
        plan->colour.convert = 0;
    *plan->library_says = 0; /* a file without chromaticities is no fault */
}

/* Makes the plan for one part. 0; -1 and a sentence where it cannot be read. */
static int plan_part(exr_plan *plan, int part, size_t size)
{
    exr_storage_t storage;
    plan->part = part;
    if (exr_get_storage(plan->file, part, &storage) != EXR_ERR_SUCCESS)
        return pupil_exr_fail(plan, "has a damaged header");
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return pupil_still_fail(plan->why, "holds deep data; flatten it first, only flat pictures are read");
    plan->is_tiled = storage == EXR_STORAGE_TILED;
    if (exr_get_data_window(plan->file, part, &plan->data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(plan->file, part, &plan->display) != EXR_ERR_SUCCESS ||
        exr_get_channels(plan->file, part, &plan->channels) != EXR_ERR_SUCCESS ||
        exr_get_compression(plan->file, part, &plan->compression) != EXR_ERR_SUCCESS)
        return pupil_exr_fail(plan, "has a damaged header");
    if (choose_channels(plan) || check_windows(plan, size) || check_layout(plan))
        return -1;
    read_colour(plan);
    return 0;
}

static int read_parts(exr_plan *plan, pupil_still *still, size_t size)
{
    int parts = 0;
    if (exr_get_count(plan->file, &parts) != EXR_ERR_SUCCESS || parts < 1)
        return pupil_exr_fail(plan, "has no part");
    for (int part = 0; part < parts; part++) {
        pupil_why *why = plan->why;
        int result;
        if (part > 0) /* the first part's sentence is the one to keep */
            plan->why = NULL;
        result = plan_part(plan, part, size);
        plan->why = why;
        if (result == 0)
            return pupil_exr_read_pixels(plan, still);
    }
    return -1;
}

int pupil_read_exr(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    exr_plan plan = {.why = why};
    memory_file memory = {bytes, size, &plan};
    exr_context_initializer_t initial = EXR_DEFAULT_CONTEXT_INITIALIZER;
    int result;
    initial.error_handler_fn = on_error;
    initial.user_data = &memory;
    initial.read_fn = on_read;
    initial.size_fn = on_size;
    initial.max_image_width = initial.max_image_height = (int)PUPIL_MAX_SIDE_PX;
    initial.max_tile_width = initial.max_tile_height = (int)PUPIL_MAX_SIDE_PX;
    /* A file without its chunk table was not finished: it is refused, not guessed at. */
    initial.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    if (exr_start_read(&plan.file, "memory", &initial) != EXR_ERR_SUCCESS)
        return pupil_exr_fail(&plan, "has a damaged OpenEXR header");
    *plan.library_says = 0; /* warnings about what the library read nevertheless */
    result = read_parts(&plan, still, size);
    exr_finish(&plan.file);
    return result;
}
