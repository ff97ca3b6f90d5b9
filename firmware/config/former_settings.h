#pragma once

#include <array>
#include <string_view>

namespace touchline::config {

/// A key, or a word for it, that earlier versions knew.
struct FormerSetting {
  std::string_view key;   // path without list indices, "scan.kernel"
  std::string_view word;  // the former value; empty: the key itself was removed
  std::string_view advice;
};

/// Advice for files that were written for an earlier version. It is shown instead of "unknown key" or "is not one of".
inline constexpr std::string_view kNewPlay = "belonged to the former play; remove the line";
inline constexpr std::array kFormerSettings{
    FormerSetting{"scan.kernel", "avx512",
                  "the kernels for AVX-512 are gone, because they were no faster than those for AVX2; remove the line"},
    FormerSetting{"adaptation.most_light", "", "is called max_light now; rename the key"},
    FormerSetting{"adaptation.most_shift", "", "is called max_shift now; rename the key"},
    FormerSetting{"control.motion", "", "the control laws have no gains any more; remove the section"},
    FormerSetting{"control.play.behind_ball_m", "", kNewPlay},
    FormerSetting{"control.play.corridor_m", "", kNewPlay},
    FormerSetting{"control.play.corridor_slope", "", kNewPlay},
    FormerSetting{"control.play.push_speed_mps", "", kNewPlay},
    FormerSetting{"control.play.wall_m", "", kNewPlay},
    FormerSetting{"control.play.attacker_hysteresis_m", "", kNewPlay},
    FormerSetting{"control.play.slot_hysteresis_m", "", kNewPlay},
    FormerSetting{"control.play.stuck_after_s", "", kNewPlay},
    FormerSetting{"control.play.escape_for_s", "", kNewPlay},
    FormerSetting{"control.play.escape_speed_mps", "", kNewPlay},
};

/// Returns the advice, or "" if no earlier version knew the key, or this word for it.
constexpr std::string_view former_setting(std::string_view key, std::string_view word = "") {
  for (const FormerSetting& setting : kFormerSettings) {
    if (setting.key == key && setting.word == word) return setting.advice;
  }
  return "";
}

}  // namespace touchline::config
