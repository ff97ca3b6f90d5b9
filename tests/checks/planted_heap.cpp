// Planted fault: a library with everything that the core must not do. heap_symbols_test.cpp must find it.
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace touchline::checks {

int* planted_new(int value) { return new int(value); }
void planted_delete(int* value) { delete value; }
void* planted_malloc(std::size_t size) { return std::malloc(size); }
void planted_throw() { throw std::runtime_error("planted"); }
void planted_growth(std::vector<int>& values) { values.push_back(1); }
long planted_clock() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
const std::vector<int>& planted_guard(std::size_t size) {
  static const std::vector<int> values(size);
  return values;
}

}  // namespace touchline::checks
