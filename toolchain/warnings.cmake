# Warnings and sanitizers that every target of the project gets.
add_library(touchline_options INTERFACE)
target_include_directories(touchline_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(touchline_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Wnon-virtual-dtor
  -Wold-style-cast -Woverloaded-virtual -Wnull-dereference -Wimplicit-fallthrough -Wundef -Wunused)
if(TOUCHLINE_WERROR)
  target_compile_options(touchline_options INTERFACE -Werror)
endif()
# No fused multiply-add: x86 and ARM, gcc and clang round alike and compute the same bits.
target_compile_options(touchline_options INTERFACE -ffp-contract=off)
if(TOUCHLINE_SANITIZE)
  target_compile_options(touchline_options INTERFACE -fsanitize=${TOUCHLINE_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all)
  # The address sanitizer finds these errors too, and these checks add half to the compile time. Alignment and bounds stay on.
  if(TOUCHLINE_SANITIZE MATCHES "undefined" AND TOUCHLINE_SANITIZE MATCHES "address")
    target_compile_options(touchline_options INTERFACE -fno-sanitize=null,object-size)
  endif()
  target_link_options(touchline_options INTERFACE -fsanitize=${TOUCHLINE_SANITIZE})
  # The C++ library's checks of indices and empty containers.
  target_compile_definitions(touchline_options INTERFACE _GLIBCXX_ASSERTIONS)
endif()

# For code that uses objects of the core's classes with virtual functions: clang's check of their types needs type information, and the core
# has none.
add_library(touchline_without_type_checks INTERFACE)
if(TOUCHLINE_SANITIZE MATCHES "undefined" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(touchline_without_type_checks INTERFACE -fno-sanitize=vptr)
endif()
