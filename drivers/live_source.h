/* drivers/live_source.h: what live cameras of all kinds have in common: a source (source.h) that says what the camera
 * is, counts what it did not hand out, and has a table of operations. V4L2's is in drivers/live, libcamera's in
 * drivers/libcamera. live/live.h opens one of them and has the calls for its users.
 *
 * Exposure and gain are a pupil_camera, which has a table of its own (pupil/camera_controls.h).
 */
#ifndef PUPIL_DRIVERS_LIVE_SOURCE_H
#define PUPIL_DRIVERS_LIVE_SOURCE_H

#include "pupil/camera_controls.h"
#include "pupil/error.h"
#include "source.h"

/* Which camera: as pupil list prints it, and as pupil_live_open takes it (path). */
typedef struct pupil_live_identity {
    char path[272], name[64], driver[32], bus[256];
} pupil_live_identity;

#define PUPIL_LIVE_MOST_RATES 16

/* One size, or, where the steps are not 0, all sizes from the first to the largest by steps. */
typedef struct pupil_live_size {
    uint32_t width, height, max_width, max_height, step_width, step_height;
    double fps[PUPIL_LIVE_MOST_RATES]; /* rising; unknown: none */
    uint32_t rates;
    int fps_between; /* fps[0] and fps[1] are the ends of a range */
} pupil_live_size;

typedef struct pupil_live_mode {
    uint32_t fourcc; /* V4L2's */
    char name[12];   /* the fourcc's, as --format takes it */
    int read;        /* natively, or as a JPEG */
    int compressed;
    char description[32];
    pupil_live_size *size; /* NULL: the driver does not report them (sensors behind a media graph) */
    uint32_t sizes;
} pupil_live_mode;

typedef struct pupil_live_modes {
    pupil_live_mode *mode;
    uint32_t count;
} pupil_live_modes;

/* Adds an empty mode, or a size to a mode; NULL: no memory. */
pupil_live_mode *pupil_live_modes_add(pupil_live_modes *modes);
pupil_live_size *pupil_live_mode_add_size(pupil_live_mode *mode);
void pupil_live_modes_free(pupil_live_modes *modes);
/* "640x480@30,15 1280x720@30": the sizes of a mode in one line; cut where it does not fit. */
void pupil_live_mode_text(const pupil_live_mode *mode, char *text, size_t text_bytes);

#define PUPIL_LIVE_CONTROLS 96

/* A control as the camera has it, before anything is touched. */
typedef struct pupil_live_control {
    uint32_t id;
    char name[32];
    double value, least, most, step, usual; /* value NaN: the camera does not say it */
    char item[32];                          /* of a menu: the value's name; "" */
    int on_sensor;                          /* the sensor's own */
    int automatic;                          /* it steers by itself now, and is turned off while pupil steers */
} pupil_live_control;

/* What a camera says of itself. Nothing is set. */
typedef struct pupil_live_offers {
    pupil_live_identity is;
    pupil_live_modes modes;
    pupil_live_control control[PUPIL_LIVE_CONTROLS];
    unsigned controls;
    unsigned gain_place;              /* the gain's number among them, from 1; 0: there is none */
    int has_entity, has_sensor;       /* an entity feeds the node; the table of sensors has it */
    char entity[64], entity_path[64]; /* as media-ctl names it; its node */
    pupil_camera_sensor sensor;
} pupil_live_offers;

/* What streams. Texts are never NULL. */
typedef struct pupil_live_stream {
    char format[12];
    uint32_t width, height, buffers;
    const char *colorspace, *transfer, *encoding, *range; /* V4L2's names of the camera's answers */
    const char *reading;                                  /* how the CPU reads frames: "mapped", "copied", ... */
    char heap[64];                                        /* the dma-heap that they are in; "" */
    double read_bytes_s, ordinary_bytes_s;                /* of that memory, and of ordinary memory; 0: not measured */
} pupil_live_stream;

