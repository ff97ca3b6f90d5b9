#include "hal/mock/simulated_side.h"

#include <utility>

namespace touchline::hal::mock {
namespace {

constexpr std::array<std::uint64_t, 2> kArrivalStream{11, 12};  // by Side
// A bit of StepInputs::halt that no reason of the firmware uses.
constexpr std::uint32_t kHaltByRules = 1U << 31U;

}  // namespace

PipelineParameters for_opponent(PipelineParameters parameters) {
  std::swap(parameters.marker.teams[0], parameters.marker.teams[1]);
  return parameters;
}

SimulatedSide::SimulatedSide(const ArenaParameters& parameters, Side side, std::uint64_t seed)
    : view_(parameters.view),
      observer_(parameters, side, seed),
      random_(seed, kArrivalStream[static_cast<std::size_t>(side)]),
      pipeline_(std::make_unique<Pipeline>()) {}

Status SimulatedSide::configure(const SideSettings& settings) {
  settings_ = settings;
  pipeline_->set_strategy(settings.strategy);
  return pipeline_->configure(settings.pipeline);
}

void SimulatedSide::hold(bool stands, bool restarts) {
  inputs_.halt = stands ? inputs_.halt | kHaltByRules : inputs_.halt & ~kHaltByRules;
  // Frames on their way still show the places before.
  if (restarts) reset_at_frame_ = next_frame_;
}

void SimulatedSide::advance(Instant now, const World& world, RadioChannel& channel) {
  if (!begun_) {
    begun_ = true;
    begin_ = now;
  }
  if (now >= begin_ + from_seconds(static_cast<double>(next_frame_) / settings_.rate_hz)) capture(now, world);
  while (waiting_ > 0 && pending_[first_].arrives <= now) {
    process(pending_[first_], now, channel);
    first_ = (first_ + 1) % pending_.size();
    --waiting_;
  }
}

void SimulatedSide::capture(Instant now, const World& world) {
  const std::uint64_t number = next_frame_++;
  const bool is_late = random_.bernoulli(view_.late);
  if (camera_stalled_) return;
  if (waiting_ == pending_.size()) return;  // as a camera without a free buffer
  PendingFrame& frame = pending_[(first_ + waiting_) % pending_.size()];
  ++waiting_;
  observer_.observe(world, frame.sightings, hidden_robots_);
  frame.captured = now;
  frame.arrives = now + settings_.frame_latency + (is_late ? from_seconds(view_.late_s) : Duration::zero());
  frame.number = number;
}

void SimulatedSide::process(const PendingFrame& pending, Instant now, RadioChannel& channel) {
  Frame frame;
  frame.capture_time = pending.captured;
  frame.sequence = static_cast<std::uint32_t>(pending.number);
  frame.sightings = &pending.sightings;
  if (reset_at_frame_ && pending.number >= *reset_at_frame_) {
    inputs_.events.reset = true;
    reset_at_frame_.reset();
  }
  inputs_.now = now;
  inputs_.radio_delay = settings_.radio_delay;
  inputs_.action_delay = settings_.frame_latency + packet_time_ + settings_.radio_delay;
  const StepTrace& trace = pipeline_->step(frame, inputs_);
  inputs_.events = {};
  packet_time_ = settings_.line.until_sent(trace.packets, 0);
  for (std::size_t i = 0; i < trace.packets.size(); ++i) {
    const OutgoingPacket& outgoing = trace.packets[i];
    if (outgoing.receiver < inputs_.lateness.size()) {
      inputs_.lateness[outgoing.receiver] = settings_.line.until_sent(trace.packets, i) - packet_time_;
    }
    if (radio_lost_) continue;
    // A full queue rejects the packet, and the channel counts it.
    static_cast<void>(channel.send({outgoing.packet.data(), outgoing.packet.size()}, now, outgoing.receiver));
  }
  pipeline_->adapt();
  ++frames_;
  if (on_step_ != nullptr) on_step_(context_, trace);
}

}  // namespace touchline::hal::mock
