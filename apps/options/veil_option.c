#include "veil_option.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "refuse.h"

/* The library's check, with a valid size, because the frame's is not known yet. */
static int check(const pupil_veil_config *c, const char *name, pupil_why *why)
{
    pupil_veil_config sized = *c;
    const char *fault = "";
    sized.width = sized.height = 1;
    return pupil_veil_config_check(&sized, &fault) ? pupil_refuse(why, "--veil %s: %s", name, fault) : 0;
}

static int parse_eye(const char *text, pupil_veil_config *c, pupil_why *why)
{
    char *end;
    if (*text == 0)
        return 0; /* Spencer's */
    c->psf = PUPIL_VEIL_CIE;
    c->age_years = strtod(text + 1, &end);
    if (end == text + 1 || *end || !(c->age_years >= 1.0 && c->age_years <= 120.0))
        return pupil_refuse(why, "--veil eye%s: the age must be from 1 to 120 years, as in eye:70", text);
    return 0;
}

/* A line of two numbers, or none. */
static int parse_line(char *line, const char *path, unsigned number, pupil_veil_config *c, pupil_why *why)
{
    pupil_veil_gaussian g;
    char *at, *end;
    line[strcspn(line, "#\r\n")] = 0;
    at = line + strspn(line, " \t");
    if (!*at)
        return 0;
    g.sigma = strtod(at, &end);
    at = end;
    g.weight = strtod(at, &end);
    if (end == at || end[strspn(end, " \t")])
        return pupil_refuse(why,
                            "--veil %s, line %u: must be a standard deviation in degrees and a share of the "
                            "light, as in \"5 0.03\"",
                            path, number);
    if (c->gaussians == PUPIL_VEIL_MOST_GAUSSIANS)
        return pupil_refuse(why, "--veil %s, line %u: at most %u Gaussians", path, number, PUPIL_VEIL_MOST_GAUSSIANS);
    c->gaussian[c->gaussians++] = g;
    return 0;
}

static int parse_file(const char *path, pupil_veil_config *c, pupil_why *why)
{
    char line[256];
    int failed = 0;
    FILE *file = fopen(path, "r");
    if (!file)
        return pupil_refuse(why, "--veil %s: no such file; must be eye, eye:AGE or a file of Gaussians", path);
    c->psf = PUPIL_VEIL_GAUSSIANS;
    for (unsigned number = 1; !failed && fgets(line, sizeof line, file); number++)
        failed = parse_line(line, path, number, c, why);
    if (!failed && ferror(file))
        failed = pupil_refuse(why, "--veil %s: cannot be read: %s", path, strerror(errno));
    fclose(file);
    if (!failed && !c->gaussians)
        failed = pupil_refuse(why,
                              "--veil %s: has no Gaussian: lines of a standard deviation in degrees and a share of "
                              "the light",
                              path);
    return failed;
}

int veil_option_parse(const char *text, pupil_veil_config *config, pupil_why *why)
{
    pupil_veil_config c;
    pupil_veil_config_default(&c);
    c.fov_deg = config->fov_deg;
    const int is_eye = strncmp(text, "eye", 3) == 0 && (text[3] == 0 || text[3] == ':');
    if ((is_eye ? parse_eye(text + 3, &c, why) : parse_file(text, &c, why)) || check(&c, text, why))
        return -1;
    *config = c;
    return 0;
}
