# A program for browsers and node: emscripten's compiler, 32-bit WebAssembly with its own exceptions.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_C_FLAGS_INIT -ffp-contract=off)
set(CMAKE_CXX_FLAGS_INIT "-ffp-contract=off -fwasm-exceptions")
include("${CMAKE_CURRENT_LIST_DIR}/found.cmake")
