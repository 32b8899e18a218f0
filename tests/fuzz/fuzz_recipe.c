/* Any text as a recipe: a scene, or a sentence that begins with the file's name. */
#include "recipe.h"

#include <stdlib.h>
#include <string.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fixture_recipe recipe;
    pupil_why why = {""};
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, bytes, size);
    text[size] = 0;
    const int failed = fixture_recipe_parse(&recipe, "fuzz", text, &why);
    if (failed && strncmp(why.text, "fuzz", 4) != 0)
        abort();
    if (!failed && (!recipe.views || !recipe.width || !recipe.height || !(recipe.fps > 0.0)))
        abort(); /* not what its users rely on */
    fixture_recipe_free(&recipe);
    free(text);
    return 0;
}
