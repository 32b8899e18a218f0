# Compiler flags that every target of pupil gets.

# A product and a sum must round twice, on every compiler and CPU: the results are compared bit by bit.
# No code looks at errno after mathematics or at the floating-point status flags (without -fno-trapping-math gcc will
# not vectorise a comparison). No code may be compiled as if NaN did not exist.
add_compile_options(-ffp-contract=off -fno-math-errno -fno-trapping-math)

# Float operations must round to float (FLT_EVAL_METHOD 0). On 32-bit x86 that needs SSE2, on s390x ignoring a rule of
# older ABIs. lib/base/exact.h refuses other cases.
include(CheckCSourceCompiles)
function(pupil_check_floats result flags)
  set(CMAKE_C_EXTENSIONS OFF) # as the library is compiled: -std=c11
  set(CMAKE_REQUIRED_FLAGS "${flags}")
  set(CMAKE_REQUIRED_QUIET ON)
  check_c_source_compiles("#include <float.h>
    #if FLT_EVAL_METHOD != 0
    #error
    #endif
    int main(void) { return 0; }" ${result})
endfunction()
pupil_check_floats(PUPIL_FLOATS_ROUND "")
if(NOT PUPIL_FLOATS_ROUND)
  pupil_check_floats(PUPIL_FLOATS_ROUND_WITH_SSE2 "-msse2 -mfpmath=sse")
  pupil_check_floats(PUPIL_FLOATS_ROUND_WITHOUT_EXCESS "-fexcess-precision=fast")
  if(PUPIL_FLOATS_ROUND_WITH_SSE2)
    message(STATUS "Floats: SSE2, so the CPU must have it (a Pentium 4 or newer)")
    add_compile_options(-msse2 -mfpmath=sse)
  elseif(PUPIL_FLOATS_ROUND_WITHOUT_EXCESS)
    add_compile_options($<$<COMPILE_LANGUAGE:C>:-fexcess-precision=fast>)
  else()
    message(FATAL_ERROR "This compiler keeps more digits than float in float operations (FLT_EVAL_METHOD is not 0), \
and no flag that is known changes it: the results would have other bits than everywhere else")
  endif()
endif()

add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wvla
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes> $<$<COMPILE_LANGUAGE:C>:-Wmissing-prototypes>)
if(PUPIL_WERROR)
  add_compile_options(-Werror)
endif()

if(PUPIL_SANITIZE)
  add_compile_options(-fsanitize=${PUPIL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PUPIL_SANITIZE})
endif()

# With sanitizers, what computes pixels is optimised whatever the build type. The rest, without optimisation, compiles
# in a third of the time and hardly runs longer.
function(pupil_computes_pixels target)
  if(PUPIL_SANITIZE)
    target_compile_options(${target} PRIVATE -O2)
  endif()
endfunction()

if(PUPIL_FUZZ)
  if(NOT CMAKE_C_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PUPIL_FUZZ=ON needs clang, which brings libFuzzer: configure with -DCMAKE_C_COMPILER=clang")
  endif()
  # Coverage counters in every object, libFuzzer's main only in the fuzzers.
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Conversions are spelled out in what ships. Tests shuffle bits, and may convert silently. Sizes and counts are
# enumerators; clang from 19 on would warn where one of them meets a float.
function(pupil_ships target)
  target_compile_options(${target} PRIVATE -Wconversion -Wno-sign-conversion -Wno-float-conversion)
  if(CMAKE_C_COMPILER_ID MATCHES "Clang")
    target_compile_options(${target} PRIVATE -Wno-enum-float-conversion -Wno-enum-enum-conversion)
  endif()
endfunction()

# For code that reads files and devices (not lib, which calls nothing): stack protectors, size checks in the C library's
# functions, read-only function tables. docs/reliability.md has the cost.
include(CheckCCompilerFlag)
set(pupil_hardening)
if(PUPIL_HARDEN AND NOT PUPIL_SANITIZE)
  foreach(flag IN ITEMS -fstack-protector-strong -fstack-clash-protection -fcf-protection)
    string(MAKE_C_IDENTIFIER PUPIL_HAS${flag} has)
    set(CMAKE_REQUIRED_QUIET ON)
    check_c_compiler_flag(${flag} ${has})
    if(${has})
      list(APPEND pupil_hardening ${flag})
    endif()
  endforeach()
  if(NOT CMAKE_SYSTEM_NAME STREQUAL Generic)
    add_link_options(LINKER:-z,relro,-z,now)
  endif()
endif()

# Drivers, program and tests are written for Linux and glibc or musl; the library is plain C11.
function(pupil_linux target)
  set_target_properties(${target} PROPERTIES C_EXTENSIONS ON)
  target_compile_options(${target} PRIVATE ${pupil_hardening})
  target_compile_definitions(${target} PRIVATE _GNU_SOURCE
    $<$<AND:$<BOOL:${pupil_hardening}>,$<CONFIG:Release,RelWithDebInfo,MinSizeRel>>:_FORTIFY_SOURCE=2>
    _FILE_OFFSET_BITS=64 _TIME_BITS=64) # files over 2 GiB and years after 2038 on CPUs of 32 bits, too
endfunction()
