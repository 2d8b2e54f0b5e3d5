# Installs the sources ${patterns} below ${from} in ${to}. What they include of ours is found there as <febiodea/springs/press.h>,
# for "src/springs/press.h" of the tree.
file(GLOB_RECURSE files RELATIVE "${from}" ${patterns})
foreach(file IN LISTS files)
  file(READ "${from}/${file}" text)
  string(REGEX REPLACE "#include \"(src/)?([^\"]+)\"" "#include <febiodea/\\2>" text "${text}")
  file(WRITE "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${to}/${file}" "${text}")
endforeach()
