/* pending: outputs are complete or absent. */
#include "scratch.h"

#include "file/common/pending.h"

#include <sys/wait.h>

static pupil_why why;

static void test_file(void)
{
    pupil_pending p;
    const char *path = scratch("a.txt");
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    CHECK(strcmp(p.path, path) == 0);
    CHECK(strstr(p.temporary, "/.a.txt.") && strstr(p.temporary, ".part"));
    scratch_put(p.temporary, "one");
    CHECK(!scratch_exists(path));
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(path, "one"));
    CHECK(scratch_entries(scratch_folder) == 1);
    pupil_pending_discard(&p); /* safe after commit, and takes nothing back */
    pupil_pending_discard(&p);
    CHECK(scratch_holds(path, "one"));

    /* Replaced by commit, kept by discard. */
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    scratch_put(p.temporary, "two");
    CHECK(scratch_holds(path, "one"));
    pupil_pending_discard(&p);
    CHECK(scratch_holds(path, "one") && scratch_entries(scratch_folder) == 1);
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    scratch_put(p.temporary, "two");
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(path, "two") && scratch_entries(scratch_folder) == 1);
    remove(path);
}

/* Two outputs of the same name at once: neither writes into the other's file. */
static void test_twice(void)
{
    pupil_pending p, q;
    CHECK(pupil_pending_file(&p, scratch("a"), 1, &why) == 0);
    CHECK(pupil_pending_file(&q, scratch("a"), 1, &why) == 0);
    CHECK(strcmp(p.temporary, q.temporary) != 0);
    scratch_put(p.temporary, "p");
    scratch_put(q.temporary, "q");
    CHECK(pupil_pending_commit(&q, &why) == 0 && scratch_holds(scratch("a"), "q"));
    CHECK(pupil_pending_commit(&p, &why) == 0 && scratch_holds(scratch("a"), "p"));
    CHECK(scratch_entries(scratch_folder) == 1);
    remove(scratch("a"));
}

static void test_names(void)
{
    pupil_pending p;
    char longest[256], too_long[257], path[1024];
    memset(longest, 'n', 255);
    longest[255] = 0;
    memset(too_long, 'n', 256);
    too_long[256] = 0;
    CHECK(pupil_pending_file(&p, scratch(longest), 1, &why) == 0);
    CHECK_MSG(pupil_pending_commit(&p, &why) == 0, "%s", why.text);
    CHECK(scratch_exists(scratch(longest)));
    remove(scratch(longest));
    snprintf(path, sizeof path, "%s/%s", scratch_folder, too_long);
    CHECK_REFUSED_AT(pupil_pending_file(&p, path, 1, &why), path, "too long");

    /* Relative, in the working folder. */
    CHECK(chdir(scratch_folder) == 0);
    CHECK(pupil_pending_file(&p, "here", 1, &why) == 0);
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_exists(scratch("here")));
    remove("here");

    /* A link is followed: it stays, and its target is replaced. */
    CHECK(mkdir("there", 0777) == 0 && symlink("there/target", "link") == 0);
    scratch_put("there/target", "old");
    CHECK(pupil_pending_file(&p, "link", 1, &why) == 0);
    scratch_put(p.temporary, "new");
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds("there/target", "new") && readlink("link", path, sizeof path) > 0);
    CHECK(scratch_entries("there") == 1);
    scratch_clear("there");
    remove("link");
    CHECK(scratch_entries(scratch_folder) == 0);
}

