/* Which camera a user means, and what there is. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "libcamera_private.h"
#include "refuse.h"

#define MOST_CAMERAS 32
#define ABSENT                                                                                                         \
    "this program was built without libcamera (PUPIL_LIBCAMERA=OFF, or its package was not there: libcamera-dev)"

typedef struct one {
    char id[256], model[64];
} one;

typedef struct all {
    one camera[MOST_CAMERAS];
    size_t count;
} all;

static void found(void *closure, const char *id, const char *model)
{
    all *a = closure;
    if (a->count == MOST_CAMERAS)
        return;
    one *to = &a->camera[a->count++];
    snprintf(to->id, sizeof to->id, "%s", id);
    snprintf(to->model, sizeof to->model, "%s", model);
}

/* The one camera that `which` means, and how many it may mean. A whole id comes before a whole model, and that before a
 * part of either: imx708 is not imx708_wide. */
static size_t fits(const all *a, const char *which, const one **only)
{
    char *end = NULL;
    const unsigned long number = strtoul(which, &end, 10);
    size_t count = 0, of_model = 0;
    const one *whole = NULL;
    if (!*which || (isdigit((unsigned char)*which) && !*end)) { /* a number, from 0 */
        *only = number < a->count ? &a->camera[number] : NULL;
        return number < a->count;
    }
    for (size_t i = 0; i < a->count; i++) {
        const one *c = &a->camera[i];
        const int is_it = strcmp(c->id, which) == 0;
        if (!is_it && !strcasestr(c->id, which) && !strcasestr(c->model, which))
            continue;
        *only = c;
        count++;
        if (is_it)
            return 1;
        if (strcasecmp(c->model, which) == 0) {
            whole = c;
            of_model++;
        }
    }
    if (!of_model)
        return count;
    *only = whole;
    return of_model;
}

static int choose(const all *a, const char *which, char *id, size_t id_bytes, pupil_why *why)
{
    const one *only = NULL;
    const size_t count = a->count ? fits(a, which, &only) : 0;
    if (count != 1)
        return pupil_refuse(why, "%s%s: %s", PUPIL_LIBCAMERA_PREFIX, which,
                            !a->count ? "libcamera has no camera"
                            : count   ? "more than one camera has this name ('pupil list' and 'cam --list' show them)"
                                      : "libcamera has no such camera ('pupil list' and 'cam --list' show them)");
    snprintf(id, id_bytes, "%s", only->id);
    return 0;
}

static int list(const pupil_libcamera_layer *layer, all *a, pupil_why *why)
{
    *a = (all){.count = 0};
    return layer->list(layer->context, found, a, why);
}

int libcamera_find(const pupil_libcamera_layer *layer, const char *which, char *id, size_t id_bytes, pupil_why *why)
{
    all a;
    if (!layer)
        return pupil_refuse(why, "%s%s: " ABSENT, PUPIL_LIBCAMERA_PREFIX, which);
    return list(layer, &a, why) ? -1 : choose(&a, which, id, id_bytes, why);
}

int libcamera_is_webcam(const char *id)
{
    const size_t length = strlen(id);
    const char *end = length > 10 ? id + length - 10 : "";
    if (*end != '-' || end[5] != ':')
        return 0;
    for (int i = 1; i < 10; i++)
        if (i != 5 && !isxdigit((unsigned char)end[i]))
            return 0;
    return 1;
}

static int read_offers(const pupil_libcamera_layer *layer, const char *id, pupil_live_offers *offers, pupil_why *why)
{
    void *camera = layer->open(layer->context, id, why);
    if (!camera)
        return -1;
    snprintf(offers->is.path, sizeof offers->is.path, PUPIL_LIBCAMERA_PREFIX "%.255s", id);
    snprintf(offers->is.driver, sizeof offers->is.driver, "libcamera");
    snprintf(offers->is.bus, sizeof offers->is.bus, "%.255s", id);
    const int failed = layer->offers(camera, offers, NULL);
    layer->close(camera);
    if (failed)
        return pupil_refuse(why, "%s: not enough memory", offers->is.path);
    pupil_why unused;
    if (!libcamera_is_webcam(id)) {
        offers->has_entity = 1;
        snprintf(offers->entity, sizeof offers->entity, "%.63s", offers->is.name);
        offers->has_sensor = pupil_camera_find_sensor(NULL, offers->is.name, &offers->sensor, &unused) == 1;
    }
    return 0;
}

int pupil_libcamera_cameras(const pupil_libcamera_layer *layer, pupil_libcamera_seen *seen, void *closure,
                            pupil_why *why)
{
    all a;
    if (!layer)
        return 0;
    if (list(layer, &a, why))
        return -1;
    int ends = 0;
    for (size_t i = 0; i < a.count && !ends; i++) {
        pupil_live_offers *offers = calloc(1, sizeof *offers);
        pupil_why words = {""};
        if (!offers)
            return pupil_refuse(why, "not enough memory");
        const int failed = read_offers(layer, a.camera[i].id, offers, &words);
        ends = seen(closure, failed ? NULL : &offers->is, failed ? NULL : &offers->modes, words.text);
        pupil_live_modes_free(&offers->modes);
        free(offers);
    }
    return 0;
}

int pupil_libcamera_offers_read(pupil_live_offers *offers, const pupil_libcamera_layer *layer, const char *which,
                                pupil_why *why)
{
    char id[256];
    return libcamera_find(layer, which, id, sizeof id, why) ? -1 : read_offers(layer, id, offers, why);
}
