# The Python module for any Linux on x86-64 with glibc 2.34 or later: as the program for any Linux, but with glibc and the compiler's
# libgcc_s of the machine it runs on.
include("${CMAKE_CURRENT_LIST_DIR}/linux.cmake")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# hypot of glibc 2.35 differs from the older one in errno alone (python/old_glibc.cpp)
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-static-libstdc++ -s -Wl,--exclude-libs,ALL -Wl,--wrap=hypot")
