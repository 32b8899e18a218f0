/* tests/kernels/emulated/wasm_simd128.h: SIMDe instead of clang's header, so that the WebAssembly level runs here.
 */
#ifndef PUPIL_EMULATED_WASM_SIMD128_H
#define PUPIL_EMULATED_WASM_SIMD128_H

#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/wasm/simd128.h>

typedef simde_v128_t v128_t;

#endif
