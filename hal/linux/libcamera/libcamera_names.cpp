#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>

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

void take_libcamera_priority(int priority) noexcept {
  if (priority <= 0) return;
  const sched_param below{.sched_priority = std::max(priority - 1, 1)};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &below));
}

std::vector<LibcameraOffer> libcamera_offers(LibcameraLink* link, int priority) {
  std::vector<LibcameraOffer> offers;
  if (link == nullptr) return offers;
  take_libcamera_priority(priority);
  std::vector<LibcameraName> names;
  if (link->cameras(names) == 0) {
    for (LibcameraName& name : names) {
      LibcameraOffer& offer = offers.emplace_back();
      // A camera that has just been unplugged offers nothing.
      if (link->formats(name.id, offer.formats) != 0) offer.formats.clear();
      offer.name = std::move(name);
    }
  }
  link->release();
  return offers;
}

std::vector<LibcameraName> libcamera_cameras() {
  std::vector<LibcameraName> found;
  const std::unique_ptr<LibcameraLink> link = make_libcamera_link();
  if (link == nullptr || link->cameras(found) != 0) return {};
  return found;
}

}  // namespace touchline::hal
