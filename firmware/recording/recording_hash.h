#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "firmware/recording/step_message.h"
#include "hal/fnv1a.h"

namespace touchline::recording {

/// The hash of the results of all complete stretches. A stretch begins with a session, or after a step whose state is
/// recorded. It ends with the session, or before the first step that was lost: what follows depends on an input that
/// nobody knows. A run and its replay have the same hash.
class RecordingHash {
 public:
  /// Tells which step comes next, and whether the state after it is recorded. Returns whether the step belongs to a
  /// complete stretch; then add() has to follow.
  bool covers(const StepHeader& step, bool has_state) {
    if (step.session != session_) {
      session_ = step.session;
      next_ = 0;
      is_complete_ = true;
    }
    const bool is_covered = is_complete_ && step.number == next_ && step.session != left_out_;
    is_complete_ = is_covered || (has_state && step.session != left_out_);
    next_ = step.number + 1;
    return is_covered;
  }
  /// Leaves out a session that cannot be replayed, because it is not calibrated.
  void leave_out(std::uint32_t session) { left_out_ = session; }
  void add(const StepResults& results) {
    add_to(hash_, results);
    ++steps_;
  }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// Returns "recording hash: <16 hexadecimal digits>\n".
  [[nodiscard]] std::string line() const {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "recording hash: %016llx\n",
                  static_cast<unsigned long long>(hash_.value()));
    return text.data();
  }

 private:
  hal::Fnv1a hash_;
  std::uint32_t session_ = 0, left_out_ = 0;  // 0: none
  std::uint64_t next_ = 0, steps_ = 0;
  bool is_complete_ = false;
};

}  // namespace touchline::recording
