#pragma once

#include <unistd.h>

#include <cstdio>

#include "tests/benchmark/measurement.h"

namespace touchline::testing {

/// Searches for the slowest picture for `seconds` of CPU time: changes a random recipe as long as it gets slower, and
/// then begins with another one. `Found` contains a recipe (`recipe`) and its measured time (`times_a_field`);
/// `evaluate(recipe, calls)` measures a recipe. Returns the slowest `Found`, and the number of pictures in `pictures`.
template <class Found, class Start, class Change, class Evaluate>
Found climb(double seconds, Start start, Change change, Evaluate evaluate, std::size_t& pictures) {
  // After this many pictures without an improvement, the search restarts.
  constexpr int kRestartAfter = 150;
  constexpr int kFewCalls = 7, kManyCalls = 25;
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const double begin = cpu_time_us();
  const auto is_over = [&] { return cpu_time_us() - begin >= seconds * 1e6; };
  Found best;
  pictures = 0;
  while (!is_over()) {
    Found here = evaluate(start(), kFewCalls);
    for (int since = 0; since < kRestartAfter && !is_over(); ++since, ++pictures) {
      Found next = evaluate(change(here.recipe), kFewCalls);
      // Measure a new maximum again with more calls, so that a single disturbance cannot win.
      if (next.times_a_field > here.times_a_field) next = evaluate(next.recipe, kManyCalls);
      if (next.times_a_field <= here.times_a_field) continue;
      if (next.times_a_field > here.times_a_field * 1.01) since = 0;
      here = next;
    }
    if (here.times_a_field > best.times_a_field) best = here;
    if (is_terminal) {
      std::fprintf(stderr, "\r%4.0f of %.0f s, %zu pictures, slowest %.2f times a field ",
                   (cpu_time_us() - begin) * 1e-6, seconds, pictures, best.times_a_field);
    }
  }
  if (is_terminal) std::fprintf(stderr, "\r%60s\r", "");
  return best;
}

}  // namespace touchline::testing
