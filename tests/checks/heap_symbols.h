#pragma once

#include <cstddef>
#include <string>
#include <vector>

// Checks the undefined symbols in the objects of a static library: the core must not allocate memory and must not
// throw.
namespace touchline::checks {

struct SymbolFindings {
  std::size_t objects = 0, undefined = 0;  // numbers of examined objects and symbols
  std::vector<std::string> refused;        // such as "region.cpp.o: operator new(unsigned long)"
};

/// Runs `nm` on the archive. Returns zero objects if it cannot be read.
SymbolFindings check_heap_symbols(const std::string& nm, const std::string& archive);

/// Returns true for the mangled name of anything that allocates, frees, throws, catches, needs run-time type
/// information, locks a static variable or reads a clock.
bool is_refused_symbol(const std::string& symbol);

}  // namespace touchline::checks
