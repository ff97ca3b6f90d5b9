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
  out.light = trace.light;
  out.picture = trace.picture;
  out.reports = trace.reports;
  out.status = trace.status;
  out.overload = trace.overload;
}

}  // namespace touchline
