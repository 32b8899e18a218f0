/* apps/common/gamut.h: what pupil_curve (pupil.h) says about colours beyond the display's gamut, in double. It calls
 * nothing of the library, so that the library can be measured against it. */
#ifndef PUPIL_APPS_COMMON_GAMUT_H
#define PUPIL_APPS_COMMON_GAMUT_H

/* Display light of the luminance `grey`, in BT.709's primaries or BT.2020's; `gamut` is the curve's. */
void gamut_fit(int is_bt2020, double gamut, double grey, double light[3]);

#endif
