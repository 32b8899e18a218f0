/* The original study's tables, computed from numbers alone, if the shared folder has them. */
#include "lab/study/study.h"

#include <math.h>

#include "check.h"

int main(int argc, char **argv)
{
    static study_regression r;
    static char path[4200];
    pupil_why why;
    check_begin(argc, argv);
    const char *shared = check_shared();
    if (!shared)
        return check_cannot("no shared images");
    snprintf(path, sizeof path, "%s/seeds/convergence.csv", shared);
    CHECK_MSG(study_regression_make(&r, path, &why) == 0, "%s", why.text);
    printf("%u cells and %u misprints: %u exact, %u within 1 frame, %u within 2\n", r.cells, r.misprints, r.exact,
           r.within_1, r.within_2);
    CHECK(r.cells == 1277 && r.misprints == 3);
    CHECK(r.exact >= 1257);
    CHECK(r.within_1 >= 1275);
    CHECK(r.within_2 == 1277);
    CHECK(r.unfinished == 60 && r.stalled > 20 && r.stalled < 40); /* half of "does not converge" comes from rounding */

    /* What the acceptance tests find in those tables, which are not from exact arithmetic. */
    study_test order = {.name = "A2"}, equal = {.name = "A3"}, one_number = {.name = "A5"};
    study_accept_order(&order, &r.seeds);
    study_accept_equal(&equal, &r.seeds);
    study_accept_one_number(&one_number, &r.seeds, log(274.0));
    CHECK_MSG(order.violations == 6, "%lu", order.violations);
    CHECK_MSG(equal.violations == 105, "%lu", equal.violations);
    CHECK_MSG(one_number.violations > 300, "%lu", one_number.violations);
    return check_end();
}