static void test_refused_places(void)
{
    pupil_pending p;
    scratch_put(scratch("file"), "");
    CHECK(mkdir(scratch("folder"), 0777) == 0 && mkfifo(scratch("pipe"), 0666) == 0);
    CHECK_REFUSED_AT(pupil_pending_file(&p, "", 1, &why), "\"\"", "needs a name");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, "", 0, &why), "\"\"", "needs a name");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("no/a"), 1, &why), scratch("no/a"), "there is no folder");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, scratch("no/a"), 1, &why), scratch("no/a"), "there is no folder");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("file/a"), 1, &why), scratch("file/a"), "is a file");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("file/a/b"), 1, &why), scratch("file/a/b"), "Not a directory");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("folder"), 1, &why), scratch("folder"), "is a folder");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("new/"), 1, &why), scratch("new/"), "is a folder");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("pipe"), 1, &why), scratch("pipe"), "a pipe");
    CHECK_REFUSED_AT(pupil_pending_file(&p, "/dev/null", 1, &why), "/dev/null", "device");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, scratch("file"), 1, &why), scratch("file"), "is a file");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, ".", 1, &why), ".", "folder inside");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, scratch(".."), 1, &why), scratch(".."), "folder inside");
    CHECK_REFUSED_AT(pupil_pending_folder(&p, "/", 1, &why), "/", "folder inside");
    if (scratch_exists("/proc/self")) { /* a bare chroot has none */
        char own[32];
        int ends[2];
        CHECK(pipe(ends) == 0);
        snprintf(own, sizeof own, "/proc/self/fd/%d", ends[1]); /* as /dev/stdout is */
        CHECK_REFUSED_AT(pupil_pending_folder(&p, own, 1, &why), own, "a pipe; name a folder");
        close(ends[0]);
        close(ends[1]);
        CHECK_REFUSED_AT(pupil_pending_folder(&p, "/proc", 1, &why), "/proc", "mount point");
        CHECK_REFUSED_AT(pupil_pending_file(&p, "/proc/pupil", 1, &why), "/proc/pupil", "cannot be written");
    }
    CHECK(scratch_entries(scratch_folder) == 3 && scratch_entries(scratch("folder")) == 0);
    remove(scratch("file"));
    remove(scratch("pipe"));
    rmdir(scratch("folder"));
}

static void put_in(const char *folder, const char *name, const char *text)
{
    char path[2048];
    snprintf(path, sizeof path, "%.1024s/%.1000s", folder, name);
    scratch_put(path, text);
}

static void test_folder(void)
{
    pupil_pending p;
    const char *path = scratch("out");
    CHECK(pupil_pending_folder(&p, scratch("out/"), 0, &why) == 0);
    CHECK(strcmp(p.path, path) == 0 && scratch_entries(p.temporary) == 0);
    put_in(p.temporary, "frame_000000.png", "one");
    CHECK(!scratch_exists(path));
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(scratch("out/frame_000000.png"), "one") && scratch_entries(scratch_folder) == 1);
    pupil_pending_discard(&p);
    CHECK(scratch_exists(path));

    CHECK_REFUSED_AT(pupil_pending_folder(&p, path, 0, &why), path, "not empty");

    /* The whole folder is overwritten: nothing of the old one is left. */
    put_in(path, "frame_1000000.png", "old");
    CHECK(pupil_pending_folder(&p, path, 1, &why) == 0);
    put_in(p.temporary, "frame_000000.png", "two");
    CHECK(scratch_holds(scratch("out/frame_000000.png"), "one"));
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(scratch("out/frame_000000.png"), "two"));
    CHECK(scratch_entries(path) == 1 && scratch_entries(scratch_folder) == 1);

    /* Discarded, with its subfolders; what was there before stays. */
    CHECK(pupil_pending_folder(&p, path, 1, &why) == 0);
    put_in(p.temporary, "frame_000000.png", "three");
    {
        char within[1024];
        snprintf(within, sizeof within, "%s/within", p.temporary);
        CHECK(mkdir(within, 0777) == 0);
        put_in(within, "file", "");
    }
    pupil_pending_discard(&p);
    CHECK(scratch_holds(scratch("out/frame_000000.png"), "two") && scratch_entries(scratch_folder) == 1);
    scratch_clear(path);

    /* An empty folder is as good as none. */
    CHECK(mkdir(path, 0777) == 0 && pupil_pending_folder(&p, path, 0, &why) == 0);
    put_in(p.temporary, "a", "a");
    CHECK(pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(scratch("out/a"), "a") && scratch_entries(scratch_folder) == 1);
    scratch_clear(path);
}