/* What was not handed out, and why. */
typedef struct pupil_live_counts {
    uint64_t frames;    /* handed out */
    uint64_t lost;      /* missing in the driver's numbers */
    uint64_t repeated;  /* with the number of the frame before (drivers that do not count) */
    uint64_t flagged;   /* damaged, as the driver says */
    uint64_t cut;       /* with fewer bytes than the format has */
    uint64_t damaged;   /* JPEGs that cannot be decoded */
    uint64_t late;      /* left out for a newer one */
    uint64_t unstamped; /* without a monotonic timestamp: the moment they were taken from the driver is used */
    uint64_t reopened;  /* times that the camera was opened again */
    uint64_t cancelled; /* libcamera: requests that came back without a frame */
    uint64_t restarted; /* libcamera: times that the stream was started again because requests did not come back */
} pupil_live_counts;

/* Frames that wait for a program that is late. */
typedef enum pupil_live_late {
    PUPIL_LIVE_LATE_KEPT = -1,    /* each is handed out: for recordings */
    PUPIL_LIVE_LATE_BY_PACE = 0,  /* each is handed out, until the program turns out to be slower than the camera */
    PUPIL_LIVE_LATE_LEFT_OUT = 1, /* the newest is handed out, the others count as late */
} pupil_live_late;

/* Whether a program is slower than the camera: then every frame would wait in a full queue, and frames would be lost
 * nevertheless. All zero: it is not. */
typedef struct pupil_live_pace {
    uint32_t marks; /* bit k: k frames ago, frames had been lost or left out */
    uint32_t is_behind;
} pupil_live_pace;

/* A frame is handed out, before which `missing` were lost by the driver or left out. Two such frames of the last eight
 * set is_behind, and sixteen others in a row clear it: a single delay does neither. */
static inline void pupil_live_pace_frame(pupil_live_pace *pace, uint64_t missing)
{
    pace->marks = pace->marks << 1 | (missing > 0);
    const uint32_t recent = pace->marks & 0xff, more_than_one = recent & (recent - 1);
    pace->is_behind = pace->is_behind ? (pace->marks & 0xffff) != 0 : more_than_one != 0;
}

/* Of several frames that wait, only the newest is wanted. */
static inline int pupil_live_wants_newest(int late, const pupil_live_pace *pace)
{
    return late == PUPIL_LIVE_LATE_LEFT_OUT || (late == PUPIL_LIVE_LATE_BY_PACE && pace->is_behind);
}

/* Which moment a frame's timestamp is of. */
typedef enum pupil_live_stamp {
    PUPIL_LIVE_STAMP_NONE = 0,     /* no stamp, or by another clock: the moment it was taken from the driver */
    PUPIL_LIVE_STAMP_END_OF_FRAME, /* its last byte had arrived */
    PUPIL_LIVE_STAMP_START_OF_EXPOSURE
} pupil_live_stamp;

/* Of the frame that is out. Latency is now less stamp_ns. */
typedef struct pupil_live_times {
    uint32_t stamp;   /* a pupil_live_stamp */
    int64_t stamp_ns; /* CLOCK_MONOTONIC */
    int64_t taken_ns; /* when it came from the driver; of the source's clock */
} pupil_live_times;

/* The operations of a live source; live/live.h says what each is for. */
typedef struct pupil_live_ops {
    int64_t (*now_ns)(const pupil_source *source);
    int (*is_linear)(const pupil_source *source);
    int (*find_sensor)(const pupil_source *source, pupil_camera_sensor *sensor);
    void (*mark)(pupil_source *source);
    int (*give_back)(pupil_source *source, pupil_why *why);
    void (*restore)(const pupil_source *source);
} pupil_live_ops;

/* The first member of every live source. */
typedef struct pupil_live {
    pupil_source base;
    const pupil_live_ops *ops;
    const struct pupil_live_system *system; /* that it was opened on (live/live.h); NULL: the machine's own */
    pupil_live_identity is;
    pupil_live_stream stream; /* another one after the camera was opened again (counts.reopened) */
    pupil_live_counts counts;
    pupil_live_times times;
    pupil_camera *camera; /* NULL: no controls (now), and why */
    pupil_why no_controls;
    pupil_why remark; /* what its user should know of this kind of camera; "" */
} pupil_live;

#endif
