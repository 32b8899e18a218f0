/* Completion for bash: commands, options, and the words of a choice. Everything else is a file's name. */
#include <string.h>

#include "option_table.h"

static void put_names(const option_command *const *commands, FILE *out)
{
    for (; *commands; commands++) {
        const char *last = strrchr((*commands)->name, ' ');
        fprintf(out, "%s\n", last ? last + 1 : (*commands)->name);
    }
}

static void put_options(const option_command *command, const char *before, const char *word, FILE *out)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(command, n, &base)); n++) {
        if (row->kind == OPTION_CHOICE && strncmp(before, "--", 2) == 0 && strcmp(before + 2, row->name) == 0) {
            for (const char *c = option_words_of(row); *c; c++)
                fputc(*c == '|' ? '\n' : *c, out);
            fputc('\n', out);
            return;
        }
    }
    for (size_t n = 0; *word == '-' && (row = options_row(command, n, &base)); n++)
        fprintf(out, "--%s\n", row->name);
}

void options_complete(const option_command *const *commands, int count, char **words, FILE *out)
{
    char name[64];
    const char *word = count > 0 ? words[count - 1] : "";
    const option_command *command = count > 1 ? options_command(commands, words[0]) : NULL;
    if (count <= 1)
        fputs("help\nversion\ncompletion\n", out);
    if (count <= 1 || (count == 2 && strcmp(words[0], "help") == 0))
        put_names(commands, out);
    if (count == 2 && strcmp(words[0], "completion") == 0)
        fputs("bash\n", out);
    if (command && command->parts && count == 2)
        put_names(command->parts, out);
    if (command && command->parts && count > 2) {
        snprintf(name, sizeof name, "%s %s", words[0], words[1]);
        command = options_command(command->parts, name);
    }
    if (command && !command->parts) /* bash splits --mode=both at the = */
        put_options(command, words[count - (count > 2 && strcmp(words[count - 2], "=") == 0 ? 3 : 2)], word, out);
}

void options_completion(FILE *out)
{
    fputs("# bash completion of pupil, made by 'pupil completion bash'\n"
          "_pupil() {\n"
          "    local word=${COMP_WORDS[COMP_CWORD]}\n"
          "    local words=(\"${COMP_WORDS[@]:1:COMP_CWORD-1}\")\n"
          "    if [ \"$word\" = '=' ]; then word=; fi\n"
          "    COMPREPLY=($(compgen -W \"$(pupil completion bash \"${words[@]}\" \"$word\")\" -- \"$word\"))\n"
          "}\n"
          "complete -o default -F _pupil pupil\n",
          out);
}
