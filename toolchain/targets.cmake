# A library of hal, firmware or tools compiles several sources at a time: reading the headers takes longer than compiling a source.
# Their unnamed namespaces share their names. The core's sources are compiled one by one.
set(TOUCHLINE_SOURCES_AT_A_TIME 6 CACHE STRING "Sources of a library outside the core that are compiled together; 1: each by itself")

# touchline_library(NAME SOURCES... [LINK LIBS...]): a static library with the project's options.
function(touchline_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC touchline_options ${ARG_LINK})
    if(NOT CMAKE_UNITY_BUILD AND TOUCHLINE_SOURCES_AT_A_TIME GREATER 1)
      set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${TOUCHLINE_SOURCES_AT_A_TIME})
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE touchline_options ${ARG_LINK})
  endif()
endfunction()

# touchline_core_library(NAME ...): the same for a stage of the core, without exceptions, run-time type information and
# thread-safe statics. Eigen neither allocates nor throws there.
function(touchline_core_library name)
  touchline_library(${name} ${ARGN})
  get_target_property(type ${name} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    set_target_properties(${name} PROPERTIES UNITY_BUILD "${CMAKE_UNITY_BUILD}")
    target_link_libraries(${name} PUBLIC Eigen3::Eigen)
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics)
    target_compile_definitions(${name} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_DEBUG)
    set_property(GLOBAL APPEND PROPERTY TOUCHLINE_CORE_LIBRARIES ${name})
  endif()
endfunction()

