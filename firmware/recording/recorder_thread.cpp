// The recorder's thread: begins, writes and ends files.
#include <pthread.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>

#include "firmware/recording/recorder_parts.h"
#include "firmware/recording/recording_files.h"

namespace touchline::recording {
namespace {

using namespace std::chrono_literals;

// A power cut costs at most this much, and the page cache never holds more than a disk writes in a moment.
constexpr auto kSavePeriod = 1s;
// Pause when nothing is waiting: a tenth of a frame at 60 Hz.
constexpr auto kIdlePause = 2ms;
// Several programs may begin a recording in the same folder at the same time.
constexpr int kNameAttempts = 10;

std::optional<std::uint64_t> free_bytes(const std::string& folder) {
  struct statvfs status {};
  if (::statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return std::uint64_t{status.f_bavail} * status.f_frsize;
}

std::uint32_t recording_of(std::span<const std::byte> record) {
  std::uint32_t recording = 0;
  std::memcpy(&recording, record.data() + offsetof(StepParts, recording), sizeof(recording));
  return recording;
}

}  // namespace

std::optional<std::string> Recorder::Shared::disk_shortage() const {
  const std::uint64_t reserve = static_cast<std::uint64_t>(plan.settings.reserve_mb) * kMegabyte;
  const std::optional<std::uint64_t> free = free_bytes(plan.folder);
  if (!free || *free >= reserve) return std::nullopt;
  return plan.folder + ": the disk has " + std::to_string(*free / kMegabyte) +
         " MB left, less than recording.reserve_mb = " + std::to_string(plan.settings.reserve_mb);
}
Result<void> Recorder::Shared::create_file() {
  name.clear();
  to_print = keep_quota_now();
  if (const auto shortage = disk_shortage()) {
    return touchline::failure(ErrorCode::kFull, "%s; nothing can be recorded", shortage->c_str());
  }
  auto next = std::make_unique<RecordingWriter>();
  Result<void> created;
  for (int i = 0; i < kNameAttempts; ++i) {
    name = next_name(recordings_in(plan.folder));
    path = (std::filesystem::path(plan.folder) / name).string();
    created = next->create(path, version);
    if (created.code() != ErrorCode::kInconsistent) break;
  }
  if (!created.ok()) return created;
  writer = std::move(next);
  lost_steps = tap.lost_steps();
  lost_pictures = tap.lost_pictures();
  update_status(true, {});
  Note session, last_reload;
  {
    const std::scoped_lock lock(mutex);
    has_file = true;
    notes.clear();
    session = current;
    last_reload = reload;
    summary.clear();
  }
  if (session.configuration) TOUCHLINE_TRY(write_note(session));
  if (last_reload.configuration) TOUCHLINE_TRY(write_note(last_reload));
  tap.begin(++number);
  return {};
}

Result<void> Recorder::Shared::write_note(const Note& note) {
  if (!note.configuration) return writer->add_line(note.level, note.line);
  if (note.scene) writer->begin_session(note.scene);
  return writer->add(*note.configuration);
}

Result<void> Recorder::Shared::write_waiting(bool& was_idle) {
  was_idle = true;
  // The disk's state is looked at again after so many steps.
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const std::span<const std::byte> record = ring.front();
    // The configuration that a step needs was put before the step, and precedes it in the file.
    TOUCHLINE_TRY(write_notes(was_idle));
    if (record.empty()) break;
    was_idle = false;
    // A step that was on its way when the former recording ended.
    const bool is_of_file = recording_of(record) == number;
    Result<void> added = is_of_file ? writer->add_step(record) : Result<void>();
    ring.pop();
    if (!added.ok()) return added;
  }
  return {};
}

Result<void> Recorder::Shared::write_notes(bool& was_idle) {
  std::deque<Note> waiting;
  {
    const std::scoped_lock lock(mutex);
    waiting.swap(notes);
  }
  for (const Note& note : waiting) {
    was_idle = false;
    TOUCHLINE_TRY(write_note(note));
  }
  return {};
}

std::vector<std::string> Recorder::Shared::keep_quota_now() {
  const std::uint64_t quota = static_cast<std::uint64_t>(plan.settings.quota_mb) * kMegabyte;
  if (quota == 0) return {};
  const std::string key = "recording.quota_mb = " + std::to_string(plan.settings.quota_mb);
  const QuotaRemovals removals = keep_quota(plan.folder, name, quota);
  std::vector<std::string> lines;
  for (const std::string& deleted : removals.deleted) {
    lines.push_back("recording: " + deleted);
    lines.back() += " was deleted to keep " + key;
  }
  if (!removals.failure.empty() && !has_reported_removal) {
    has_reported_removal = true;
    lines.push_back("recording: " + key + " cannot be kept: " + removals.failure);
  }
  return lines;
}

Result<void> Recorder::Shared::save_file(const Print& print) {
  if (WallClock::now() < next_save) return {};
  next_save = WallClock::now() + kSavePeriod;
  Result<void> result = writer->save();
  for (const std::string& line : keep_quota_now()) say(print, line);
  const std::optional<std::string> shortage = disk_shortage();
  if (result.ok() && shortage) return touchline::failure(ErrorCode::kFull, "%s", shortage->c_str());
  update_status(true, {});
  return result;
}

// One file for each half. Between the halves, and before and after the game, nothing is recorded.
void Recorder::Shared::follow_half(const Print& print) {
  const std::uint8_t now = tap.half();
  if (plan.settings.automatic != config::AutomaticRecording::kHalves || now == half) return;
  if (writer) {
    {
      const std::scoped_lock lock(mutex);
      wish = "the referee has announced another half";
    }
    end_file(print, {}, false);
  }
  half = now;
  is_wanted = half > 0;
}

// Begins, writes or ends the file.
void Recorder::Shared::write_file(const Print& print, bool is_last, bool& was_idle) {
  follow_half(print);
  Result<void> result;
  if (is_wanted && !writer && !is_last) {
    result = create_file();
    if (result.ok()) say(print, "recording " + path);
  } else if (!is_wanted && writer) {
    end_file(print, {}, false);
  }
  for (const std::string& line : std::exchange(to_print, {})) say(print, line);
  if (result.ok() && writer) result = write_waiting(was_idle);
  if (result.ok() && writer) result = save_file(print);
  if (!result.ok()) {
    is_wanted = false;
    end_file(print, result.text(), is_last);
  }
  // Nobody wants these any more.
  while (!writer && !ring.front().empty()) ring.pop();
}

void Recorder::Shared::end_file(const Print& print, const std::string& failure, bool is_last) {
  tap.end();
  std::string why = failure;
  bool was_idle = !why.empty();
  while (!was_idle && why.empty()) why = write_waiting(was_idle).text();
  {
    const std::scoped_lock lock(mutex);
    has_file = false;
    notes.clear();
  }
  if (writer) {
    const Result<void> closed = writer->close();
    if (why.empty()) why = closed.text();
  }
  std::string text = writer ? text_of_file(why) : std::string();
  std::string ended = why;
  {
    const std::scoped_lock lock(mutex);
    if (ended.empty()) ended = std::exchange(wish, {});
  }
  if (ended.empty()) ended = "the program has ended";
  update_status(false, ended);
  writer.reset();
  if (!why.empty()) say(print, "recording: ends: " + why);
  // The run ends with the lines of its last recording, and with why that one ended early.
  if (why.empty() && !is_last) {
    text.pop_back();
    say(print, text);
    text.clear();
  }
  const std::scoped_lock lock(mutex);
  summary = std::move(text);
}

void Recorder::Shared::update_status(bool is_on, const std::string& ended) {
  const std::scoped_lock lock(mutex);
  status.is_on = is_on;
  status.ended = ended;
  status.file = name;
  if (!writer) return;
  const RecordingCounts& counts = writer->counts();
  status.duration_s = static_cast<double>(counts.duration_ns) * 1e-9;
  status.frames = counts.steps;
  status.pictures = counts.pictures;
  status.bytes = counts.bytes;
  status.lost_frames = tap.lost_steps() - lost_steps;
  status.lost_pictures = tap.lost_pictures() - lost_pictures;
}

void Recorder::work(const std::shared_ptr<Shared>& shared, const Print& print) {
  // A limit of the file's size ends the recording, not the program.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGXFSZ);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::string failure;
  try {
    for (;;) {
      const bool is_last = shared->end.load(std::memory_order_acquire);
      bool was_idle = true;
      shared->write_file(print, is_last, was_idle);
      if (was_idle && is_last) break;
      if (was_idle) std::this_thread::sleep_for(kIdlePause);
    }
    if (shared->writer) shared->end_file(print, {}, true);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  shared->tap.end();
  if (!failure.empty()) {
    shared->say(print, "recording: ends: " + failure);
    shared->update_status(false, failure);
  }
  const std::scoped_lock lock(shared->mutex);
  if (!failure.empty()) shared->summary = "recording " + shared->path + " ended early: " + failure + "\n";
  shared->is_done = true;
  shared->notes.clear();
  shared->has_ended.notify_all();
}

std::string Recorder::Shared::text_of_file(const std::string& failure) const {
  const RecordingCounts& counts = writer->counts();
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), ": %" PRIu64 " steps, %" PRIu64 " pictures, %.1f MB", counts.steps,
                counts.pictures, static_cast<double>(counts.bytes) / kMegabyte);
  std::string line = "recording " + path + text.data();
  const std::uint64_t steps = tap.lost_steps() - lost_steps, pictures = tap.lost_pictures() - lost_pictures;
  if (pictures > 0) line += ", " + std::to_string(pictures) + " pictures lost";
  if (steps > 0) line += ", " + std::to_string(steps) + " steps lost";
  if (!failure.empty()) line += "; it ended early: " + failure;
  return line + "\n" + writer->hash().line();
}

}  // namespace touchline::recording
