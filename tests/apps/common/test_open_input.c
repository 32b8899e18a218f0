/* Names of inputs: which driver is asked, as shown by its messages. */
#include "check.h"

#include "common/open_input.h"

static void check_refused(const char *input, const char *other, const char *sentence)
{
    const pupil_source_options options = {0};
    const char *inputs[2] = {input, other};
    pupil_why why = {""};
    pupil_source *source = NULL;
    CHECK_MSG(open_input(inputs, other ? 2 : 1, &options, &source, &why) == PUPIL_SOURCE_FAILED &&
                  strstr(why.text, sentence),
              "%s: %s", input, why.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_refused("v4l2:/dev/null", NULL, "/dev/null: is not a video device; a camera is /dev/video0 or its like");
    check_refused("v4l2:99999", NULL, "99999: the number of a video node is 255 at most");
    check_refused("v4l2:", NULL, "no camera was named");
    check_refused("/dev/video-none", NULL, "/dev/video-none: is not there; 'pupil list' shows the cameras that are");
    check_refused("/dev/v4l/by-id/none", NULL,
                  "/dev/v4l/by-id/none: is not there; 'pupil list' shows the cameras that are");
    check_refused("v4l2:0", "a.png", "v4l2:0: a camera must be the only input");
    check_refused("a.png", "/dev/video0", "/dev/video0: a camera must be the only input");
    check_refused("synth:walk", "v4l2:0", "synth:walk: a synthetic scene must be the only input");
    return check_end();
}
