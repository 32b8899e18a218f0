# Tests of the tree rather than of the code in it: what it needs, what it exports, what other compilers and CPUs make of
# it. They build it anew, so they belong to the dev preset only.
set(nested ${PROJECT_BINARY_DIR}/nested)

# pupil_add_tree_test(NAME LABEL COMMAND...)
function(pupil_add_tree_test name label)
  add_test(NAME ${name} COMMAND sh ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES
    SKIP_RETURN_CODE 77 TIMEOUT ${${label}_timeout_s} COST ${${label}_cost} LABELS ${label})
endfunction()

# pupil_add_nested(NAME LABEL TARGET CTEST_ARGUMENTS CMAKE_ARGUMENTS...)
function(pupil_add_nested name label target ctest_arguments)
  string(REPLACE . - folder ${name})
  pupil_add_tree_test(${name} ${label} ${CMAKE_CURRENT_SOURCE_DIR}/nested.sh
    ${nested}/${folder} ${target} ${ctest_arguments} -- ${ARGN})
  pupil_use_processors(${name})
endfunction()

set(here ${CMAKE_CURRENT_SOURCE_DIR})
pupil_add_tree_test(tree.symbols quick ${here}/freestanding/symbols.sh
  $<TARGET_FILE:pupil_static> $<TARGET_FILE:pupil_shared>)
pupil_add_tree_test(tree.stack full ${here}/freestanding/stack.sh)
pupil_add_tree_test(tree.headers quick ${here}/headers/check.sh)
pupil_add_tree_test(tree.install quick ${here}/install/check.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.readme quick ${here}/readme/check.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.camera quick ${here}/readme/camera.sh ${PROJECT_BINARY_DIR})
pupil_add_tree_test(tree.tables quick ${here}/kernels/check_tables.sh)
pupil_add_tree_test(arm.instructions quick ${here}/arm/test_instructions.sh)
pupil_add_tree_test(tree.style quick ${here}/style.sh)
pupil_add_tree_test(tree.shape quick ${here}/shape.sh)
pupil_add_tree_test(tree.words quick ${here}/tree/words.sh)

# The same bits from other compilers and levels: tests/stream/digests.txt, tests/scene/digests.txt.
set(digest_only -DPUPIL_PROGRAM=OFF -DPUPIL_TESTS=ON -DPUPIL_WERROR=ON -DCMAKE_BUILD_TYPE=None)
foreach(compiler gcc clang)
  foreach(level O0 O1 O2 O3)
    pupil_add_nested(digest.${compiler}-${level} full digests "-R digest$"
      -DCMAKE_C_COMPILER=${compiler} -DCMAKE_C_FLAGS=-${level} ${digest_only})
  endforeach()
endforeach()
pupil_add_nested(digest.x86-64-v3 full digests "-R digest$"
  -DCMAKE_C_FLAGS=-O3\ -march=x86-64-v3 ${digest_only})

# At the scalar level alone, which is what a CPU without vectors has.
pupil_add_nested(level.scalar full - "-L ^quick$ -L ^level$"
  -DPUPIL_TESTS=ON -DPUPIL_LEVELS=scalar -DPUPIL_GPU=OFF -DPUPIL_WERROR=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo)

# The other presets, as a user would build them.
pupil_add_nested(preset.minimal full - - --preset minimal)
pupil_add_nested(preset.release full - - --preset release -DPUPIL_WERROR=ON)
pupil_add_tree_test(preset.absent full ${here}/absent.sh ${nested}/preset-absent)
pupil_use_processors(preset.absent)
pupil_add_nested(preset.cortex-m full - "-L quick" --preset cortex-m)
# The other folders' tests and stream.laws compare with long double, which 64-bit ARM does in software: minutes each in
# the emulator. That the laws have the same bits there is shown by stream.digest.
pupil_add_nested(preset.arm64 full - "-L quick -R ^(stream|scene|kernels) -E ^stream.laws$" --preset arm64)
pupil_add_nested(preset.musl full - "-L ^quick$ -LE ^sweep$" --preset musl)

# The quick tests under the sanitizers, then every fuzzer for a while, all from one build.
pupil_add_nested(preset.asan.build full - - --preset asan)
set_tests_properties(preset.asan.build PROPERTIES FIXTURES_SETUP asan COST ${longest_cost})
pupil_add_tree_test(preset.asan full ${here}/nested.sh
  ${nested}/preset-asan-build - "-L ^quick$ -LE ^sweep$")
set_tests_properties(preset.asan PROPERTIES FIXTURES_REQUIRED asan PROCESSORS 2 COST ${longest_cost})
# The GPU's side is mostly in the long ones.
pupil_add_tree_test(preset.asan.gles full ${here}/nested.sh
  ${nested}/preset-asan-build - "-R ^gles.(formats|adaptation|faults|fallback|calls)$")
set_tests_properties(preset.asan.gles PROPERTIES FIXTURES_REQUIRED asan PROCESSORS 2 COST ${threaded_cost})
file(GLOB fuzzers CONFIGURE_DEPENDS fuzz/fuzz_*.c)
foreach(source IN LISTS fuzzers)
  cmake_path(GET source STEM name)
  string(REPLACE fuzz_ "" name ${name})
  pupil_add_tree_test(fuzz.${name} long ${here}/nested.sh
  ${nested}/preset-asan-build - "-R ^fuzz.${name}$")
  set_tests_properties(fuzz.${name} PROPERTIES FIXTURES_REQUIRED asan)
endforeach()
add_subdirectory(abi)
