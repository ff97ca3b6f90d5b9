#include "firmware/recording/recording_view.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "firmware/recording/picture_message.h"
#include "firmware/recording/recording_writer.h"

namespace touchline::recording {
namespace {

using Json = nlohmann::json;

// Raw pictures fill a chunk of 1 MB each: four hours at 60 Hz, with 150 bytes of memory for a chunk.
constexpr std::size_t kMaxChunks = std::size_t{1} << 20;
// Frames of eight hours at 60 Hz, with 24 bytes of memory each; events beyond the limit do not help a viewer.
constexpr std::size_t kMaxFrames = std::size_t{1} << 21, kMaxEvents = 10000, kMaxScenes = 64;
// Size at which an answer ends: a second of JPEG files of the usual camera has 1.2 MB.
constexpr std::size_t kMaxAnswerBytes = std::size_t{4} << 20;
constexpr std::uint64_t kMaxCount = 120;
// As the live picture at its best.
constexpr int kQuality = 80;
// Unit of the times of frames: 32 bits then reach for 119 hours.
constexpr std::uint64_t kTimeUnitNs = 100'000;

template <class Integer>
void put(std::string& out, Integer value) {
  hal::mcap::RecordWriter(out).number(value);
}

Json parse(const std::string& text) { return Json::parse(text, nullptr, false); }

}  // namespace

Result<void> RecordingView::open(const std::string& path) {
  path_ = path;
  TOUCHLINE_TRY(index_.open(path, kMaxChunks));
  state_ = index_.channel_of(kStateTopic);
  jpeg_ = index_.channel_of(kJpegTopic);
  raw_ = index_.channel_of(kRawTopic);
  const std::uint16_t hello = index_.channel_of(kHelloTopic), events = index_.channel_of(kEventTopic);
  for (std::uint32_t i = 0; i < index_.chunks().size(); ++i) {
    Result<void> added = add_frames(i);
    if (added.ok() && scenes_.size() < kMaxScenes) added = add_parts(i, hello, scenes_);
    if (added.ok() && events_.size() < kMaxEvents) added = add_parts(i, events, events_);
    if (added.code() == ErrorCode::kCorruptFrame) {
      ++damaged_;
    } else if (!added.ok()) {
      return added;
    }
  }
  facts_.bytes = index_.size();
  facts_.is_complete = index_.is_complete();
  facts_.frames = frames_.size();
  if (!frames_.empty()) {
    facts_.begin_ns = frames_.front().time_ns;
    facts_.end_ns = frames_.back().time_ns;
  }
  for (const Part& part : events_) {
    const Json event = parse(part.json);
    if (!event.is_object()) continue;
    const std::string kind = event.value("kind", "");
    facts_.goals += kind == "goal" ? 1U : 0U;
    facts_.stops += kind == "stop" ? 1U : 0U;
    facts_.lost += kind == "robot_lost" ? 1U : 0U;
    if (kind == "goal" || kind == "score") {
      facts_.score =
          Json{{"own", event.value("own", 0)}, {"opponent", event.value("opponent", 0)}, {"by", event.value("by", "")}}
              .dump();
    }
  }
  return {};
}

RecordingFacts RecordingView::facts() const { return facts_; }

Result<void> RecordingView::add_frames(std::uint32_t chunk) {
  struct Picture {
    std::uint64_t offset = 0;
    PictureForm form = PictureForm::kNone;
  };
  const hal::mcap::ChunkPlace& place = index_.chunks()[chunk];
  std::vector<Picture> pictures;
  for (const auto& [channel, form] : {std::pair(jpeg_, PictureForm::kJpeg), std::pair(raw_, PictureForm::kRaw)}) {
    if (channel == 0) continue;
    TOUCHLINE_TRY_ASSIGN(const std::vector<hal::mcap::MessagePlace> messages, index_.messages(place, channel));
    for (const hal::mcap::MessagePlace& message : messages) pictures.push_back({message.offset, form});
  }
  std::sort(pictures.begin(), pictures.end(), [](const Picture& a, const Picture& b) { return a.offset < b.offset; });
  if (state_ == 0) return {};
  TOUCHLINE_TRY_ASSIGN(const std::vector<hal::mcap::MessagePlace> states, index_.messages(place, state_));
  auto picture = pictures.begin();
  std::uint64_t before = 0;
  for (const hal::mcap::MessagePlace& state : states) {
    if (frames_.size() >= kMaxFrames) {
      return failure(ErrorCode::kFull, "%s: has more than %zu frames; cut it into several files", path_.c_str(),
                     kMaxFrames);
    }
    FramePlace frame;
    frame.time_ns = state.time_ns;
    frame.chunk = chunk;
    // A picture between two states belongs to the second one.
    while (picture != pictures.end() && picture->offset < state.offset) {
      if (picture->offset >= before) {
        frame.picture = static_cast<std::uint32_t>(picture->offset);
        frame.form = picture->form;
      }
      ++picture;
    }
    before = state.offset;
    frame.state = static_cast<std::uint32_t>(state.offset);
    frames_.push_back(frame);
  }
  return {};
}

Result<void> RecordingView::add_parts(std::uint32_t chunk, std::uint16_t channel, std::vector<Part>& out) {
  if (channel == 0) return {};
  const hal::mcap::ChunkPlace& place = index_.chunks()[chunk];
  TOUCHLINE_TRY_ASSIGN(const std::vector<hal::mcap::MessagePlace> messages, index_.messages(place, channel));
  for (const hal::mcap::MessagePlace& message : messages) {
    TOUCHLINE_TRY_ASSIGN(std::string json, index_.read(place, message, channel));
    out.push_back({message.time_ns, chunk, static_cast<std::uint32_t>(message.offset), std::move(json)});
  }
  return {};
}

// Times do not tell the order: a stop may have the time of the frame before it.
std::size_t RecordingView::frame_after(const Part& part) const {
  const auto found = std::lower_bound(frames_.begin(), frames_.end(), part, [](const FramePlace& a, const Part& b) {
    return std::pair(a.chunk, a.state) < std::pair(b.chunk, b.offset);
  });
  const auto number = static_cast<std::size_t>(found - frames_.begin());
  return frames_.empty() ? 0 : std::min(number, frames_.size() - 1);
}

std::string RecordingView::description(const std::string& name) const {
  Json out{{"name", name},
           {"bytes", facts_.bytes},
           {"complete", facts_.is_complete},
           {"damaged", damaged_},
           {"frames", frames_.size()},
           {"begin_s", static_cast<double>(facts_.begin_ns) * 1e-9},
           {"duration_s", static_cast<double>(facts_.end_ns - facts_.begin_ns) * 1e-9},
           {"scenes", Json::array()},
           {"events", Json::array()}};
  for (const Part& part : scenes_) {
    Json hello = parse(part.json);
    if (hello.is_object()) out["scenes"].push_back({{"frame", frame_after(part)}, {"hello", std::move(hello)}});
  }
  for (const Part& part : events_) {
    Json event = parse(part.json);
    if (!event.is_object()) continue;
    event["frame"] = frame_after(part);
    event["at_s"] = static_cast<double>(part.time_ns - std::min(part.time_ns, facts_.begin_ns)) * 1e-9;
    out["events"].push_back(std::move(event));
  }
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<void> RecordingView::load(std::uint32_t chunk) {
  if (loaded_ == chunk) return {};
  loaded_ = ~std::uint32_t{0};
  TOUCHLINE_TRY_ASSIGN(records_, index_.load(index_.chunks()[chunk]));
  loaded_ = chunk;
  return {};
}

// Returns the JPEG of the frame; empty: none was recorded.
Result<std::string> RecordingView::picture_of(const FramePlace& frame) {
  if (frame.form == PictureForm::kNone) return std::string();
  const bool is_jpeg = frame.form == PictureForm::kJpeg;
  TOUCHLINE_TRY_ASSIGN(const std::span<const std::byte> message,
                       index_.find(records_, {frame.time_ns, frame.picture}, is_jpeg ? jpeg_ : raw_));
  const Error damaged = failure(ErrorCode::kCorruptFrame, "%s: its picture is damaged", path_.c_str());
  if (is_jpeg) {
    const auto bytes = recording::picture_of(PictureKind::kJpeg, message);
    if (!bytes) return damaged;
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  }
  const std::optional<RawPicture> raw = raw_picture_of(message);
  if (!raw) return damaged;
  // Even noise has fewer bytes than pixels at this quality, see PictureSource.
  jpeg_bytes_.resize(std::size_t{raw->width_px} * raw->height_px + 4096);
  TOUCHLINE_TRY_ASSIGN(const std::size_t size, encoder_.encode(frame_of(*raw), 1, kQuality, jpeg_bytes_));
  return std::string(reinterpret_cast<const char*>(jpeg_bytes_.data()), size);
}

Result<std::string> RecordingView::frames(const console::FrameRange& range) {
  if (range.from >= frames_.size()) {
    return failure(ErrorCode::kOutOfRange, "%s: has %zu frames", path_.c_str(), frames_.size());
  }
  std::string out;
  const std::uint64_t step = std::clamp<std::uint64_t>(range.step, 1, kMaxFrames);
  const std::uint64_t count = std::clamp<std::uint64_t>(range.count, 1, kMaxCount);
  for (std::uint64_t i = 0; i < count && out.size() < kMaxAnswerBytes; ++i) {
    const std::uint64_t number = range.from + i * step;
    if (number >= frames_.size()) break;
    const FramePlace& frame = frames_[static_cast<std::size_t>(number)];
    std::string state, picture;
    // A damaged frame must not hide those after it.
    const Result<void> loaded = load(frame.chunk);
    if (loaded.ok()) {
      const auto message = index_.find(records_, {frame.time_ns, frame.state}, state_);
      if (message.ok()) state.assign(reinterpret_cast<const char*>(message.value().data()), message.value().size());
      Result<std::string> jpeg = picture_of(frame);
      if (jpeg.ok()) picture = std::move(jpeg).value();
    } else if (loaded.code() != ErrorCode::kCorruptFrame) {
      return loaded.error();
    }
    put(out, static_cast<std::uint32_t>(number));
    put(out, static_cast<std::uint32_t>((frame.time_ns - facts_.begin_ns) / kTimeUnitNs));
    put(out, static_cast<std::uint32_t>(state.size()));
    put(out, static_cast<std::uint32_t>(picture.size()));
    out += state;
    out += picture;
  }
  return out;
}

}  // namespace touchline::recording
