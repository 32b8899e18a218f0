/* What --white-balance, --matrix and --black-level take, and what they say to the rest. */
#include "check.h"
#include "options/colour_options.h"

typedef int option(pupil_colour_options *, const char *, pupil_why *);

static void refused(option *take, const char *text, const char *name, const char *right)
{
    pupil_colour_options o = {0};
    pupil_why why = {""};
    CHECK_MSG(take(&o, text, &why) == -1, "'%s' is taken", text);
    CHECK_MSG(strncmp(why.text, name, strlen(name)) == 0 && strstr(why.text, text) && strstr(why.text, right), "%s",
              why.text);
    CHECK(o.balance == PUPIL_COLOUR_AUTO && o.matrix == PUPIL_COLOUR_AUTO && o.black == PUPIL_COLOUR_AUTO);
}

int main(int argc, char **argv)
{
    pupil_colour_options o = {0};
    pupil_why why;
    check_begin(argc, argv);
    CHECK(colour_option_balance(&o, "off", &why) == 0 && o.balance == PUPIL_COLOUR_OFF);
    CHECK(colour_option_balance(&o, "auto", &why) == 0 && o.balance == PUPIL_COLOUR_AUTO);
    CHECK(colour_option_balance(&o, "1.9,1,1.6", &why) == 0 && o.balance == PUPIL_COLOUR_GIVEN);
    CHECK(o.given_balance[0] == 1.9f && o.given_balance[1] == 1 && o.given_balance[2] == 1.6f);
    CHECK(colour_option_matrix(&o, "off", &why) == 0 && o.matrix == PUPIL_COLOUR_OFF);
    CHECK(colour_option_matrix(&o, "1,2,3,4,5,6,-7,8,9.5", &why) == 0 && o.matrix == PUPIL_COLOUR_GIVEN);
    CHECK(o.given_matrix[0] == 1 && o.given_matrix[6] == -7 && o.given_matrix[8] == 9.5f);
    CHECK(colour_option_matrix(&o, "auto", &why) == 0 && o.matrix == PUPIL_COLOUR_AUTO);
    CHECK(colour_option_black(&o, "64", &why) == 0 && o.black == PUPIL_COLOUR_GIVEN && o.given_black == 64);
    CHECK(colour_option_black(&o, "off", &why) == 0 && o.black == PUPIL_COLOUR_OFF);

    static const char *const balances[] = {"",        "warm",   "1,2",    "1,2,3,4", "1,2,0",
                                           "1,2,nan", "1,2,3x", "-1,1,1", "1;1;1"};
    for (size_t i = 0; i < sizeof balances / sizeof balances[0]; i++)
        refused(colour_option_balance, balances[i], "--white-balance", "1.9,1,1.6");
    static const char *const matrices[] = {
        "", "on", "1,2,3", "1,2,3,4,5,6,7,8,9,10", "0,0,0,0,0,0,0,0,0", "1,2,3,4,5,6,7,8,17", "1,2,3,4,5,6,7,8,inf"};
    for (size_t i = 0; i < sizeof matrices / sizeof matrices[0]; i++)
        refused(colour_option_matrix, matrices[i], "--matrix", "9 numbers from -16 to 16");
    static const char *const blacks[] = {"", "-1", "65535", "64,64", "black"};
    for (size_t i = 0; i < sizeof blacks / sizeof blacks[0]; i++)
        refused(colour_option_black, blacks[i], "--black-level", "0 to 65534");
    return check_end();
}
