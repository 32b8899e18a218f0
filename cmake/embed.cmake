# pupil_embed(HEADER FILES...): makes a header with the text of each file as a constant, named after the file
# (map.frag: text_map_frag), again whenever a file changes.
function(pupil_embed header)
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} "-DHEADER=${header}" "-DFILES=${ARGN}" -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    VERBATIM)
endfunction()
