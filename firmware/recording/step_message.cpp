#include "firmware/recording/step_message.h"

#include <algorithm>

#include "firmware/recording/step_fields.h"

namespace touchline::recording {
namespace {

std::string& at(StepResults& results, ResultPart part) { return results[static_cast<std::size_t>(part)]; }

template <class... Values>
void write(std::string& out, const Values&... values) {
  out.clear();
  ArchiveWriter archive(out);
  archive(values...);
}

// Within the range of tracking.robot.wheel_lag_s.
bool is_time_constant(const std::optional<double>& lag_s) { return !lag_s || (*lag_s >= 0.0 && *lag_s <= 1.0); }

Error unreadable() { return failure(ErrorCode::kCorruptFrame, "the message of a step cannot be read"); }

template <class Value>
Result<void> read(const StepResults& results, ResultPart part, Value& out) {
  ArchiveReader archive(std::as_bytes(std::span(results[static_cast<std::size_t>(part)])));
  archive(out);
  if (!archive.ok() || !archive.rest().empty()) return unreadable();
  return {};
}

}  // namespace

template <>
struct LastOf<StepKind> : LastIs<StepKind::kStop> {};
template <>
struct LastOf<PictureKind> : LastIs<PictureKind::kRaw> {};
template <>
struct LastOf<PixelFormat> : LastIs<static_cast<PixelFormat>(kPixelFormatTable.size() - 1)> {};

template <class Archive, Of<StepHeader> Value>
void fields(Archive& archive, Value& value) {
  auto& [number, session, reload, kind, picture, format, width, height, sequence, captured, revoked, is_unusable,
         was_cut_short, frame_number] = value;
  archive(number, session, reload, kind, picture, format, width, height, sequence, captured, revoked, is_unusable,
          was_cut_short, frame_number);
}

void write_results(const Sightings& sightings, const Tracks& tracks, const Commands& commands,
                   const OutgoingPackets& packets, StepResults& out) {
  write(at(out, ResultPart::kSightings), sightings);
  write(at(out, ResultPart::kTracks), tracks);
  write(at(out, ResultPart::kCommands), commands);
  write(at(out, ResultPart::kPackets), packets);
}

void write_results(const OutgoingPackets& packets, StepResults& out) {
  for (std::string& part : out) part.clear();
  write(at(out, ResultPart::kPackets), packets);
}

void add_to(hal::Fnv1a& hash, const StepResults& results) {
  for (const std::string& part : results) hash.add(std::as_bytes(std::span(part)));
}

std::string_view step_schema() {
  return "Inputs and results of a step of Touchline, format 2, for touchline-replay: see "
         "firmware/recording/step_fields.h";
}

void encode(const StepMessage& message, std::string& out) {
  write(out, kStepFormat, message.header, message.inputs, message.drives);
  const auto add = [&out](const std::string& part) {
    ArchiveWriter archive(out);
    archive(static_cast<std::uint32_t>(part.size()));
    out += part;
  };
  for (const std::string& part : message.results) add(part);
  add(message.state);
}

Result<void> decode(std::span<const std::byte> bytes, StepMessage& out) {
  ArchiveReader archive(bytes);
  std::uint8_t format = 0;
  archive(format);
  const bool has_state = format == kStepFormat;
  if (archive.ok() && !has_state && format != kStepFormatWithoutState) {
    return failure(ErrorCode::kUnsupported,
                   "its steps have format %d, this program replays formats %d and %d: use the version that recorded it",
                   int{format}, int{kStepFormatWithoutState}, int{kStepFormat});
  }
  // What a message does not hold, such as the settings of a reload, is not that of the former one.
  out.inputs = {};
  out.drives = {};
  out.state.clear();
  archive(out.header, out.inputs);
  if (has_state) {
    ArchiveReader sound(archive.rest(), Numbers::kSound);
    sound(out.drives);
    if (!archive.ok() || !sound.ok() || !is_time_constant(out.drives.lag_s)) return unreadable();
    archive = ArchiveReader(sound.rest());
  }
  const auto take = [&archive](std::string& part) {
    std::uint32_t size = 0;
    archive(size);
    const std::span<const std::byte> rest = archive.rest();
    if (!archive.ok() || size > rest.size()) return archive.refuse();
    part.assign(reinterpret_cast<const char*>(rest.data()), size);
    archive = ArchiveReader(rest.subspan(size));
  };
  for (std::string& part : out.results) take(part);
  if (has_state) take(out.state);
  if (!archive.ok() || !archive.rest().empty()) return unreadable();
  return {};
}

Result<void> decode_sightings(const StepResults& results, Sightings& out) {
  out.verdicts.clear();
  return read(results, ResultPart::kSightings, out);
}

Result<void> decode_results(const StepResults& results, Sightings& sightings, Tracks& tracks, Commands& commands) {
  TOUCHLINE_TRY(decode_sightings(results, sightings));
  TOUCHLINE_TRY(read(results, ResultPart::kTracks, tracks));
  return read(results, ResultPart::kCommands, commands);
}

}  // namespace touchline::recording
