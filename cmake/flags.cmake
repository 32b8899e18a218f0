# Compiler flags that every target of pupil gets.

# A product and a sum must round twice, on every compiler and CPU: the results are compared bit by bit.
# No code looks at errno after mathematics or at the floating-point status flags (without -fno-trapping-math gcc will
# not vectorise a comparison). No code may be compiled as if NaN did not exist.
add_compile_options(-ffp-contract=off -fno-math-errno -fno-trapping-math)

add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wvla
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes> $<$<COMPILE_LANGUAGE:C>:-Wmissing-prototypes>)
if(PUPIL_WERROR)
  add_compile_options(-Werror)
endif()

if(PUPIL_SANITIZE)
  add_compile_options(-fsanitize=${PUPIL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PUPIL_SANITIZE})
endif()
if(PUPIL_FUZZ)
  if(NOT CMAKE_C_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PUPIL_FUZZ=ON needs clang, which brings libFuzzer: configure with -DCMAKE_C_COMPILER=clang")
  endif()
  # Coverage counters in every object, libFuzzer's main only in the fuzzers.
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Conversions are spelled out in what ships. Tests shuffle bits, and may convert silently.
function(pupil_ships target)
  target_compile_options(${target} PRIVATE -Wconversion -Wno-sign-conversion -Wno-float-conversion)
endfunction()

# Drivers, program and tests are written for Linux and glibc or musl; the library is plain C11.
function(pupil_linux target)
  set_target_properties(${target} PROPERTIES C_EXTENSIONS ON)
  target_compile_definitions(${target} PRIVATE _GNU_SOURCE)
endfunction()
