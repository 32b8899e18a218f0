/* Every file of the shared collection of malformed images: a clean read or a sentence, within 2 s and 1 GB each. */
#include "still_check.h"

#include <sys/wait.h>

#define MAX_SECONDS   2
#define MAX_RSS_KB    1000000
#define EXIT_READ     0
#define EXIT_REFUSED  3
#define EXIT_SILENT   4
#define NAMED_SLOWEST 200

static unsigned files_read, files_refused;
static long most_kb;
static double most_s;
static char slowest[NAMED_SLOWEST], largest[NAMED_SLOWEST];

/* In the child: load, read every sample, and report by the exit status. */
static void load_and_exit(const char *path)
{
    pupil_still still = {0};
    pupil_why why = {""};
    int status = EXIT_READ;
    alarm(MAX_SECONDS); /* its signal ends the child */
    if (pupil_still_load(&still, path, &why) != 0) {
        status = strncmp(why.text, path, strlen(path)) == 0 && strlen(why.text) > strlen(path) + 2 ? EXIT_REFUSED
                                                                                                   : EXIT_SILENT;
    } else {
        const size_t size = (size_t)still.width * still.height * pupil_pixel_bytes(still.pixel);
        unsigned all = 0;
        for (size_t i = 0; i < size; i++)
            all |= ((const uint8_t *)still.pixels)[i];
        if (all > 255)
            status = EXIT_SILENT;
    }
    pupil_still_free(&still);
    exit(status);
}

static void check_file(const char *path)
{
    struct timespec start, end;
    struct rusage use;
    int status = 0;
    double seconds;
    pid_t child;
    fflush(stdout);
    clock_gettime(CLOCK_MONOTONIC, &start);
    child = fork();
    if (child == 0)
        load_and_exit(path);
    CHECK(child > 0 && wait4(child, &status, 0, &use) == child);
    clock_gettime(CLOCK_MONOTONIC, &end);
    seconds = (double)(end.tv_sec - start.tv_sec) + (double)(end.tv_nsec - start.tv_nsec) * 1e-9;
    CHECK_MSG(WIFEXITED(status), "%s: signal %d", path, WTERMSIG(status));
    CHECK_MSG(!WIFEXITED(status) || WEXITSTATUS(status) == EXIT_READ || WEXITSTATUS(status) == EXIT_REFUSED,
              "%s: exit status %d", path, WEXITSTATUS(status));
    CHECK_MSG(use.ru_maxrss <= MAX_RSS_KB, "%s: %ld KB", path, use.ru_maxrss);
    files_read += WIFEXITED(status) && WEXITSTATUS(status) == EXIT_READ;
    files_refused += WIFEXITED(status) && WEXITSTATUS(status) == EXIT_REFUSED;
    if (seconds > most_s) {
        most_s = seconds;
        snprintf(slowest, sizeof slowest, "%s", path);
    }
    if (use.ru_maxrss > most_kb) {
        most_kb = use.ru_maxrss;
        snprintf(largest, sizeof largest, "%s", path);
    }
}

static int visit(const char *path, const struct stat *status, int type, struct FTW *walk)
{
    (void)status;
    (void)walk;
    if (type == FTW_F)
        check_file(path);
    return 0;
}

int main(int argc, char **argv)
{
    const char *shared = check_shared();
    char folder[4200];
    struct stat status;
    check_begin(argc, argv);
    snprintf(folder, sizeof folder, "%s/malformed", shared ? shared : "");
    if (!shared || stat(folder, &status) != 0)
        return check_cannot("no shared images");
    CHECK(nftw(folder, visit, 8, FTW_PHYS) == 0);
    CHECK(files_read + files_refused > 400);
    printf("%u read, %u refused; longest %.2f s (%s), largest %ld MB (%s)\n", files_read, files_refused, most_s,
           slowest, most_kb / 1000, largest);
    return check_end();
}
