/* Any text as a light script: refused by a sentence, or light that is finite at any time. */
#include "light_script.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static fixture_light_script script;
    pupil_why why = {""};
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, bytes, size);
    text[size] = 0;
    const int failed = fixture_light_parse(&script, text, &why);
    free(text);
    if (failed && !*why.text)
        abort(); /* a refusal without a sentence */
    for (double t = 0.0; !failed && t < 20.0; t += 1.9) {
        const double lamp = fixture_light_lamp(&script, t, 0.001, 0.01);
        fixture_light_at(&script, t, 1.0 / 30.0);
        if (!(lamp >= 0.0) || !isfinite(lamp))
            abort();
    }
    return 0;
}
