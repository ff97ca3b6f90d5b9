#pragma once

#include <cstddef>
#include <string>
#include <vector>

// What the objects of a static library ask of others: the core must ask nobody for memory, and throw nothing.
namespace touchline::checks {

struct SymbolFindings {
  std::size_t objects = 0, undefined = 0;  // looked at
  std::vector<std::string> refused;        // "region.cpp.o: operator new(unsigned long)"
};

/// Runs `nm` over the archive. No objects: it could not be read.
SymbolFindings check_heap_symbols(const std::string& nm, const std::string& archive);

/// True for the mangled name of anything that allocates, frees, throws, catches, needs run-time type information, locks
/// a static variable or reads a clock.
bool is_refused_symbol(const std::string& symbol);

}  // namespace touchline::checks
