# pupil_room(TARGET [OPTION]): adds the C files of the current folder to TARGET. Files named *_absent.c replace
# all others if OPTION is OFF, and are left out if it is ON.
function(pupil_room target)
  file(GLOB files CONFIGURE_DEPENDS *.c)
  file(GLOB stubs CONFIGURE_DEPENDS *_absent.c)
  if(ARGC GREATER 1 AND NOT ${ARGV1})
    set(files ${stubs})
  elseif(stubs)
    list(REMOVE_ITEM files ${stubs})
  endif()
  target_sources(${target} PRIVATE ${files})
endfunction()

# pupil_choose(TARGET OPTION STUB FILES...): FILES if OPTION is ON, STUB if it is OFF.
function(pupil_choose target option stub)
  if(${option})
    target_sources(${target} PRIVATE ${ARGN})
  else()
    target_sources(${target} PRIVATE ${stub})
  endif()
endfunction()
