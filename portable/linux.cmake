# A program for any Linux on x86-64: Debian's compiler, all libraries static. Nothing of the system but the compiler's own is found.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER gcc)
set(CMAKE_CXX_COMPILER g++)
set(CMAKE_C_FLAGS_INIT -ffp-contract=off)
set(CMAKE_CXX_FLAGS_INIT -ffp-contract=off)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -s")
include("${CMAKE_CURRENT_LIST_DIR}/found.cmake")
