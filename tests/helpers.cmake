# What the folders of tests share. CMakeLists.txt says what the labels mean.
set(pupil_tests ${CMAKE_CURRENT_LIST_DIR})
# Against hanging only; a machine that is busy may take several times as long as an idle one.
set(quick_timeout_s 300)
set(full_timeout_s 1800)
set(long_timeout_s 1800)
# Under emulation, and where each branch is counted, a quick test takes minutes.
if(CMAKE_CROSSCOMPILING OR CMAKE_C_FLAGS MATCHES "--coverage")
  set(quick_timeout_s 900)
endif()
# ctest begins with the tests of the highest cost: first those that use two processors, which would else wait until two
# are free at once, then those that are long, so that none is left alone for the end.
set(quick_cost 0)
set(waiting_cost 50)
set(full_cost 100)
set(long_cost 100)
set(threaded_cost 200)
set(longest_cost 300)

# Compiled shaders are kept here. tests/tree gives its build with sanitizers the same folder: the drivers are those of
# the machine in either.
set(PUPIL_SHADER_CACHE ${PROJECT_BINARY_DIR}/shader-cache CACHE PATH "Where the tests keep compiled shaders")
mark_as_advanced(PUPIL_SHADER_CACHE)

# pupil_add_test(NAME LABEL COMMAND...)
function(pupil_add_test name label)
  add_test(NAME ${name} COMMAND sh ${pupil_tests}/run_test.sh ${ARGN} WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  set_tests_properties(${name} PROPERTIES
    SKIP_RETURN_CODE 77 TIMEOUT ${${label}_timeout_s} COST ${${label}_cost} LABELS ${label})
  # Not in the home of the user who runs the tests. Without a cache every object compiles its shaders again: minutes.
  # And no test begins with the exposure that another one has kept: nothing can be made there.
  set(environment MESA_SHADER_CACHE_DIR=${PUPIL_SHADER_CACHE} XDG_STATE_HOME=/dev/null)
  # Mesa's driver on the CPU compiles shaders in half the time if it does not optimise them. The long tests let it.
  if(NOT label STREQUAL long)
    list(APPEND environment GALLIVM_PERF=nopt)
  endif()
  if(PUPIL_SANITIZE)
    list(APPEND environment LSAN_OPTIONS=suppressions=${pupil_tests}/lsan.supp:print_suppressions=0)
  endif()
  if(TARGET pupil)
    list(APPEND environment "PUPIL_PROGRAM=$<TARGET_FILE:pupil>")
  endif()
  if(TARGET run_fake)
    list(APPEND environment "PUPIL_RUN_FAKE=$<TARGET_FILE:run_fake>")
  endif()
  set_property(TEST ${name} PROPERTY ENVIRONMENT ${environment})
endfunction()

# pupil_use_processors(NAMES...): tests that use all processors by themselves, or whose subject is how soon something
# happens. Nothing else runs at the same time on a machine with two.
function(pupil_use_processors)
  set_tests_properties(${ARGN} PROPERTIES PROCESSORS 2 COST ${threaded_cost})
endfunction()

# pupil_program(TARGET SOURCES...): a program of the tests for Linux, in the build's folder tests. Most of its time is
# spent in what it links, so its own files are optimised less: they compile in two thirds of the time. What a folder's
# programs share is not among them.
function(pupil_program target)
  add_executable(${target} ${ARGN})
  pupil_linux(${target})
  if(NOT PUPIL_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
  endif()
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  target_include_directories(${target} PRIVATE ${pupil_tests})
endfunction()

# pupil_test_folder([LIBRARIES libraries] [SOURCES files that all programs of the folder share] [INCLUDES folders]
#   [MARK a label for all] [FULL names] [LONG names] [SWEEP names] [LEVEL names] [THREADED names]
#   [WAITING names: begun early, because they take long and need little]
#   [ALL names: with all of their cases in the long tests, as NAME.all (check.h: check_every)])
# The tests of the current folder. A name that is no test of it is an error.
function(pupil_test_folder)
  set(lists LIBRARIES SOURCES INCLUDES FULL LONG SWEEP LEVEL THREADED WAITING ALL)
  cmake_parse_arguments(PARSE_ARGV 0 FOLDER "" "MARK" "${lists}")
  if(FOLDER_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "pupil_test_folder: what is ${FOLDER_UNPARSED_ARGUMENTS}?")
  endif()
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${pupil_tests} OUTPUT_VARIABLE folder)
  string(REPLACE / _ target_prefix ${folder})
  string(REPLACE / . test_prefix ${folder})
  if(FOLDER_SOURCES)
    set(objects tests_${target_prefix})
    add_library(${objects} OBJECT ${FOLDER_SOURCES})
    pupil_linux(${objects})
    target_include_directories(${objects} PRIVATE ${pupil_tests} ${FOLDER_INCLUDES})
    target_link_libraries(${objects} PRIVATE ${FOLDER_LIBRARIES})
  endif()
  file(GLOB files CONFIGURE_DEPENDS test_*.c test_*.sh)
  foreach(file IN LISTS files)
    cmake_path(GET file STEM name)
    cmake_path(GET file EXTENSION extension)
    string(REGEX REPLACE "^test_" "" name ${name})
    set(command sh ${file})
    if(extension STREQUAL .c)
      set(target test_${target_prefix}_${name})
      pupil_program(${target} ${file})
      target_include_directories(${target} PRIVATE ${FOLDER_INCLUDES})
      target_compile_definitions(${target} PRIVATE
        PUPIL_SOURCE_DIR="${PROJECT_SOURCE_DIR}" PUPIL_BINARY_DIR="${PROJECT_BINARY_DIR}")
      target_link_libraries(${target} PRIVATE ${FOLDER_LIBRARIES} ${objects} tests_common Threads::Threads m)
      set(command ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${target}>)
    endif()
    set(label quick)
    if(name IN_LIST FOLDER_LONG)
      set(label long)
    elseif(name IN_LIST FOLDER_FULL)
      set(label full)
    endif()
    pupil_add_test(${test_prefix}.${name} ${label} ${command})
    set_property(TEST ${test_prefix}.${name} APPEND PROPERTY LABELS ${FOLDER_MARK})
    if(name IN_LIST FOLDER_ALL)
      pupil_add_test(${test_prefix}.${name}.all long ${command} 20261120 all)
    endif()
  endforeach()
  foreach(name IN LISTS FOLDER_FULL FOLDER_LONG FOLDER_SWEEP FOLDER_LEVEL FOLDER_THREADED FOLDER_WAITING FOLDER_ALL)
    if(NOT TEST ${test_prefix}.${name})
      message(FATAL_ERROR "${folder}: there is no test_${name} to be given a label")
    endif()
  endforeach()
  foreach(name IN LISTS FOLDER_SWEEP)
    set_property(TEST ${test_prefix}.${name} APPEND PROPERTY LABELS sweep)
  endforeach()
  foreach(name IN LISTS FOLDER_LEVEL)
    set_property(TEST ${test_prefix}.${name} APPEND PROPERTY LABELS level)
  endforeach()
  foreach(name IN LISTS FOLDER_WAITING)
    set_tests_properties(${test_prefix}.${name} PROPERTIES COST ${waiting_cost})
  endforeach()
  foreach(name IN LISTS FOLDER_THREADED)
    pupil_use_processors(${test_prefix}.${name})
  endforeach()
endfunction()

# pupil_window_test(NAMES...): tests that open a window. Under the sanitizers, leaks in the window system's libraries
# (lsan.supp) are recognised from the whole stack of each allocation, which takes its time.
function(pupil_window_test)
  if(PUPIL_SANITIZE)
    set_property(TEST ${ARGN} APPEND PROPERTY ENVIRONMENT ASAN_OPTIONS=fast_unwind_on_malloc=0)
  endif()
endfunction()
