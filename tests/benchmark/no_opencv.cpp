#include "tests/benchmark/subject.h"

namespace touchline::testing {

std::string add_opencv(Subject&, const ColorGrid&) { return {}; }

}  // namespace touchline::testing
