/* Completion for bash: commands, options, and the words of a choice; everything else is a file's name. */
#include <string.h>

#include "option_table.h"

static void put_names(const option_command *const *commands, FILE *out)
{
    for (; *commands; commands++) {
        const char *last = strrchr((*commands)->name, ' ');
        fprintf(out, "%s ", last ? last + 1 : (*commands)->name);
    }
}

static void put_choices(const option_command *command, FILE *out)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(command, n, &base)); n++) {
        if (row->kind != OPTION_CHOICE)
            continue;
        fprintf(out, "    \"%s --%s\") words=\"", command->name, row->name);
        for (const char *c = option_words_of(row); *c; c++)
            fputc(*c == '|' ? ' ' : *c, out);
        fputs("\" ;;\n", out);
    }
}

static void put_options(const option_command *command, FILE *out)
{
    const option_row *row;
    size_t base;
    fprintf(out, "        \"%s\") words=\"", command->name);
    for (size_t n = 0; (row = options_row(command, n, &base)); n++)
        fprintf(out, "--%s ", row->name);
    fputs("\" ;;\n", out);
}

static void each(const option_command *const *commands, void (*put)(const option_command *, FILE *), FILE *out)
{
    for (; *commands; commands++) {
        if ((*commands)->parts)
            each((*commands)->parts, put, out);
        else
            put(*commands, out);
    }
}

void options_completion(const option_command *const *commands, FILE *out)
{
    fputs("# bash completion of pupil, made by 'pupil completion bash'\n"
          "_pupil() {\n"
          "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} words=\n"
          "    if [ \"$cur\" = '=' ]; then cur=; elif [ \"$prev\" = '=' ]; then prev=${COMP_WORDS[COMP_CWORD-2]}; fi\n",
          out);
    for (const option_command *const *c = commands; *c; c++)
        if ((*c)->parts)
            fprintf(out,
                    "    if [ \"$command\" = %s ] && [ \"$COMP_CWORD\" -gt 2 ]; then\n"
                    "        command=\"%s ${COMP_WORDS[2]}\"\n"
                    "    fi\n",
                    (*c)->name, (*c)->name);
    fputs("    if [ \"$COMP_CWORD\" = 1 ]; then\n        command=pupil\n    fi\n"
          "    case \"$command $prev\" in\n",
          out);
    each(commands, put_choices, out);
    fputs("    \"pupil \"*) words=\"", out);
    put_names(commands, out);
    fputs("help version completion\" ;;\n", out);
    fputs("    \"help \"*) words=\"", out);
    put_names(commands, out);
    fputs("\" ;;\n    \"completion \"*) words=bash ;;\n", out);
    for (const option_command *const *c = commands; *c; c++)
        if ((*c)->parts) {
            fprintf(out, "    \"%s %s\") words=\"", (*c)->name, (*c)->name);
            put_names((*c)->parts, out);
            fputs("\" ;;\n", out);
        }
    fputs("    *)\n        case \"$command\" in\n", out);
    each(commands, put_options, out);
    fputs("        esac\n"
          "        [ \"${cur#-}\" != \"$cur\" ] || words= # an operand or a value: a file's name\n"
          "        ;;\n"
          "    esac\n"
          "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
          "}\n"
          "complete -o default -F _pupil pupil\n",
          out);
}
