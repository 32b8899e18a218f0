/* Structs of every size in the calls that need a context; tests/core/test_versions.c has the others. */
#include "session.h"

enum { MARK = 0xa5, MORE = 24 };

static session s;

static int all_are(const void *memory, size_t from, size_t end, int value)
{
    const unsigned char *byte = memory;
    for (size_t i = from; i < end; i++)
        if (byte[i] != value)
            return 0;
    return 1;
}

/* The start of `part` must have `bytes` bytes of `whole`, which has whole_bytes. */
static void check_part(const char *name, const void *part, size_t part_bytes, size_t bytes, const void *whole,
                       size_t whole_bytes)
{
    const size_t common = bytes < whole_bytes ? bytes : whole_bytes;
    uint32_t size_bytes;
    memcpy(&size_bytes, part, sizeof size_bytes);
    CHECK_MSG(size_bytes == bytes, "%s, %zu bytes: size_bytes %u", name, bytes, size_bytes);
    CHECK_MSG(memcmp((const char *)part + 4, (const char *)whole + 4, common - 4) == 0, "%s, %zu bytes: the content",
              name, bytes);
    CHECK_MSG(all_are(part, common, bytes, 0), "%s, %zu bytes: what the library does not know", name, bytes);
    CHECK_MSG(all_are(part, bytes, part_bytes, MARK), "%s, %zu bytes: written beyond", name, bytes);
}

static void check_status(void)
{
    pupil_gles_status whole;
    _Alignas(16) unsigned char part[sizeof whole + 2 * MORE];
    CHECK(pupil_gles_get_status(&s.gles, &whole) == PUPIL_OK);
    for (size_t n = 0; n <= sizeof whole + MORE; n++) {
        memset(part, MARK, sizeof part);
        const int error = pupil_gles_get_status_sized(&s.gles, (pupil_gles_status *)(void *)part, n);
        CHECK(error == (n < 4 ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK));
        if (n < 4)
            CHECK(all_are(part, 0, sizeof part, MARK));
        else
            check_part("status", part, sizeof part, n, &whole, sizeof whole);
    }
}

/* Meters a frame and collects it into structs of these sizes. */
static void collect(size_t stats_bytes, size_t info_bytes)
{
    static _Alignas(16) unsigned char stats[sizeof(pupil_stats) + 2 * MORE];
    _Alignas(16) unsigned char info[sizeof(pupil_frame_info) + 2 * MORE];
    pupil_stats *const to = (pupil_stats *)(void *)stats;
    pupil_frame_info *const of = (pupil_frame_info *)(void *)info;
    const pupil_frame_info given = session_info(3);
    static pupil_stats whole;
    CHECK(pupil_gles_meter(&s.gles, &given) == PUPIL_OK);
    CHECK(pupil_gles_collect(&s.gles, UINT64_C(10000000000), &whole, NULL) == PUPIL_OK);
    CHECK(pupil_gles_meter(&s.gles, &given) == PUPIL_OK);
    memset(stats, MARK, sizeof stats);
    memset(info, MARK, sizeof info);
    CHECK(pupil_gles_collect_sized(&s.gles, 0, to, 3, of, info_bytes) == PUPIL_ERR_SIZE_BYTES);
    CHECK(pupil_gles_collect_sized(&s.gles, 0, to, stats_bytes, of, 3) == PUPIL_ERR_SIZE_BYTES);
    CHECK(all_are(stats, 0, sizeof stats, MARK) && all_are(info, 0, sizeof info, MARK));
    const int error = pupil_gles_collect_sized(&s.gles, UINT64_C(10000000000), to, stats_bytes, of, info_bytes);
    CHECK(error == PUPIL_OK);
    check_part("stats", stats, sizeof stats, stats_bytes, &whole, sizeof whole);
    check_part("info", info, sizeof info, info_bytes, &given, sizeof given);
}

static void check_target(void)
{
    const pupil_curve curve = {.scale = 1.0f};
    const size_t first = sizeof s.target;
    _Alignas(16) unsigned char room[sizeof s.target + MORE];
    for (uint32_t n = 0; n <= sizeof room; n++) {
        const pupil_gles_target *const target = (const pupil_gles_target *)(const void *)room;
        const int fits = !n || n >= first;
        memset(room, 0, sizeof room);
        memcpy(room, &s.target, first);
        memcpy(room, &n, sizeof n);
        CHECK(pupil_gles_map(&s.gles, &curve, target) == (fits ? PUPIL_OK : PUPIL_ERR_SIZE_BYTES));
        if (n <= first)
            continue;
        room[n - 1] = 1;
        CHECK(pupil_gles_map(&s.gles, &curve, target) == PUPIL_ERR_SIZE_BYTES);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const int status = gl_test_open(&s.test, PUPIL_GLES_BEST);
    if (status)
        return status;
    gl_shim_begin(1);
    session_set(&s, PUPIL_GLES_ES30, PUPIL_GLES_ADAPT_CPU, PUPIL_PIXEL_RGBA32F, 16, 4);
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
    CHECK(session_upload(&s, 3) == PUPIL_OK);
    check_status();
    for (size_t n = 8; n <= MORE; n += 8) {
        collect(n, n);
        collect(sizeof(pupil_stats) - n, sizeof(pupil_frame_info) - n);
        collect(sizeof(pupil_stats) + n, sizeof(pupil_frame_info) + n);
    }
    collect(sizeof(pupil_stats), sizeof(pupil_frame_info));
    check_target();
    pupil_gles_close(&s.gles);
    session_free(&s);
    gl_test_close(&s.test);
    return check_end();
}
