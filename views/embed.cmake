# Writes OUT, the source of HEADER: the files of FOLDER as arrays, and functions in NAMESPACE that return them. FILES:
# "name=file" in blanks.
cmake_policy(SET CMP0007 NEW)
set(text "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\n")
separate_arguments(FILES)
foreach(entry ${FILES})
  string(REGEX MATCH "^([^=]+)=(.+)$" entry "${entry}")
  file(READ "${FOLDER}/${CMAKE_MATCH_2}" bytes HEX)
  set(name "${CMAKE_MATCH_1}")
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND text "static const unsigned char ${name}_bytes[] = {${bytes}};\n"
    "std::string_view ${name}() { return {reinterpret_cast<const char*>(${name}_bytes), sizeof(${name}_bytes)}; }\n\n")
endforeach()
file(WRITE "${OUT}" "${text}}  // namespace ${NAMESPACE}\n")
