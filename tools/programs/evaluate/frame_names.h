#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"

namespace touchline::evaluate {

/// Names the frames of two files so that they can be paired: by file name if all names are unique in both files,
/// otherwise by frame number.
class FrameNames {
 public:
  FrameNames(const std::vector<FrameRecord>& a, const std::vector<FrameRecord>& b)
      : uses_files_(are_unique(a) && are_unique(b)) {}
  [[nodiscard]] std::string of(const FrameRecord& record) const {
    return uses_files_ ? record.file : std::to_string(record.frame);
  }
  [[nodiscard]] bool uses_files() const { return uses_files_; }

 private:
  static bool are_unique(const std::vector<FrameRecord>& records) {
    std::set<std::string> names;
    return std::all_of(records.begin(), records.end(), [&names](const FrameRecord& record) {
      return !record.file.empty() && names.insert(record.file).second;
    });
  }

  bool uses_files_;
};

}  // namespace touchline::evaluate
