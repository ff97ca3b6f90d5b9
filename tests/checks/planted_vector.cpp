// Planted fault for vector_symbols_test.cpp: a function that other objects may define too, compiled for AVX2.
#include <array>
#include <cstddef>

namespace touchline::checks {

template <std::size_t kCount>
[[gnu::target("avx2"), gnu::noinline]] float planted_sum(const std::array<float, kCount>& values) {
  float sum = 0;
  for (const float value : values) sum += value;
  return sum;
}
template float planted_sum<8>(const std::array<float, 8>&);

}  // namespace touchline::checks
