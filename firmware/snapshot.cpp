#include "firmware/snapshot.h"

namespace touchline {

void copy_trace(const StepTrace& trace, Snapshot& out) {
  out.frame_sequence = trace.frame.sequence;
  out.width_px = trace.frame.width_px;
  out.height_px = trace.frame.height_px;
  out.captured = trace.frame.capture_time;
  out.stage_time = trace.stage_time;
  out.ball = trace.sightings.ball;
  out.robots = trace.sightings.robots;
  out.tracks = trace.tracks;
  out.commands = trace.commands;
  out.play = trace.play;
  out.light = trace.light;
  out.picture = trace.picture;
  out.reports = trace.reports;
  out.status = trace.status;
  out.overload = trace.overload;
}

void copy_bytes(const StepTrace& trace, const PacketLayout& layout, RobotId tested, Snapshot& out) {
  out.packet_bytes = 0;
  out.sent_bytes.clear();
  out.received_bytes.clear();
  for (const OutgoingPacket& outgoing : trace.packets) {
    out.packet_bytes += static_cast<std::uint32_t>(outgoing.packet.size());
    const bool is_for_all = outgoing.receiver == kAllRobots;
    if (tested == kUnknownId || (!is_for_all && layout.receivers[outgoing.receiver].id != tested)) continue;
    out.sent_bytes.clear();
    for (const std::byte byte : outgoing.packet) out.sent_bytes.push_back(byte);
  }
  if (tested != kUnknownId && trace.inputs != nullptr) out.received_bytes = trace.inputs->events.telemetry;
}

}  // namespace touchline
