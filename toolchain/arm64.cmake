# Cross-compiles for 64-bit ARM boards with Debian's compiler (tools/setup --arm). Tests run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
# The emulated Cortex-A72 has no instructions that a Raspberry Pi 4 lacks.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -cpu cortex-a72 -L /usr/aarch64-linux-gnu)
# Eigen has headers only: those of the build machine are used.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
