# cmake -DHEADER=... -DFILES=a;b -P embed_files.cmake: run by pupil_embed. Each line is a literal, so that no
# compiler's limit for a line is met. The limit for a literal, 4095 characters, holds for a file:
# -Woverlength-strings shows it.
set(all "/* Made from the shaders by cmake/embed_files.cmake. */\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(MAKE_C_IDENTIFIER ${name} name)
  file(READ ${file} text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  string(REPLACE "\n" "\\n\"\n    \"" text "${text}")
  string(APPEND all "static const char text_${name}[] =\n    \"${text}\";\n")
endforeach()
file(WRITE ${HEADER} "${all}")