/* A folder that holds anything but frames is never overwritten, regardless of when that appeared. */
static void test_precious_folder(void)
{
    static const char *const names[] = {"thesis.txt", "frame_00000.png",  "frame_000000.png~", "frame_000000.PNG",
                                        ".hidden",    "frame_00000a.png", "Frame_000000.png"};
    pupil_pending p;
    const char *path = scratch("out");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char file[1024];
        CHECK(mkdir(path, 0777) == 0);
        put_in(path, "frame_000000.png", "");
        CHECK(pupil_pending_folder(&p, path, 1, &why) == 0);
        put_in(p.temporary, "frame_000000.png", "new");
        put_in(path, names[i], "precious"); /* after the check at the beginning */
        CHECK_REFUSED_AT(pupil_pending_commit(&p, &why), path, names[i]);
        pupil_pending_discard(&p);
        CHECK_REFUSED_AT(pupil_pending_folder(&p, path, 1, &why), path, names[i]);
        snprintf(file, sizeof file, "%s/%s", path, names[i]);
        CHECK(scratch_holds(file, "precious"));
        CHECK(scratch_entries(path) == 2 && scratch_entries(scratch_folder) == 1);
        scratch_clear(path);
    }
    /* Nor is a folder with a subfolder or a link of such a name. */
    CHECK(mkdir(path, 0777) == 0 && mkdir(scratch("out/frame_000000.png"), 0777) == 0);
    CHECK_REFUSED_AT(pupil_pending_folder(&p, path, 1, &why), path, "frame_000000.png");
    scratch_clear(path);
    CHECK(mkdir(path, 0777) == 0 && symlink("/etc/passwd", scratch("out/frame_000000.png")) == 0);
    CHECK_REFUSED_AT(pupil_pending_folder(&p, path, 1, &why), path, "frame_000000.png");
    scratch_clear(path);

    /* Filled in the meantime, without overwrite. */
    CHECK(pupil_pending_folder(&p, path, 0, &why) == 0);
    CHECK(mkdir(path, 0777) == 0);
    put_in(path, "frame_000000.png", "precious");
    CHECK_REFUSED_AT(pupil_pending_commit(&p, &why), path, "in the meantime");
    pupil_pending_discard(&p);
    CHECK(scratch_holds(scratch("out/frame_000000.png"), "precious") && scratch_exists(scratch("out-1")));
    CHECK(scratch_entries(scratch_folder) == 2);
    scratch_clear(path);
    scratch_clear(scratch("out-1"));
}

/* The temporary file or the folder is removed by another program: a sentence, and discard still works. */
static void test_taken_away(void)
{
    pupil_pending p;
    CHECK(pupil_pending_file(&p, scratch("a"), 1, &why) == 0);
    remove(p.temporary);
    CHECK_REFUSED_AT(pupil_pending_commit(&p, &why), scratch("a"), "No such file");
    pupil_pending_discard(&p);
    CHECK(mkdir(scratch("in"), 0777) == 0);
    CHECK(pupil_pending_folder(&p, scratch("in/a"), 0, &why) == 0);
    scratch_clear(scratch("in"));
    CHECK_REFUSED_AT(pupil_pending_commit(&p, &why), scratch("in/a"), "No such file");
    pupil_pending_discard(&p);
    CHECK(scratch_entries(scratch_folder) == 0);
}

/* Permissions do not restrict root, so a child becomes nobody. */
static void test_permission(void)
{
    const char *path = scratch("closed/a");
    CHECK(mkdir(scratch("closed"), 0555) == 0 && chmod(scratch_folder, 0755) == 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        pupil_pending p;
        if (geteuid() == 0 && setuid(65534) != 0)
            _exit(2);
        if (pupil_pending_file(&p, path, 1, &why) != -1)
            _exit(3);
        _exit(strncmp(why.text, path, strlen(path)) == 0 && strstr(why.text, "Permission denied") ? 0 : 4);
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child);
    CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0, "status %d", status);
    rmdir(scratch("closed"));
}

/* A child begins an output and stops, or is killed. */
static pid_t begin_in_child(const char *path, int is_folder, int is_killed)
{
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        pupil_pending p;
        if (is_folder ? pupil_pending_folder(&p, path, 0, &why) : pupil_pending_file(&p, path, 1, &why))
            _exit(1);
        if (is_folder)
            put_in(p.temporary, "frame_000000.png", "half");
        raise(is_killed ? SIGKILL : SIGSTOP);
        _exit(1);
    }
    int status = -1;
    CHECK(child > 0 && waitpid(child, &status, WUNTRACED) == child);
    CHECK(is_killed ? WIFSIGNALED(status) : WIFSTOPPED(status));
    return child;
}

