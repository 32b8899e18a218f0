#include "media.h"

#include <ctype.h>
#include <errno.h>
#include <linux/media.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bus.h"
#include "refuse.h"

#define MOST_MEDIA 32   /* media devices that are looked at */
#define MOST_STEPS 32   /* entities between a node and its sensor; a graph could be a ring */
#define MOST_ITEMS 4096 /* of one kind in a graph; more is no camera's */

typedef struct graph {
    const pupil_v4l2_system *system;
    char path[32];
    struct media_v2_topology t;
    struct media_v2_entity *entities;
    struct media_v2_interface *interfaces;
    struct media_v2_pad *pads;
    struct media_v2_link *links;
} graph;

static void free_graph(graph *g)
{
    free(g->entities);
    free(g->interfaces);
    free(g->pads);
    free(g->links);
    g->entities = NULL;
    g->interfaces = NULL;
    g->pads = NULL;
    g->links = NULL;
}

static int read_graph(graph *g, int fd)
{
    g->t = (struct media_v2_topology){0};
    if (pupil_v4l2_ioctl(g->system, fd, MEDIA_IOC_G_TOPOLOGY, &g->t) != 0 || g->t.num_entities > MOST_ITEMS ||
        g->t.num_interfaces > MOST_ITEMS || g->t.num_pads > MOST_ITEMS || g->t.num_links > MOST_ITEMS)
        return -1;
    g->entities = calloc(g->t.num_entities + 1, sizeof *g->entities);
    g->interfaces = calloc(g->t.num_interfaces + 1, sizeof *g->interfaces);
    g->pads = calloc(g->t.num_pads + 1, sizeof *g->pads);
    g->links = calloc(g->t.num_links + 1, sizeof *g->links);
    if (!g->entities || !g->interfaces || !g->pads || !g->links)
        return -1;
    g->t.ptr_entities = (uintptr_t)g->entities;
    g->t.ptr_interfaces = (uintptr_t)g->interfaces;
    g->t.ptr_pads = (uintptr_t)g->pads;
    g->t.ptr_links = (uintptr_t)g->links;
    const struct media_v2_topology room = g->t;
    /* If it has grown in between, the kernel reports ENOSPC, or more than there is room for. */
    if (pupil_v4l2_ioctl(g->system, fd, MEDIA_IOC_G_TOPOLOGY, &g->t) != 0)
        return -1;
    return g->t.num_entities > room.num_entities || g->t.num_interfaces > room.num_interfaces ||
                   g->t.num_pads > room.num_pads || g->t.num_links > room.num_links
               ? -1
               : 0;
}

static const struct media_v2_entity *entity_of(const graph *g, uint32_t id)
{
    for (uint32_t i = 0; i < g->t.num_entities; i++)
        if (g->entities[i].id == id)
            return &g->entities[i];
    return NULL;
}

static const struct media_v2_pad *pad_of(const graph *g, uint32_t id)
{
    for (uint32_t i = 0; i < g->t.num_pads; i++)
        if (g->pads[i].id == id)
            return &g->pads[i];
    return NULL;
}

static int is_kind(const struct media_v2_link *link, uint32_t kind)
{
    return link->flags >> 28 == kind >> 28; /* as MEDIA_LNK_FL_LINK_TYPE, which shifts into the sign bit */
}

/* The entity behind a video node. */
static const struct media_v2_entity *entity_of_node(const graph *g, uint32_t major, uint32_t minor)
{
    for (uint32_t i = 0; i < g->t.num_interfaces; i++) {
        const struct media_v2_interface *n = &g->interfaces[i];
        if (n->intf_type != MEDIA_INTF_T_V4L_VIDEO || n->devnode.major != major || n->devnode.minor != minor)
            continue;
        for (uint32_t k = 0; k < g->t.num_links; k++)
            if (is_kind(&g->links[k], MEDIA_LNK_FL_INTERFACE_LINK) && g->links[k].source_id == n->id)
                return entity_of(g, g->links[k].sink_id);
    }
    return NULL;
}

/* The node of a subdevice. */
static int path_of_entity(const graph *g, uint32_t entity, char *path, size_t path_bytes)
{
    char name[48];
    for (uint32_t k = 0; k < g->t.num_links; k++)
        for (uint32_t i = 0; i < g->t.num_interfaces; i++) {
            const struct media_v2_interface *n = &g->interfaces[i];
            if (!is_kind(&g->links[k], MEDIA_LNK_FL_INTERFACE_LINK) || g->links[k].sink_id != entity ||
                g->links[k].source_id != n->id || n->intf_type != MEDIA_INTF_T_V4L_SUBDEV)
                continue;
            if (g->system->device_name(g->system->context, n->devnode.major, n->devnode.minor, name, sizeof name))
                return -1;
            snprintf(path, path_bytes, "/dev/%s", name);
            return 0;
        }
    return -1;
}

