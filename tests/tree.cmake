# Tests of the tree rather than of the code in it: what it needs, what it exports, what other compilers and CPUs make of
# it. They build it anew, so they belong to the dev preset only.
set(nested ${PROJECT_BINARY_DIR}/nested)

# pupil_add_tree_test(NAME LABEL SECONDS COMMAND...)
function(pupil_add_tree_test name label seconds)
  add_test(NAME ${name} COMMAND sh ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT ${seconds} SKIP_RETURN_CODE 77)
  if(label STREQUAL full)
    set_tests_properties(${name} PROPERTIES COST ${full_cost})
  endif()
endfunction()

# pupil_add_nested(NAME LABEL SECONDS TARGET CTEST_ARGUMENTS CMAKE_ARGUMENTS...)
function(pupil_add_nested name label seconds target ctest_arguments)
  string(REPLACE . - folder ${name})
  pupil_add_tree_test(${name} ${label} ${seconds} ${CMAKE_CURRENT_SOURCE_DIR}/nested.sh
    ${nested}/${folder} ${target} ${ctest_arguments} -- ${ARGN})
  set_tests_properties(${name} PROPERTIES PROCESSORS 2 COST ${threaded_cost})
endfunction()

set(here ${CMAKE_CURRENT_SOURCE_DIR})
pupil_add_tree_test(tree.symbols quick 300 ${here}/freestanding/symbols.sh
  $<TARGET_FILE:pupil_static> $<TARGET_FILE:pupil_shared>)
pupil_add_tree_test(tree.stack full 900 ${here}/freestanding/stack.sh)
pupil_add_tree_test(tree.headers quick 300 ${here}/headers/check.sh)
pupil_add_tree_test(tree.install quick 300 ${here}/install/check.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.readme quick 300 ${here}/readme/check.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.camera quick 300 ${here}/readme/camera.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.tables quick 300 ${here}/kernels/check_tables.sh)
pupil_add_tree_test(arm.instructions quick 300 ${here}/arm/test_instructions.sh)
pupil_add_tree_test(tree.style quick 300 ${here}/style.sh)
pupil_add_tree_test(tree.shape quick 60 ${here}/shape.sh)
pupil_add_tree_test(tree.words quick 60 ${here}/tree/words.sh)

# The same bits from other compilers and levels: tests/stream/digests.txt, tests/scene/digests.txt.
set(digest_only -DPUPIL_PROGRAM=OFF -DPUPIL_TESTS=ON -DPUPIL_WERROR=ON -DCMAKE_BUILD_TYPE=None)
foreach(compiler gcc clang)
  foreach(level O0 O1 O2 O3)
    pupil_add_nested(digest.${compiler}-${level} full 600 digests "-R digest$"
      -DCMAKE_C_COMPILER=${compiler} -DCMAKE_C_FLAGS=-${level} ${digest_only})
  endforeach()
endforeach()
pupil_add_nested(digest.x86-64-v3 full 600 digests "-R digest$"
  -DCMAKE_C_FLAGS=-O3\ -march=x86-64-v3 ${digest_only})

# What there are vectors for again at the scalar level alone, which is what a CPU without them has.
set(no_vectors "unit.(sensor|row_gain)|drivers.(camera|live|malformed|pending|recording|v4l2|video)")
string(APPEND no_vectors "|apps.(bench|list|probe|record|replay_gles|run|sim)")
pupil_add_nested(level.scalar full 1800 - "-L quick -R ^(unit|stream|kernels|drivers|apps) -E ^(${no_vectors})"
  -DPUPIL_TESTS=ON -DPUPIL_LEVELS=scalar -DPUPIL_GPU=OFF -DPUPIL_WERROR=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo)

# Sweeps of the sensor's controller and of row gains: unit.sensor_machine, sensor_lies, fixtures.loop, row_gain_scenes
# and row_gain_random walk all of their code elsewhere.
set(sweeps "unit.(row_gain|sensor_(delays|flashes|scenes|settle))")
# With musl it is the same compiler, and the library takes no number from any C library: a few tests of each part do.
set(musl_sweeps "unit.(metering|row_gain(_random)?|sensor_(beat|delays|flashes|lies|mains|properties|scenes|settle))")
# The sanitizers look for wrong accesses and values that are none. Long tests whose code others walk there, too:
# gles.law with llvmpipe, unit.row_gain_map, scene.digest, apps.sim.
set(asan_sweeps "${sweeps}|gles.law.softpipe|fixtures.(radiosity|row_gain_room)|apps.bench_(ae|kernels|scene)")

# The other presets, as a user would build them.
pupil_add_nested(preset.minimal full 600 - - --preset minimal)
pupil_add_nested(preset.release full 600 - - --preset release -DPUPIL_WERROR=ON)
pupil_add_tree_test(preset.absent full 600 ${here}/absent.sh ${nested}/preset-absent)
set_tests_properties(preset.absent PROPERTIES PROCESSORS 2 COST ${threaded_cost})
pupil_add_nested(preset.cortex-m full 900 - "-LE full" --preset cortex-m)
# The unit tests and stream.laws compare with long double, which 64-bit ARM does in software: minutes each in the
# emulator. That the laws have the same bits there is stream.digest's to say.
pupil_add_nested(preset.arm64 full 1200 - "-L quick -R ^(stream|scene|kernels) -E ^stream.laws$" --preset arm64)
pupil_add_nested(preset.musl full 1200 - "-L quick -E ^(${musl_sweeps})$" --preset musl)

# The quick tests under the sanitizers, then every fuzzer for a while, all from one build.
pupil_add_nested(preset.asan.build full 1200 - - --preset asan)
set_tests_properties(preset.asan.build PROPERTIES FIXTURES_SETUP asan COST ${longest_cost})
pupil_add_tree_test(preset.asan full 1800 ${here}/nested.sh
  ${nested}/preset-asan-build - "-L quick -E ^(${asan_sweeps})$")
set_tests_properties(preset.asan PROPERTIES FIXTURES_REQUIRED asan PROCESSORS 2 COST ${longest_cost})
# The GPU's side is mostly in the long ones.
pupil_add_tree_test(preset.asan.gles full 1800 ${here}/nested.sh
  ${nested}/preset-asan-build - "-R ^gles.(formats|adaptation|faults|fallback|calls)$")
set_tests_properties(preset.asan.gles PROPERTIES FIXTURES_REQUIRED asan PROCESSORS 2 COST ${threaded_cost})
file(GLOB fuzzers CONFIGURE_DEPENDS fuzz/fuzz_*.c)
foreach(source IN LISTS fuzzers)
  cmake_path(GET source STEM name)
  string(REPLACE fuzz_ "" name ${name})
  pupil_add_tree_test(fuzz.${name} fuzz 300 ${here}/nested.sh
  ${nested}/preset-asan-build - "-R ^fuzz.${name}$")
  set_tests_properties(fuzz.${name} PROPERTIES FIXTURES_REQUIRED asan)
endforeach()
