# Debian packages, by cpack -G DEB in a folder configured with the preset `package` (docs/install.md):
#   febiodea                the program, its manual pages and completion
#   febiodea-build          the program dea-build, which `dea build` starts: the one with CGAL, under the GPL (NOTICE)
#   libfebiodea1.0          the shared library
#   libfebiodea-dev         headers, CMake's files, the static libraries
#   python3-febiodea        the Python module
#   febiodea-plugin-source  what `dea plugin-build` compiles the plugin for FEBio from
# What programs and libraries need is found by dpkg-shlibdeps; what headers need is what packages.txt builds with.
set(deb_version "${PROJECT_VERSION}-1")
set(library_package "libfebiodea${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
set(packages febiodea ${library_package} libfebiodea-dev febiodea-plugin-source)
set(components program library development plugin_source)
if(TARGET dea-build)
  list(APPEND packages febiodea-build)
  list(APPEND components build)
endif()
if(TARGET febiodea_python)
  list(APPEND packages python3-febiodea)
  list(APPEND components python)
endif()

# Who makes the packages says so as for any Debian package, by DEBFULLNAME and DEBEMAIL.
set(maintainer "FEBioDEA developers <febiodea@localhost>")
if(DEFINED ENV{DEBEMAIL})
  set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()

# copyright and changelogs of each. The date is the commit's, so that the same commit gives the same files.
execute_process(COMMAND "${GIT_EXECUTABLE}" log -1 --format=%cD WORKING_DIRECTORY "${CMAKE_SOURCE_DIR}"
  OUTPUT_VARIABLE commit_date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit_date)
  string(TIMESTAMP commit_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
find_program(DEA_GZIP gzip REQUIRED)
set(copyright "${CMAKE_BINARY_DIR}/packaging/copyright")
file(WRITE "${copyright}" "The packages of FEBioDEA were made from its own source. Full texts of the GPL, the LGPL, the MPL and the Apache licence\n"
  "are in /usr/share/common-licenses (GPL-2, GPL-3, LGPL-2.1, MPL-1.1, MPL-2.0, Apache-2.0).\n")
foreach(part LICENSE NOTICE views/page/vendor/LICENCES.txt)
  file(READ "${CMAKE_SOURCE_DIR}/${part}" text)
  file(APPEND "${copyright}" "\n---- ${part}\n\n${text}")
endforeach()
foreach(package component IN ZIP_LISTS packages components)
  set(doc "${CMAKE_BINARY_DIR}/packaging/${package}")
  file(WRITE "${doc}/changelog.Debian" "febiodea (${deb_version}) unstable; urgency=medium\n\n"
    "  * FEBioDEA ${PROJECT_VERSION}, commit ${DEA_COMMIT}; changes are in changelog.gz.\n\n"
    " -- ${maintainer}  ${commit_date}\n")
  configure_file(CHANGELOG.md "${doc}/changelog" COPYONLY)
  foreach(file changelog.Debian changelog)
    execute_process(COMMAND "${DEA_GZIP}" -9nf "${doc}/${file}" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  install(FILES "${doc}/changelog.Debian.gz" "${doc}/changelog.gz" "${copyright}" DESTINATION "share/doc/${package}"
    COMPONENT ${component})
endforeach()

# The libraries that installed headers and the static libraries need: those of packages.txt that are for building, but for tools.
file(STRINGS packages.txt lines REGEX "^lib.* build$|-dev build$")
set(needs "${library_package} (= ${deb_version})")
foreach(line ${lines})
  string(REGEX REPLACE " build$" "" package "${line}")
  if(NOT package MATCHES "cli11|sqlite|boost|hdf5")  # the program's alone
    string(APPEND needs ", ${package}")
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME febiodea)
set(CPACK_PACKAGE_VENDOR "FEBioDEA developers")
set(CPACK_PACKAGE_CONTACT "${maintainer}")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL ${components} plugin_build)
set(CPACK_COMPONENT_DEVELOPMENT_GROUP dev)
set(CPACK_COMPONENT_PLUGIN_BUILD_GROUP dev)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# Each description: what it is, then a paragraph; CPack takes the first line as the short one.
set(about "FEBioDEA reads a FEBio model of a joint, treats bones as rigid and cartilage\n\
as a bed of springs (discrete element analysis), finds the pose in which\n\
contact, loads and ligaments balance, and writes the pressures as a FEBio\n\
plot file.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME febiodea)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "contact pressure in joints from FEBio models, in seconds\n${about}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "febiodea-build, febiodea-plugin-source")

set(CPACK_DEBIAN_BUILD_PACKAGE_NAME febiodea-build)
set(CPACK_DEBIAN_BUILD_PACKAGE_RECOMMENDS "febiodea (= ${deb_version})")
set(CPACK_DEBIAN_BUILD_DESCRIPTION "FEBio models from surfaces of bones and cartilage\n${about}\n\
The program dea-build, which dea build starts. It contains CGAL, under the GPL.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${library_package})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
file(WRITE "${CMAKE_BINARY_DIR}/packaging/shlibs"
  "libfebiodea ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${library_package} (>= ${PROJECT_VERSION})\n")
file(WRITE "${CMAKE_BINARY_DIR}/packaging/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${CMAKE_BINARY_DIR}/packaging/shlibs;${CMAKE_BINARY_DIR}/packaging/triggers")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "discrete element analysis of joint contact (shared library)\n${about}")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libfebiodea-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${needs}")
set(CPACK_DEBIAN_DEV_DESCRIPTION "discrete element analysis of joint contact (development files)\n${about}\n\
Headers, static libraries and what find_package(FEBioDEA) of CMake needs.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-febiodea)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
string(REGEX REPLACE "^[0-9]+\\." "" python_minor "${DEA_PYTHON_VERSION}")
math(EXPR next_minor "${python_minor} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${DEA_PYTHON_VERSION}), python3 (<< 3.${next_minor}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "discrete element analysis of joint contact (Python module)\n${about}\n\
The module febiodea: models, results and plot files as numpy arrays.")

set(CPACK_DEBIAN_PLUGIN_SOURCE_PACKAGE_NAME febiodea-plugin-source)
set(CPACK_DEBIAN_PLUGIN_SOURCE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PLUGIN_SOURCE_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PLUGIN_SOURCE_PACKAGE_DEPENDS "libfebiodea-dev (= ${deb_version}), cmake, ninja-build | make, g++ | c++-compiler")
set(CPACK_DEBIAN_PLUGIN_SOURCE_PACKAGE_RECOMMENDS febiodea)
set(CPACK_DEBIAN_PLUGIN_SOURCE_DESCRIPTION "source of FEBioDEA's plugin for FEBio\n${about}\n\
The plugin is compiled by dea plugin-build, for the FEBio that is installed.")
include(CPack)
