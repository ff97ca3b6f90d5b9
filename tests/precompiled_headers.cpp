// Empty: see tests/CMakeLists.txt.
