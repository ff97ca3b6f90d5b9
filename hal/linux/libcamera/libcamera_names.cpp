#include <algorithm>

#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::hal {

std::string list_of(const std::vector<LibcameraName>& cameras) {
  std::string list;
  for (const LibcameraName& camera : cameras) {
    if (!list.empty()) list += ", ";
    list += camera.id + " (" + camera.model + ")";
  }
  return list.empty() ? "none" : list;
}

const LibcameraName* choose(const std::vector<LibcameraName>& cameras, const std::string& device) {
  const auto first = [&](auto&& is) {
    const auto found = std::find_if(cameras.begin(), cameras.end(), is);
    return found != cameras.end() ? &*found : nullptr;
  };
  if (device == "auto") {
    const LibcameraName* const inner = first([](const LibcameraName& camera) { return !camera.external; });
    return inner != nullptr || cameras.empty() ? inner : &cameras.front();
  }
  if (const LibcameraName* const exact = first([&](const LibcameraName& camera) { return camera.id == device; })) {
    return exact;
  }
  const auto has = [&](const LibcameraName& camera) { return camera.id.find(device) != std::string::npos; };
  return !device.empty() && std::count_if(cameras.begin(), cameras.end(), has) == 1 ? first(has) : nullptr;
}

std::vector<LibcameraName> libcamera_cameras() {
  std::vector<LibcameraName> found;
  const std::unique_ptr<LibcameraLink> link = make_libcamera_link();
  if (link == nullptr || link->cameras(found) != 0) return {};
  return found;
}

}  // namespace touchline::hal
