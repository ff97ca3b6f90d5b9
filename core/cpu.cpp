#include "core/cpu.h"

#include <string_view>

namespace touchline {
namespace {

struct Feature {
  std::string_view name;
  bool present;
};

// Knows every feature in the lists of cpu.h.
bool has_feature(std::string_view name) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const Feature features[] = {{"avx2", __builtin_cpu_supports("avx2") != 0},
                              {"bmi", __builtin_cpu_supports("bmi") != 0},
                              {"popcnt", __builtin_cpu_supports("popcnt") != 0}};
#elif defined(__aarch64__)
  const Feature features[] = {{"neon", true}};  // every 64-bit ARM processor has NEON
#else
  const Feature features[] = {{"", true}};
#endif
  for (const Feature& feature : features) {
    if (feature.name == name) return feature.present;
  }
  return false;
}

bool has_features(std::string_view list) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const bool is_last = comma == std::string_view::npos;
    // (substr() is avoided, because it can throw.)
    if (!has_feature({list.data(), is_last ? list.size() : comma})) return false;
    list.remove_prefix(is_last ? list.size() : comma + 1);
  }
  return true;
}

}  // namespace

bool cpu_supports(KernelChoice set) {
  switch (set) {
    case KernelChoice::kFastest:
      return true;
#define TOUCHLINE_SET(family, choice, word, features, ...) \
  case KernelChoice::choice:                               \
    return has_features(features);
      TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)
#undef TOUCHLINE_SET
  }
  return false;
}

KernelChoice resolve(KernelChoice set) {
  if (set != KernelChoice::kFastest) return set;
  KernelChoice fastest = KernelChoice::kPortable;
  for (const Choice<KernelChoice>& choice : kKernelChoices) {
    if (choice.value != KernelChoice::kFastest && cpu_supports(choice.value)) fastest = choice.value;
  }
  return fastest;
}

}  // namespace touchline