# touchline_program(NAME [TOOL] SOURCES... [COMMANDS...] [LINK LIBS...]): an installed program. TOOL: in the package touchline-tools instead
# of touchline. COMMANDS: several sources that include CLI11, which are compiled together; see touchline_command_line.
function(touchline_program name)
  cmake_parse_arguments(ARG "TOOL" "" "SOURCES;COMMANDS;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE touchline_options ${ARG_LINK})
  if(ARG_COMMANDS)
    add_library(${name}_commands OBJECT ${ARG_COMMANDS})
    target_link_libraries(${name}_commands PRIVATE touchline_options ${ARG_LINK})
    target_compile_options(${name}_commands PRIVATE -O0)
    if(TOUCHLINE_SOURCES_AT_A_TIME GREATER 1)
      set_target_properties(${name}_commands PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${TOUCHLINE_SOURCES_AT_A_TIME})
    endif()
    target_link_libraries(${name} PRIVATE ${name}_commands)
  endif()
  # Resolves all library functions at start instead of at their first call in the loop.
  target_link_options(${name} PRIVATE -Wl,-z,now)
  add_dependencies(programs ${name})
  set_property(GLOBAL APPEND PROPERTY TOUCHLINE_PROGRAMS ${name})
  if(ARG_TOOL)
    set_property(TARGET ${name} PROPERTY TOUCHLINE_COMPONENT tools)
  else()
    set_property(TARGET ${name} PROPERTY TOUCHLINE_COMPONENT board)
  endif()
  get_target_property(component ${name} TOUCHLINE_COMPONENT)
  install(TARGETS ${name} RUNTIME COMPONENT ${component})
endfunction()

# touchline_inline_with_sanitizers(LIBRARY...): for libraries in which tests with sanitizers spend most of their time on single pixels
# and elements of vectors. Clang calls a function for each of them with -O1, and with the checks even with -O2.
function(touchline_inline_with_sanitizers)
  if(TOUCHLINE_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    foreach(library ${ARGN})
      target_compile_options(${library} PRIVATE -O2 "SHELL:-mllvm -inline-threshold=400")
    endforeach()
  endif()
endfunction()

# touchline_command_line(SOURCES...): for sources of this folder that include CLI11. Without optimization its templates compile in half
# the time, and gcc 12 does not warn about null pointers that do not exist.
function(touchline_command_line)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O0)
endfunction()

# touchline_test_options(TARGET): compiles the tests' own sources without optimization, which takes a third of the time; the
# libraries under test are optimized. Under an emulator running takes longer than compiling, so tests are optimized there; gcc 12 then
# warns about overruns in concatenated strings that do not exist.
function(touchline_test_options target)
  target_compile_options(${target} PRIVATE "$<IF:$<BOOL:${CMAKE_CROSSCOMPILING}>,-O1;-Wno-array-bounds;-Wno-stringop-overflow,-O0>"
                         $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endfunction()

# LLVM's linker takes a third of the time of GNU's for a test program. Installed programs are linked by the compiler's default.
find_program(TOUCHLINE_LLD ld.lld)

# touchline_test(NAME SOURCES... [LINK LIBS...] [EIGEN] [LONG] [BUILDS BUILDS...] [LABELS LABEL] [SLOW PATTERNS...]): a GoogleTest program.
# EIGEN: its precompiled headers contain Eigen.
# LONG: CTest starts its tests first, so that no processor waits for them at the end.
# BUILDS: where tools/test runs it, by preset: the build in which its tests find most. asan (the default): parsers and short tests; release:
# long games and whole programs, which take several times as long with sanitizers; tsan: tests that start threads. Kernels are in release and asan.
# Each build's programs are the target test-programs-BUILD, its tests are those without a label not-in-BUILD.
# LABELS: CTest labels of all its tests. arm64: tools/test-arm runs them for that processor.
# SLOW: patterns (as for --gtest_filter) of tests that get the label slow. They run in the optimized build only: tools/test runs them if
# release is one of BUILDS, else only `tools/test --all` does.
# CTest starts each test by itself, which takes longer than most tests do. It runs all tests of a program in a few processes
# (tests-together.cmake) with sanitizers, under an emulator, and if TOUCHLINE_TESTS_TOGETHER is set when CTest starts (tools/test).
function(touchline_test name)
  cmake_parse_arguments(ARG "EIGEN;LONG" "" "SOURCES;LINK;BUILDS;LABELS;SLOW" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE touchline_options ${ARG_LINK} touchline_test_main GTest::gtest)
  touchline_test_options(${name})
  if(TOUCHLINE_LLD AND NOT CMAKE_CROSSCOMPILING)
    target_link_options(${name} PRIVATE -fuse-ld=lld)
  endif()
  if(ARG_EIGEN)
    target_precompile_headers(${name} REUSE_FROM touchline_test_eigen_headers)
  else()
    target_precompile_headers(${name} REUSE_FROM touchline_test_main)
  endif()
  add_dependencies(test-programs ${name})
  if(NOT ARG_BUILDS)
    set(ARG_BUILDS asan)
  endif()
  foreach(group ${ARG_BUILDS} ${ARG_LABELS})
    if(NOT TARGET test-programs-${group})
      add_custom_target(test-programs-${group})
    endif()
    add_dependencies(test-programs-${group} ${name})
  endforeach()
  set(labels "${ARG_LABELS}")
  foreach(build release asan tsan)
    if(NOT build IN_LIST ARG_BUILDS)
      list(APPEND labels not-in-${build})
    endif()
  endforeach()

  string(JOIN ":" slow ${ARG_SLOW})
  set(command $<TARGET_FILE:${name}>)
  set(properties "")
  if(ARG_LONG)
    list(APPEND properties COST 100)
  endif()
  if(CMAKE_CROSSCOMPILING)
    list(PREPEND command ${CMAKE_CROSSCOMPILING_EMULATOR})
    set(slow "")
    # The bracket is last, because CMake does not split a list after it.
    list(APPEND properties TIMEOUT 7200 SKIP_REGULAR_EXPRESSION "\\[  SKIPPED|DISABLED TEST")
  endif()
  set(together "include([==[${CMAKE_SOURCE_DIR}/toolchain/tests-together.cmake]==])")
  foreach(variable properties labels slow command name)
    string(PREPEND together "set(${variable} [==[${${variable}}]==])\n")
  endforeach()
  if(CMAKE_CROSSCOMPILING OR TOUCHLINE_SANITIZE)
    set(script "${together}\n")
  else()
    get_property(others DIRECTORY PROPERTY TEST_INCLUDE_FILES)
    set_property(DIRECTORY PROPERTY TEST_INCLUDE_FILES "")
    set(label "")
    if(ARG_LABELS)
      set(label PROPERTIES LABELS ${ARG_LABELS})
    endif()
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST TEST_FILTER "-${slow}" ${label})
    if(slow)
      gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST TEST_FILTER "${slow}" TEST_LIST ${name}_slow_tests
                           PROPERTIES LABELS slow)
      add_test(NAME ${name}.SlowTestsExist COMMAND bash ${CMAKE_SOURCE_DIR}/tests/checks/patterns-match $<TARGET_FILE:${name}> ${ARG_SLOW})
      set_tests_properties(${name}.SlowTestsExist PROPERTIES LABELS "${labels}")
    endif()
    get_property(each DIRECTORY PROPERTY TEST_INCLUDE_FILES)
    set_property(DIRECTORY PROPERTY TEST_INCLUDE_FILES ${others})
    list(TRANSFORM each REPLACE "(.+)" "include([==[\\1]==])\n")
    string(JOIN "" each ${each})
    set(script "if(DEFINED ENV{TOUCHLINE_TESTS_TOGETHER})\n${together}\nelse()\n${each}endif()\n")
  endif()
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}_tests.cmake CONTENT "${script}")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}_tests.cmake)
endfunction()
