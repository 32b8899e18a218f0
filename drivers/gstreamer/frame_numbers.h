/* drivers/gstreamer/frame_numbers.h: what an element says of its frames and of its state.
 *
 * Each buffer has a custom meta "PupilFrame" (gst_buffer_get_custom_meta), whose structure has the frame's numbers.
 * Each change of state is an element message on the bus, whose structure has the element's name and the same fields:
 *
 *     state, reason    strings
 *     metered-ev       log2 of the light of this frame; adapted-ev: of the level
 *     scale            from light to the picture
 *     dt               seconds since the frame before
 */
#ifndef PUPIL_DRIVERS_GSTREAMER_FRAME_NUMBERS_H
#define PUPIL_DRIVERS_GSTREAMER_FRAME_NUMBERS_H

#include <gst/gst.h>

#include "pupil/pupil.h"

#define FRAME_NUMBERS_META "PupilFrame"

/* A pupil_state, as a GObject's enumeration, and its words. */
GType frame_state_type(void);
const gchar *frame_state_word(uint32_t state);
const gchar *frame_reason_word(uint32_t reason);

void frame_numbers_register(void);
void frame_numbers_write(GstStructure *to, const pupil_exposure *exposure);
/* The buffer's own structure, emptied: of the meta from an element upstream, or of a new one. */
GstStructure *frame_numbers_of(GstBuffer *buffer);

#endif
