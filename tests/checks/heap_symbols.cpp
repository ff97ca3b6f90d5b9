#include "tests/checks/heap_symbols.h"

#include <cxxabi.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string_view>

#include "tests/command_output.h"

namespace touchline::checks {
namespace {

constexpr std::array<std::string_view, 22> kRefused{
    "malloc",        "calloc",       "realloc", "free",           "aligned_alloc",  "posix_memalign",
    "memalign",      "valloc",       "strdup",  "mmap",           "mmap64",         "sbrk",
    "clock_gettime", "gettimeofday", "time",    "__dynamic_cast", "_Unwind_Resume", "__cxa_atexit",
    "printf",        "puts",         "fopen",   "write"};
// operator new, new[], delete, delete[] of any signature; exceptions and guards of static variables; clocks of
// std::chrono; std::string.
constexpr std::array<std::string_view, 13> kRefusedPrefixes{
    "_Znw",      "_Zna",        "_Zdl",          "_Zda",         "__cxa_throw",   "__cxa_allocate", "__cxa_begin",
    "__cxa_end", "__cxa_guard", "__cxa_rethrow", "_ZNSt6chrono", "_ZNSt7__cxx11", "_ZNSs"};

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return status == 0 ? name.get() : symbol;
}

}  // namespace

bool is_refused_symbol(const std::string& symbol) {
  if (std::find(kRefused.begin(), kRefused.end(), symbol) != kRefused.end()) return true;
  // std::__throw_length_error and similar functions: _ZSt, the length of the name, the name.
  if (symbol.starts_with("_ZSt") && symbol.find("__throw_") != std::string::npos) return true;
  return std::any_of(kRefusedPrefixes.begin(), kRefusedPrefixes.end(),
                     [&](std::string_view prefix) { return symbol.starts_with(prefix); });
}

SymbolFindings check_heap_symbols(const std::string& nm, const std::string& archive) {
  SymbolFindings findings;
  std::istringstream lines(
      testing::output_of("'" + nm + "' --undefined-only --format=posix '" + archive + "' 2>/dev/null"));
  std::string object;
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with(":")) {  // "libx.a[y.cpp.o]:"
      const std::size_t begin = line.find('[') + 1;
      object = line.substr(begin, line.find(']') - begin);
      ++findings.objects;
      continue;
    }
    const std::string symbol = line.substr(0, line.find(' '));
    if (symbol.empty()) continue;
    ++findings.undefined;
    if (is_refused_symbol(symbol)) findings.refused.push_back(object + ": " + demangled(symbol));
  }
  return findings;
}

}  // namespace touchline::checks
