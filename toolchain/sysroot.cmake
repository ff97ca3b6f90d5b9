# Cross-compiles everything with Debian's compiler (tools/setup --cross) and a sysroot (tools/sysroot SUITE). Tests run under qemu.
# The preset sets TOUCHLINE_SUITE.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TOUCHLINE_SUITE)
# CMake asks the compiler for its include folders. ccache with a base_dir would return relative paths, which are wrong elsewhere.
set(ENV{CCACHE_DISABLE} 1)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(triplet aarch64-linux-gnu)
cmake_path(SET CMAKE_SYSROOT NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../build/sysroot-${TOUCHLINE_SUITE}-arm64")
if(NOT EXISTS ${CMAKE_SYSROOT}/.made-of)
  message(FATAL_ERROR "${CMAKE_SYSROOT} is missing: tools/sysroot ${TOUCHLINE_SUITE}")
endif()
set(CMAKE_C_COMPILER ${triplet}-gcc)
set(CMAKE_CXX_COMPILER ${triplet}-g++)
# The emulated Cortex-A72 has no instructions that a Raspberry Pi 4 lacks.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -cpu cortex-a72 -L ${CMAKE_SYSROOT})

# The cross compiler searches its own C and C++ libraries before the sysroot. Older headers are harmless, but the libraries in the sysroot
# need symbols of the sysroot's C++ library, so the linker must search the sysroot first.
file(GLOB runtime ${CMAKE_SYSROOT}/usr/lib/gcc/${triplet}/*)
string(JOIN " " first -L${CMAKE_SYSROOT}/usr/lib/${triplet} -L${runtime} -Wl,-rpath-link,${CMAKE_SYSROOT}/usr/lib/${triplet})
foreach(kind EXE SHARED MODULE)
  set(CMAKE_${kind}_LINKER_FLAGS_INIT "${first}")
endforeach()

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/${triplet}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_PATH} "")
