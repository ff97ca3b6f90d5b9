# touchline_library(NAME SOURCES... [LINK LIBS...]): a static library with the project's options.
function(touchline_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC touchline_options ${ARG_LINK})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE touchline_options ${ARG_LINK})
  endif()
endfunction()

# touchline_alone(SOURCES...): sources of this folder that even a unity build (CMakePresets.json) compiles by themselves:
# they call things local to the file as another of their library does.
function(touchline_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# touchline_core_library(NAME ...): the same for a stage of the core: no exceptions, no run-time type information,
# no thread-safe statics, and Eigen neither allocates nor throws.
function(touchline_core_library name)
  touchline_library(${name} ${ARGN})
  get_target_property(type ${name} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    target_link_libraries(${name} PUBLIC Eigen3::Eigen)
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics)
    target_compile_definitions(${name} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_DEBUG)
    set_property(GLOBAL APPEND PROPERTY TOUCHLINE_CORE_LIBRARIES ${name})
  endif()
endfunction()

# touchline_program(NAME SOURCES... [LINK LIBS...]): an installed program.
function(touchline_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE touchline_options ${ARG_LINK})
  # Else a library's function is looked up when the loop calls it first.
  target_link_options(${name} PRIVATE -Wl,-z,now)
  add_dependencies(programs ${name})
  set_property(GLOBAL APPEND PROPERTY TOUCHLINE_PROGRAMS ${name})
  install(TARGETS ${name} RUNTIME)
endfunction()

# touchline_command_line(SOURCES...): sources of this folder that include CLI11. Its templates compile in half the time
# when nothing is optimized, and gcc 12 then sees no null pointers where they would be inlined.
function(touchline_command_line)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O0)
endfunction()

# touchline_test_options(TARGET): the tests' own code is not optimized and reads its usual headers precompiled (tests/CMakeLists.txt): it
# compiles in a third of the time, and what it tests stays as it is. Under an emulator running costs more than compiling; gcc 12 then
# sees overruns in sums of texts where there are none.
function(touchline_test_options target)
  target_compile_options(${target} PRIVATE "$<IF:$<BOOL:${CMAKE_CROSSCOMPILING}>,-O1;-Wno-array-bounds;-Wno-stringop-overflow,-O0>"
                         $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endfunction()

# touchline_test(NAME SOURCES... [LINK LIBS...]): a GoogleTest program whose tests CTest runs one by one; under an emulator, which
# translates a program anew at each start, all at once.
function(touchline_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE touchline_options ${ARG_LINK} GTest::gtest_main)
  touchline_test_options(${name})
  target_precompile_headers(${name} REUSE_FROM touchline_test_headers)
  if(CMAKE_CROSSCOMPILING)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 7200 SKIP_REGULAR_EXPRESSION "\\[  SKIPPED|DISABLED TEST")
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST)
endfunction()
