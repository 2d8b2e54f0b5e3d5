# The Python module for any Linux on x86-64 with glibc 2.34 or later: Debian's compiler, all libraries but glibc and the compiler's
# libgcc_s static. Nothing of the system but the compiler's own is found.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER gcc)
set(CMAKE_CXX_COMPILER g++)
set(CMAKE_C_FLAGS_INIT -ffp-contract=off)
set(CMAKE_CXX_FLAGS_INIT -ffp-contract=off)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# hypot of glibc 2.35 differs from the older one in errno alone (python/old_glibc.cpp)
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-static-libstdc++ -s -Wl,--exclude-libs,ALL -Wl,--wrap=hypot")
include("${CMAKE_CURRENT_LIST_DIR}/found.cmake")
