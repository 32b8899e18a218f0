/* What --white-balance, --matrix, --black-level and --knees accept, and their messages for other values. */
#include "check.h"
#include "options/commands.h"
#include "run/options.h"

/* What the option's row of `pupil run` does with a value. */
static int take(const char *name, const char *text, pupil_colour_options *o, pupil_why *why)
{
    run_options run = {.colour = *o};
    const option_row *row;
    size_t base, n = 0;
    do
        row = options_row(&run_command, n++, &base);
    while (strcmp(row->name, name) != 0);
    const option_value value = {row, text, NULL, &run, why};
    const int result = row->parse(&value);
    *o = run.colour;
    return result;
}

static void refused(const char *name, const char *text, const char *right)
{
    pupil_colour_options o = {0};
    pupil_why why = {""};
    CHECK_MSG(take(name, text, &o, &why) == OPTIONS_USAGE, "'%s' is taken", text);
    CHECK_MSG(strncmp(why.text, "--", 2) == 0 && strncmp(why.text + 2, name, strlen(name)) == 0 &&
                  strstr(why.text, text) && strstr(why.text, right),
              "%s", why.text);
    CHECK(o.balance == PUPIL_COLOUR_AUTO && o.matrix == PUPIL_COLOUR_AUTO && o.black == PUPIL_COLOUR_AUTO);
}

int main(int argc, char **argv)
{
    pupil_colour_options o = {0};
    pupil_why why;
    check_begin(argc, argv);
    CHECK(take("white-balance", "off", &o, &why) == 0 && o.balance == PUPIL_COLOUR_OFF);
    CHECK(take("white-balance", "auto", &o, &why) == 0 && o.balance == PUPIL_COLOUR_AUTO);
    CHECK(take("white-balance", "1.9,1,1.6", &o, &why) == 0 && o.balance == PUPIL_COLOUR_GIVEN);
    CHECK(o.given_balance[0] == 1.9f && o.given_balance[1] == 1 && o.given_balance[2] == 1.6f);
    CHECK(take("matrix", "off", &o, &why) == 0 && o.matrix == PUPIL_COLOUR_OFF);
    CHECK(take("matrix", "1,2,3,4,5,6,-7,8,9.5", &o, &why) == 0 && o.matrix == PUPIL_COLOUR_GIVEN);
    CHECK(o.given_matrix[0] == 1 && o.given_matrix[6] == -7 && o.given_matrix[8] == 9.5f);
    CHECK(take("matrix", "auto", &o, &why) == 0 && o.matrix == PUPIL_COLOUR_AUTO);
    CHECK(take("black-level", "64", &o, &why) == 0 && o.black == PUPIL_COLOUR_GIVEN && o.given_black == 64);
    CHECK(take("black-level", "off", &o, &why) == 0 && o.black == PUPIL_COLOUR_OFF);

    static const char *const balances[] = {"",        "warm",   "1,2",    "1,2,3,4", "1,2,0",
                                           "1,2,nan", "1,2,3x", "-1,1,1", "1;1;1"};
    for (size_t i = 0; i < sizeof balances / sizeof balances[0]; i++)
        refused("white-balance", balances[i], "1.9,1,1.6");
    static const char *const matrices[] = {
        "", "on", "1,2,3", "1,2,3,4,5,6,7,8,9,10", "0,0,0,0,0,0,0,0,0", "1,2,3,4,5,6,7,8,17", "1,2,3,4,5,6,7,8,inf"};
    for (size_t i = 0; i < sizeof matrices / sizeof matrices[0]; i++)
        refused("matrix", matrices[i], "9 numbers from -16 to 16");
    static const char *const blacks[] = {"", "-1", "65535", "64,64", "black"};
    for (size_t i = 0; i < sizeof blacks / sizeof blacks[0]; i++)
        refused("black-level", blacks[i], "0 to 65534");
    CHECK(take("knees", "1024:0.0156,2048.5:0.125", &o, &why) == 0 && o.knees == 2 && o.knee_code[1] == 2048.5f &&
          o.knee_light[0] == 0.0156f && o.knee_light[1] == 0.125f);
    static const char *const knees[] = {"",
                                        "1024",
                                        "1024,0.5",
                                        "1024:0.5,",
                                        "1024:0.5,1000:0.6",
                                        "1024:0.5,2000:0.4",
                                        "1024:1.5",
                                        "1024:nan",
                                        "1024:0.5x",
                                        "1:.1,2:.2,3:.3,4:.4,5:.5,6:.6,7:.7,8:.8,9:.9"};
    for (size_t i = 0; i < sizeof knees / sizeof knees[0]; i++)
        refused("knees", knees[i], "up to 8 points CODE:LIGHT");
    return check_end();
}