/* Leftovers of a killed run are removed when the same output is begun; not those of a live run or of other names. */
static void test_swept(void)
{
    for (int is_folder = 0; is_folder <= 1; is_folder++) {
        const char *path = scratch("swept.x"), *other = scratch("swept"), *old = scratch(".swept.x.1.old");
        pupil_pending p;
        begin_in_child(path, is_folder, 1);
        begin_in_child(path, is_folder, 1);
        begin_in_child(other, is_folder, 1);
        CHECK(scratch_entries(scratch_folder) == 2); /* the second has swept the first away */
        const pid_t there = begin_in_child(path, is_folder, 0);
        CHECK(scratch_entries(scratch_folder) == 2); /* it was swept when this one began */
        scratch_put(scratch(".swept.x.1a.part"), "");
        scratch_put(scratch(".swept.x.1.part.png"), "");
        CHECK(mkdir(old, 0777) == 0);
        put_in(old, "frame_000000.png", "replaced");
        CHECK((is_folder ? pupil_pending_folder(&p, path, 0, &why) : pupil_pending_file(&p, path, 1, &why)) == 0);
        CHECK(scratch_exists(old) && scratch_entries(scratch_folder) == 6); /* kept, as nothing is in its place */
        CHECK(pupil_pending_commit(&p, &why) == 0);
        CHECK((is_folder ? pupil_pending_folder(&p, path, 0, &why) : pupil_pending_file(&p, path, 1, &why)) == 0);
        CHECK(!scratch_exists(old) && scratch_entries(scratch_folder) == 6);
        pupil_pending_discard(&p);
        CHECK(kill(there, SIGKILL) == 0 && waitpid(there, NULL, 0) == there);
        CHECK((is_folder ? pupil_pending_folder(&p, other, 0, &why) : pupil_pending_file(&p, other, 1, &why)) == 0);
        pupil_pending_discard(&p);
        CHECK((is_folder ? pupil_pending_folder(&p, path, 0, &why) : pupil_pending_file(&p, path, 1, &why)) == 0);
        pupil_pending_discard(&p);
        CHECK(scratch_entries(scratch_folder) == 3);
        remove(scratch(".swept.x.1a.part"));
        remove(scratch(".swept.x.1.part.png"));
        remove(path);
        CHECK(scratch_entries(scratch_folder) == 0);
    }
}

/* A stream writes into the file that it created, even if another file has its name now; that one is not put in
 * place. */
static void test_stream(void)
{
    pupil_pending p;
    const char *path = scratch("a"), *victim = scratch("victim");
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    FILE *file = pupil_pending_stream(&p);
    CHECK(file && fputs("text", file) >= 0 && fclose(file) == 0);
    CHECK(pupil_pending_commit(&p, &why) == 0 && scratch_holds(path, "text"));
    remove(path);

    scratch_put(victim, "precious");
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    CHECK(unlink(p.temporary) == 0 && symlink(victim, p.temporary) == 0);
    file = pupil_pending_stream(&p);
    CHECK(file && fputs("text", file) >= 0 && fclose(file) == 0);
    CHECK_REFUSED_AT(pupil_pending_commit(&p, &why), path, "another file");
    pupil_pending_discard(&p);
    CHECK(scratch_holds(victim, "precious") && scratch_entries(scratch_folder) == 1);
    remove(victim);
}

/* Put in place before it is complete. */
static void test_show(void)
{
    pupil_pending p;
    const char *path = scratch("a");
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0);
    FILE *file = pupil_pending_stream(&p);
    CHECK(pupil_pending_show(&p, &why) == 0 && scratch_holds(path, "") && scratch_entries(scratch_folder) == 1);
    CHECK(file && fputs("text", file) >= 0 && fclose(file) == 0);
    CHECK(pupil_pending_commit(&p, &why) == 0 && scratch_holds(path, "text"));
    CHECK(pupil_pending_file(&p, path, 1, &why) == 0 && pupil_pending_show(&p, &why) == 0);
    pupil_pending_discard(&p);
    CHECK(scratch_holds(path, "") && scratch_entries(scratch_folder) == 1);
    remove(path);
}

