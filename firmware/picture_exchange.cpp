#include "firmware/picture_exchange.h"

#include <algorithm>
#include <cstring>

#include "core/pipeline.h"

namespace touchline {

void PictureExchange::put_findings(const Pipeline& pipeline, const StepTrace& trace) noexcept {
  const std::size_t count = trace.regions.size();
  if (!wants_findings_ || trace.frame.sightings != nullptr || trace.sightings.verdicts.size() != count) return;
  pipeline.copy_classifier(findings_->classifier);
  findings_->regions.resize(count);
  findings_->verdicts.resize(count);
  std::copy_n(trace.regions.begin(), count, findings_->regions.begin());
  std::copy_n(trace.sightings.verdicts.begin(), count, findings_->verdicts.begin());
  has_findings_ = true;
}

void PictureExchange::put(const Frame& frame, std::uint64_t number) noexcept {
  number_ = number;
  frame_ = frame;
  const PictureLayout layout = picture_layout(frame.format, frame.width_px, frame.height_px);
  if (frame.sightings != nullptr || layout.bytes > memory_.size()) {
    frame_.width_px = frame_.height_px = 0;
    state_.store(State::kArrived, std::memory_order_release);
    return;
  }
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    std::uint8_t* to = memory_.data() + layout.offset_bytes[plane];
    frame_.plane[plane] = to;
    frame_.stride_bytes[plane] = layout.stride_bytes[plane];
    const std::size_t bytes = row_bytes(frame.format, plane, frame.width_px);
    const std::uint8_t* from = frame.plane[plane];
    for (std::size_t row = plane_rows(frame.format, plane, frame.height_px); row > 0; --row) {
      std::memcpy(to, from, bytes);
      from += frame.stride_bytes[plane];
      to += bytes;
    }
  }
  state_.store(State::kArrived, std::memory_order_release);
}

}  // namespace touchline
