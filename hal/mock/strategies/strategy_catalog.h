#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/control/strategy.h"
#include "hal/result.h"

namespace touchline::hal::mock {

using StrategyPointer = std::unique_ptr<Strategy, void (*)(Strategy*)>;

/// Makes a strategy of this class, which the pointer owns.
template <class Kind, class... Arguments>
StrategyPointer make_strategy(Arguments&&... arguments) {
  return {new Kind(std::forward<Arguments>(arguments)...),
          [](Strategy* strategy) { delete static_cast<Kind*>(strategy); }};
}

/// A strategy that can be chosen by its name.
struct StrategyEntry {
  std::string_view name;
  std::string_view description;  // one line for --help and the documentation
  StrategyPointer (*create)(std::uint64_t seed) = nullptr;
  // Limits of the drive with which the published programs play; their wheel base is ignored. None: those of the team.
  std::optional<DriveParameters> drive;
};

/// The strategies by name: the reference opponents, the built-in play, and those that a program adds.
class StrategyCatalog {
 public:
  StrategyCatalog();

  /// Adds a strategy. Its texts must outlive this object.
  void add(const StrategyEntry& entry) { entries_.push_back(entry); }
  [[nodiscard]] const std::vector<StrategyEntry>& entries() const { return entries_; }
  /// Returns null if there is no strategy of this name.
  [[nodiscard]] const StrategyEntry* find(std::string_view name) const;
  /// Returns the names, separated by commas.
  [[nodiscard]] std::string names() const;
  /// Returns one line per strategy, with its description, for --help.
  [[nodiscard]] std::string help() const;
  /// Makes a strategy. Only strategies that draw random numbers use the seed. kNotFound: no such name; the message
  /// lists the names. Allocates; the strategy itself does not.
  [[nodiscard]] Result<StrategyPointer> create(std::string_view name, std::uint64_t seed) const;

 private:
  std::vector<StrategyEntry> entries_;
};

/// Returns the team's parameters with the limits of the drive that the strategy wants.
ControlParameters parameters_for(const StrategyEntry& entry, const ControlParameters& team);

}  // namespace touchline::hal::mock