/* What is there stays, also what appears in the meantime. */
static void test_kept(void)
{
    pupil_pending p;
    scratch_put(scratch("kept.mp4"), "mine");
    scratch_put(scratch("kept-1.mp4"), "mine too");
    CHECK_REFUSED_AT(pupil_pending_file(&p, scratch("kept.mp4"), 0, &why), scratch("kept.mp4"), "-y replaces it");
    CHECK_MSG(strstr(why.text, "kept-2.mp4 is free"), "%s", why.text);
    CHECK(pupil_pending_file(&p, scratch("late.mp4"), 0, &why) == 0 && write(p.fd, "ours", 4) == 4);
    scratch_put(scratch("late.mp4"), "mine");
    CHECK(pupil_pending_commit(&p, &why) == -1 && strstr(why.text, "this output is complete, as"));
    CHECK_MSG(strstr(why.text, "late-1.mp4"), "%s", why.text);
    pupil_pending_discard(&p);
    CHECK(scratch_holds(scratch("late.mp4"), "mine") && scratch_holds(scratch("late-1.mp4"), "ours"));
    CHECK(pupil_pending_file(&p, scratch("fresh.mp4"), 0, &why) == 0 && pupil_pending_commit(&p, &why) == 0);
    CHECK(scratch_holds(scratch("fresh.mp4"), ""));
    const char *const names[] = {"kept.mp4", "kept-1.mp4", "late.mp4", "late-1.mp4", "fresh.mp4"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        remove(scratch(names[i]));
}

/* If two ask for a name, one gets it; a name reserved by a killed process is free again. */
static void test_reserved(void)
{
    pupil_pending p, q;
    const char *path = scratch("next.mp4");
    CHECK(pupil_pending_reserve(&p, path) == 0 && !scratch_exists(path));
    CHECK(pupil_pending_reserve(&q, path) == 1 && scratch_entries(scratch_folder) == 1);
    CHECK(!pupil_pending_is_begun(&p));
    CHECK(pupil_pending_file(&q, path, 0, &why) == 0); /* begins its own output under the name that it reserved */
    CHECK(pupil_pending_is_begun(&p));
    pupil_pending_discard(&p);
    CHECK(pupil_pending_reserve(&p, path) == 1); /* it is being written */
    CHECK(pupil_pending_commit(&q, &why) == 0);
    CHECK(pupil_pending_reserve(&p, path) == 1); /* it is there */
    remove(path);
    begin_in_child(path, 0, 1);
    CHECK(pupil_pending_reserve(&p, path) == 0);
    pupil_pending_discard(&p);
    CHECK(pupil_pending_file(&q, path, 0, &why) == 0); /* sweeps */
    pupil_pending_discard(&q);
    CHECK(pupil_pending_reserve(&p, scratch("none/next.mp4")) == 0);
    pupil_pending_discard(&p);
    CHECK(scratch_entries(scratch_folder) == 0);
}

/* A link that leads to nothing yet: its target is created, as by ffmpeg and a shell's >, and the link stays. */
static void test_link_to_nothing(void)
{
    pupil_pending p;
    char path[1024];
    CHECK(mkdir(scratch("there"), 0777) == 0 && symlink("there/new", scratch("link")) == 0);
    CHECK(symlink("link", scratch("first")) == 0 && symlink("none/new", scratch("lost")) == 0);
    CHECK(symlink("round", scratch("round")) == 0);
    for (int overwrite = 0; overwrite <= 1; overwrite++) {
        CHECK(pupil_pending_file(&p, scratch("first"), overwrite, &why) == 0 && pupil_pending_commit(&p, &why) == 0);
        CHECK(scratch_holds(scratch("there/new"), "") && readlink(scratch("link"), path, sizeof path) > 0);
        CHECK(scratch_entries(scratch_folder) == 5 && scratch_entries(scratch("there")) == 1);
        remove(scratch("there/new"));
        CHECK(pupil_pending_file(&p, scratch("lost"), overwrite, &why) == -1 && strstr(why.text, "there is no folder"));
        CHECK(pupil_pending_file(&p, scratch("round"), overwrite, &why) == -1 && strstr(why.text, "Too many levels"));
    }
    CHECK(scratch_entries(scratch_folder) == 5);
    rmdir(scratch("there"));
    const char *const links[] = {"link", "first", "lost", "round"};
    for (size_t i = 0; i < sizeof links / sizeof *links; i++)
        remove(scratch(links[i]));
}

static unsigned mode_of(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 ? s.st_mode & 0777 : 0;
}

/* If only the owner could read the old file, the same holds for the new one from the beginning. */
static void test_modes(void)
{
    pupil_pending p;
    scratch_put(scratch("private"), "secret");
    CHECK(chmod(scratch("private"), 0400) == 0);
    CHECK(pupil_pending_file(&p, scratch("private"), 1, &why) == 0 && mode_of(p.temporary) == 0600);
    CHECK(pupil_pending_commit(&p, &why) == 0 && mode_of(scratch("private")) == 0400);
    remove(scratch("private"));
    CHECK(mkdir(scratch("folder"), 0700) == 0);
    CHECK(pupil_pending_folder(&p, scratch("folder"), 1, &why) == 0 && mode_of(p.temporary) == 0700);
    CHECK(pupil_pending_commit(&p, &why) == 0 && mode_of(scratch("folder")) == 0700);
    scratch_clear(scratch("folder"));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_file();
    test_twice();
    test_kept();
    test_reserved();
    test_link_to_nothing();
    test_modes();
    test_names();
    test_refused_places();
    test_folder();
    test_precious_folder();
    test_taken_away();
    test_permission();
    test_swept();
    test_stream();
    test_show();
    CHECK(scratch_entries(scratch_folder) == 0);
    scratch_clear(scratch_folder);
    return check_end();
}
