// CMake needs one source to make a precompiled header (tests/CMakeLists.txt).
