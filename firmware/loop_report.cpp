#include "firmware/loop_report.h"

#include <algorithm>

namespace touchline {

const char* describe(Device device) noexcept {
  switch (device) {
    case Device::kCamera:
      return "camera";
    case Device::kRadio:
      return "radio";
    case Device::kGpio:
      return "gpio";
  }
  return "device";
}

void ReasonText::set(std::string_view text) {
  const std::size_t size = std::min(text.size(), bytes_.size() - 1);
  std::copy_n(text.begin(), size, bytes_.begin());
  bytes_[size] = '\0';
}

}  // namespace touchline