/* The link that feeds an entity, with its pads; NULL: none. An enabled link takes precedence. */
static const struct media_v2_link *feed_of(const graph *g, uint32_t entity, const struct media_v2_pad **source,
                                           const struct media_v2_pad **sink)
{
    const struct media_v2_link *found = NULL;
    for (uint32_t k = 0; k < g->t.num_links; k++) {
        const struct media_v2_link *link = &g->links[k];
        const struct media_v2_pad *from = pad_of(g, link->source_id), *to = pad_of(g, link->sink_id);
        if (!is_kind(link, MEDIA_LNK_FL_DATA_LINK) || !from || !to || to->entity_id != entity ||
            (found && !(link->flags & MEDIA_LNK_FL_ENABLED)))
            continue;
        found = link;
        *source = from;
        *sink = to;
        if (link->flags & MEDIA_LNK_FL_ENABLED)
            return found;
    }
    return found;
}

/* --- the graph of a node --- */

static void note_media(void *closure, const char *name)
{
    unsigned char *there = closure;
    char *end;
    if (strncmp(name, "media", 5) != 0 || !isdigit((unsigned char)name[5]))
        return;
    const unsigned long number = strtoul(name + 5, &end, 10);
    if (!*end && number < MOST_MEDIA)
        there[number] = 1;
}

/* The graph that the node belongs to, and its entity there; NULL: none. The graph is to be freed either way. */
static const struct media_v2_entity *find_graph(const pupil_v4l2_device *device, graph *g)
{
    unsigned char there[MOST_MEDIA] = {0};
    uint32_t major, minor;
    *g = (graph){.system = device->system};
    const pupil_v4l2_system *system = g->system;
    if (system->device_number(system->context, device->fd, &major, &minor) != 0 ||
        system->list(system->context, "/dev", note_media, there) != 0)
        return NULL;
    for (int i = 0; i < MOST_MEDIA; i++) {
        if (!there[i])
            continue;
        snprintf(g->path, sizeof g->path, "/dev/media%d", i);
        const int fd = system->open(system->context, g->path);
        if (fd < 0)
            continue;
        const int error = read_graph(g, fd);
        system->close(system->context, fd);
        const struct media_v2_entity *entity = error ? NULL : entity_of_node(g, major, minor);
        if (entity)
            return entity;
        free_graph(g);
    }
    return NULL;
}

int pupil_v4l2_media_sensor(const pupil_v4l2_device *device, pupil_v4l2_sensor *sensor, pupil_why *why)
{
    graph g;
    const struct media_v2_pad *source, *sink;
    const struct media_v2_entity *entity = find_graph(device, &g), *node = entity;
    int error = -1;
    for (int i = 0; entity && i < MOST_STEPS; i++) {
        const struct media_v2_link *link = feed_of(&g, entity->id, &source, &sink);
        if (link && link->flags & MEDIA_LNK_FL_ENABLED)
            entity = entity_of(&g, source->entity_id);
        else
            break;
    }
    if (!entity || entity == node)
        pupil_refuse(why, "%s: %s", device->path,
                     entity ? "nothing is linked to it in its media graph ('media-ctl -p' shows it)"
                            : "has no media graph");
    else if (path_of_entity(&g, entity->id, sensor->path, sizeof sensor->path))
        pupil_refuse(why, "%s: %.63s has no node of its own (/dev/v4l-subdev*)", g.path, entity->name);
    else {
        snprintf(sensor->media, sizeof sensor->media, "%s", g.path);
        snprintf(sensor->entity, sizeof sensor->entity, "%.63s", entity->name);
        error = 0;
    }
    free_graph(&g);
    return error;
}

/* --- why it does not start --- */

/* Gets or (try) proposes the format of a pad, which changes nothing; -1: its entity has no node, or does not report it.
 */
static int pad_format(const graph *g, const struct media_v2_pad *pad, int try, struct v4l2_mbus_framefmt *format)
{
    char path[64];
    struct v4l2_subdev_format f = {.which = try ? V4L2_SUBDEV_FORMAT_TRY : V4L2_SUBDEV_FORMAT_ACTIVE,
                                   .pad = pad->index,
                                   .format = try ? *format : (struct v4l2_mbus_framefmt){0}};
    if (path_of_entity(g, pad->entity_id, path, sizeof path))
        return -1;
    const int fd = g->system->open(g->system->context, path);
    if (fd < 0)
        return -1;
    const int error = pupil_v4l2_ioctl(g->system, fd, try ? VIDIOC_SUBDEV_S_FMT : VIDIOC_SUBDEV_G_FMT, &f);
    g->system->close(g->system->context, fd);
    *format = f.format;
    return error;
}

static int is_same(const struct v4l2_mbus_framefmt *a, const struct v4l2_mbus_framefmt *b)
{
    return a->width == b->width && a->height == b->height && a->code == b->code;
}

static int would_take(const graph *g, const struct media_v2_pad *pad, const struct v4l2_mbus_framefmt *format)
{
    struct v4l2_mbus_framefmt f = *format;
    return pad_format(g, pad, 1, &f) == 0 && is_same(&f, format);
}

