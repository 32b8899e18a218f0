/* plain_text: no byte that controls a terminal, and every other character unchanged. */
#include "check.h"

#include "plain_text.h"

static void becomes(const char *text, const char *plain)
{
    char copy[64];
    snprintf(copy, sizeof copy, "%s", text);
    pupil_plain_text(copy);
    CHECK_MSG(strcmp(copy, plain) == 0, "'%s' became '%s'", plain, copy);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    becomes("", "");
    becomes("shot_001.exr ~", "shot_001.exr ~");
    becomes("\x1b[31mred\x7f\n\t", "?[31mred???");
    becomes("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 \xc2\xa0", "caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 \xc2\xa0");
    becomes("\x9b"
            "31m",
            "?31m"); /* CSI of eight-bit terminals */
    becomes("\xc2\x9b"
            "31m",
            "??31m"); /* the same in UTF-8 */
    becomes("\xc2\x80\xc2\x9f", "????");
    becomes("\xc3", "?"); /* cut */
    becomes("\xe2\x82", "??");
    becomes("\xc0\x9b\xe0\x80\x9b", "?????"); /* overlong */
    becomes("\xed\xa0\x80", "???");           /* half of a surrogate pair */
    becomes("\xf4\x90\x80\x80\xff", "?????"); /* beyond the last */
    for (int c = 1; c < 256; c++) {           /* alone */
        char one[2] = {(char)c, 0};
        pupil_plain_text(one);
        CHECK(c >= 0x20 && c < 0x7f ? one[0] == (char)c : one[0] == '?');
    }
    return check_end();
}
