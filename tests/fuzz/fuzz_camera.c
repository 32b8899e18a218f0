/* Any text as a simulated camera: refused by a sentence, or a camera whose text makes the same camera again. */
#include "plant.h"

#include <stdlib.h>
#include <string.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fixture_plant_config config, again;
    pupil_why why = {""};
    char words[4096], words_again[4096];
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, bytes, size);
    text[size] = 0;
    fixture_plant_default(&config);
    const int failed = fixture_plant_parse(&config, text, &why) || fixture_plant_check(&config, &why);
    free(text);
    if (failed && !*why.text)
        abort(); /* a refusal without a sentence */
    if (failed)
        return 0;
    fixture_plant_text(&config, words, sizeof words);
    fixture_plant_default(&again);
    if (fixture_plant_parse(&again, words, &why) || fixture_plant_check(&again, &why))
        abort();
    fixture_plant_text(&again, words_again, sizeof words_again);
    if (strcmp(words, words_again) != 0)
        abort();
    return 0;
}