static int mend_link(const graph *g, const struct media_v2_pad *source, const struct media_v2_pad *sink, char *mend,
                     size_t mend_bytes)
{
    const struct media_v2_entity *from = entity_of(g, source->entity_id), *to = entity_of(g, sink->entity_id);
    if (!from || !to)
        return -1;
    snprintf(mend, mend_bytes,
             "the link from %.63s to %.63s is off; this turns it on: media-ctl -d %s -l "
             "'\"%.63s\":%u -> \"%.63s\":%u [1]'",
             from->name, to->name, g->path, from->name, source->index, to->name, sink->index);
    return 0;
}

/* "SRGGB10_1X10/640x480" */
static void tell_format(const struct v4l2_mbus_framefmt *f, char text[48])
{
    snprintf(text, 48, "%s/%ux%u", pupil_v4l2_bus_name(f->code).text, f->width, f->height);
}

/* Compares what comes to the node with what it is set to. */
static int mend_node(const graph *g, const struct media_v2_pad *source, const pupil_v4l2_format *node, char *mend,
                     size_t mend_bytes)
{
    const struct media_v2_entity *from = entity_of(g, source->entity_id);
    struct v4l2_mbus_framefmt sent;
    const uint32_t code = pupil_v4l2_bus_code(node->fourcc);
    char is[48], should[48];
    if (!from || pad_format(g, source, 0, &sent) ||
        (sent.width == node->width && sent.height == node->height && (!code || sent.code == code)))
        return -1;
    tell_format(&sent, is);
    sent.width = node->width;
    sent.height = node->height;
    sent.code = code ? code : sent.code;
    tell_format(&sent, should);
    snprintf(mend, mend_bytes,
             "%.63s sends %s, and %ux%u of %s are asked for; ask for what is sent, or change it: "
             "media-ctl -d %s -V '\"%.63s\":%u [fmt:%s]'",
             from->name, is, node->width, node->height, pupil_v4l2_fourcc_name(node->fourcc).text, g->path, from->name,
             source->index, should);
    return 0;
}

/* Compares the ends of a link between two subdevices: the end that accepts the other's format is to change; the
 * receiving one is tried first. */
static int mend_ends(const graph *g, const struct media_v2_pad *source, const struct media_v2_pad *sink, char *mend,
                     size_t mend_bytes)
{
    const struct media_v2_entity *from = entity_of(g, source->entity_id), *to = entity_of(g, sink->entity_id);
    struct v4l2_mbus_framefmt sent, taken;
    char sent_text[48], taken_text[48];
    if (!from || !to || pad_format(g, source, 0, &sent) || pad_format(g, sink, 0, &taken) || is_same(&sent, &taken))
        return -1;
    tell_format(&sent, sent_text);
    tell_format(&taken, taken_text);
    const int back = !would_take(g, sink, &sent) && would_take(g, source, &taken);
    snprintf(mend, mend_bytes,
             "%.63s sends %s, but %.63s takes %s; this mends it: media-ctl -d %s -V "
             "'\"%.63s\":%u [fmt:%s]'",
             from->name, sent_text, to->name, taken_text, g->path, back ? from->name : to->name,
             back ? source->index : sink->index, back ? taken_text : sent_text);
    return 0;
}

/* All links that are on: a sensor that feeds several branches starts only if all of them agree. */
static int mend_branches(const graph *g, char *mend, size_t mend_bytes)
{
    int found = -1;
    for (uint32_t k = 0; found && k < g->t.num_links; k++) {
        const struct media_v2_link *link = &g->links[k];
        const struct media_v2_pad *source = pad_of(g, link->source_id), *sink = pad_of(g, link->sink_id);
        if (is_kind(link, MEDIA_LNK_FL_DATA_LINK) && link->flags & MEDIA_LNK_FL_ENABLED && source && sink)
            found = mend_ends(g, source, sink, mend, mend_bytes);
    }
    return found;
}

int pupil_v4l2_media_mend(const pupil_v4l2_device *device, const pupil_v4l2_format *format, char *mend,
                          size_t mend_bytes)
{
    graph g;
    const struct media_v2_pad *source, *sink;
    const struct media_v2_entity *entity = find_graph(device, &g), *node = entity;
    int found = -1;
    for (int i = 0; entity && found && i < MOST_STEPS; i++) {
        const struct media_v2_link *link = feed_of(&g, entity->id, &source, &sink);
        if (!link)
            break;
        if (link->flags & MEDIA_LNK_FL_ENABLED)
            found = entity == node ? mend_node(&g, source, format, mend, mend_bytes)
                                   : mend_ends(&g, source, sink, mend, mend_bytes);
        else
            found = mend_link(&g, source, sink, mend, mend_bytes);
        entity = entity_of(&g, source->entity_id);
    }
    if (node && found)
        found = mend_branches(&g, mend, mend_bytes);
    if (node && found) {
        snprintf(mend, mend_bytes,
                 "what leads to it in %s agrees; its sensor may feed another node that is set to another "
                 "format ('media-ctl -d %s -p', 'v4l2-ctl --get-fmt-video')",
                 g.path, g.path);
        found = 0;
    }
    free_graph(&g);
    return found;
}
