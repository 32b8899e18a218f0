/* pupil list, with fake cameras. */
#include "check.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <linux/videodev2.h>

#include "fake_v4l2/fake_v4l2.h"
#include "list/list.h"

typedef struct listing {
    int status;
    char *out, *err;
    size_t out_bytes, err_bytes;
} listing;

static listing list_of(const pupil_v4l2_system *system, int json)
{
    listing l = {0};
    FILE *out = open_memstream(&l.out, &l.out_bytes), *err = open_memstream(&l.err, &l.err_bytes);
    if (!out || !err)
        abort();
    l.status = list_cameras(&(pupil_live_system){.v4l2 = system}, json, out, err);
    fclose(out);
    fclose(err);
    return l;
}

static void done(listing *l)
{
    free(l->out);
    free(l->err);
}

static void test_text(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.only_format = V4L2_PIX_FMT_YUYV;
    config.twin = 1;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    listing l = list_of(fake_v4l2_system(fake), 0);
    CHECK(l.status == 0 && *l.err == 0); /* metadata and output nodes are neither cameras nor errors */
    CHECK_MSG(strcmp(l.out, "/dev/video0  Fake Camera  fake  fake:1  YUYV 64x48@30,15,5 32x24@30,15,5 320x240@30,15,5\n"
                            "/dev/video3  Fake Camera, the other  fake  fake:2  YUYV 64x48@30,15,5 32x24@30,15,5 "
                            "320x240@30,15,5\n") == 0,
              "%s", l.out);
    done(&l);
    CHECK(fake_v4l2_holds(fake).files == 0);
    fake_v4l2_free(fake);

    config.only_format = 0;
    config.no_sizes = 1;
    fake = fake_v4l2_new(&config);
    l = list_of(fake_v4l2_system(fake), 0);
    CHECK_MSG(strncmp(l.out, "/dev/video0  Fake Camera  fake  fake:1  MJPG; YUYV; NV12; GREY; Y10; ", 69) == 0, "%s",
              l.out);
    done(&l);
    fake_v4l2_free(fake);

    config.only_format = V4L2_PIX_FMT_H264;
    config.twin = 0;
    fake = fake_v4l2_new(&config);
    l = list_of(fake_v4l2_system(fake), 0);
    CHECK_MSG(strcmp(l.out, "/dev/video0  Fake Camera  fake  fake:1  [H264]\n") == 0, "%s", l.out);
    done(&l);
    l = list_of(fake_v4l2_system(fake), 1);
    CHECK_MSG(strstr(l.out, "\"read\":\tfalse"), "%s", l.out);
    done(&l);
    fake_v4l2_free(fake);

    config.absent = 1;
    config.twin = 0;
    fake = fake_v4l2_new(&config);
    l = list_of(fake_v4l2_system(fake), 0);
    CHECK(l.status == 0 && strcmp(l.out, "no camera\n") == 0);
    CHECK_MSG(strstr(l.err, "pupil list: no /dev/video* gives pictures") && strstr(l.err, "pupil replay synth:"), "%s",
              l.err);
    done(&l);
    l = list_of(fake_v4l2_system(fake), 1);
    CHECK(l.status == 0 && strcmp(l.out, "[]\n") == 0);
    done(&l);
    fake_v4l2_free(fake);
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text ? text : "(none)";
}

static void test_json(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    listing l = list_of(fake_v4l2_system(fake), 1);
    cJSON *list = cJSON_Parse(l.out);
    CHECK(l.status == 0 && cJSON_GetArraySize(list) == 1);
    const cJSON *camera = cJSON_GetArrayItem(list, 0), *formats = cJSON_GetObjectItem(camera, "formats");
    CHECK(strcmp(text_of(camera, "path"), "/dev/video0") == 0 && strcmp(text_of(camera, "name"), "Fake Camera") == 0);
    CHECK(strcmp(text_of(camera, "driver"), "fake") == 0 && strcmp(text_of(camera, "bus"), "fake:1") == 0);
    CHECK(cJSON_GetArraySize(formats) == 49);
    const cJSON *format;
    cJSON_ArrayForEach(format, formats)
    {
        const char *fourcc = text_of(format, "fourcc");
        const cJSON *sizes = cJSON_GetObjectItem(format, "sizes"), *size = cJSON_GetArrayItem(sizes, 0);
        const int any = strcmp(fourcc, "Y16") == 0;
        CHECK(cJSON_IsTrue(cJSON_GetObjectItem(format, "read")));
        CHECK_MSG(cJSON_GetArraySize(sizes) == (any ? 1 : 3), "%s", fourcc);
        CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(size, "width")) == (any ? 32 : 64));
        CHECK(cJSON_HasObjectItem(size, "max_width") == any);
        const cJSON *fps = cJSON_GetObjectItem(size, "fps");
        CHECK(cJSON_GetArraySize(fps) == 3 && cJSON_GetNumberValue(cJSON_GetArrayItem(fps, 2)) == 30);
    }
    cJSON_Delete(list);
    done(&l);
    fake_v4l2_free(fake);
}

/* After any fault there is a status, and a sentence if something is missing from the list. */
static void test_faults(void)
{
    for (unsigned long at = 1, met = 1; met; at++) {
        fake_v4l2_config config;
        fake_faults faults;
        fake_v4l2_config_default(&config);
        config.only_format = V4L2_PIX_FMT_YUYV;
        fake_v4l2 *fake = fake_v4l2_new(&config);
        fake_faults_begin(&faults, fake_v4l2_system(fake), at, 1, EIO);
        listing l = list_of(&faults.system, 0);
        met = faults.failed != NULL;
        CHECK(l.status == (at == 1));
        CHECK_MSG(*l.out || (at == 1 && strstr(l.err, "pupil list: /dev: cannot be listed: ")), "%lu: %s", at, l.err);
        CHECK_MSG(!strstr(l.out, "no camera") ||
                      (strcmp(l.out, "no camera that can be asked\n") == 0 && strstr(l.err, "pupil list: /dev/video")),
                  "%lu: %s", at, l.out);
        CHECK(fake_v4l2_holds(fake).files == 0);
        done(&l);
        fake_v4l2_free(fake);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_text();
    test_json();
    test_faults();
    return check_end();
}
