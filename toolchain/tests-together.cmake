# CTest includes this to run all tests of a GoogleTest program in a few processes, instead of each by itself (touchline_test in
# targets.cmake). Variables:
#   name         of the program
#   command      the program, after an emulator if it needs one
#   slow         patterns of the tests with the label slow, separated by colons, or empty
#   labels       of all tests
#   properties   further properties of the tests that are not slow
foreach(part RANGE 1 4)
  math(EXPR index "${part} - 1")
  add_test(${name}.${part} ${command} --gtest_filter=-${slow})
  set_tests_properties(${name}.${part} PROPERTIES LABELS "${labels}" ENVIRONMENT "GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=${index}" ${properties})
endforeach()
if(slow)
  # First, because it takes longest.
  add_test(${name}.slow ${command} --gtest_filter=${slow})
  set_tests_properties(${name}.slow PROPERTIES LABELS "${labels};slow" COST 100)
endif()
