#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/recording/recorder.h"
#include "firmware/recording/recording_writer.h"

// Declarations that recorder.cpp and recorder_thread.cpp share.
namespace touchline::recording {

inline constexpr std::uint64_t kMegabyte = 1'000'000;

/// What the recorder and its thread share.
struct Recorder::Shared {
  using WallClock = std::chrono::steady_clock;
  // Lines come seldom: so many wait only for a disk that blocks.
  static constexpr std::size_t kMaxWaiting = 1000;

  /// What other threads than the loop's want to have recorded.
  struct Note {
    std::optional<ConfigurationText> configuration{};
    std::shared_ptr<const console::Scene> scene{};  // with the configuration of a session
    std::string level{}, line{};
  };

  Shared(const RecordingPlan& the_plan, std::string the_version)
      : plan(the_plan),
        version(std::move(the_version)),
        ring(static_cast<std::size_t>(plan.settings.memory_mb) * kMegabyte),
        tap(ring, static_cast<std::uint32_t>(plan.settings.every)),
        is_wanted(plan.settings.automatic == config::AutomaticRecording::kOn) {
    tap.end();
  }

  [[nodiscard]] std::optional<std::string> disk_shortage() const;
  // A step without its configuration cannot be replayed, so only lines are dropped. What is put while no file is open
  // belongs to the next one as far as it still holds then.
  void put(Note note) {
    const std::scoped_lock lock(mutex);
    if (note.configuration) keep(note);
    if (!is_done && has_file && (note.configuration || notes.size() < kMaxWaiting)) notes.push_back(std::move(note));
  }
  void keep(const Note& note) {
    if (note.scene) {
      current = note;
      reload = {};
    } else if (current.configuration) {
      ConfigurationText files = *note.configuration;
      files.reload = 0;
      files.camera = current.configuration->camera;
      files.is_calibrated = current.configuration->is_calibrated;
      current.configuration = std::move(files);
      reload = note;
    }
  }
  Result<void> create_file();
  void write_file(const Print& print, bool is_last, bool& was_idle);
  Result<void> save_file(const Print& print);
  void end_file(const Print& print, const std::string& failure, bool is_last);
  void follow_half(const Print& print);
  [[nodiscard]] std::string text_of_file(const std::string& failure) const;
  void update_status(bool is_on, const std::string& ended);
  Result<void> write_waiting(bool& was_idle);
  Result<void> write_notes(bool& was_idle);
  Result<void> write_note(const Note& note);
  // Returns lines that say what was deleted, and what could not be.
  std::vector<std::string> keep_quota_now();
  // Prints, unless nobody waits for the thread any more.
  void say(const Print& print, const std::string& line) {
    const std::scoped_lock lock(mutex);
    if (!is_abandoned) print(line);
  }

  const RecordingPlan plan;
  const std::string version;
  ByteRing ring;
  StepTap tap;
  std::atomic<bool> is_wanted, end{false};
  bool has_started = false;
  std::uint32_t reloads = 0;
  std::thread thread;

  // Of the thread, and of open() before.
  std::string name, path;
  std::unique_ptr<RecordingWriter> writer;          // null: nothing is being recorded
  std::uint32_t number = 0;                         // of the recording
  std::uint64_t lost_steps = 0, lost_pictures = 0;  // of the tap, when it began
  std::uint8_t half = 0;
  std::vector<std::string> to_print;
  bool has_reported_removal = false;  // of the quota, that failed
  WallClock::time_point next_save{};

  mutable std::mutex mutex;
  std::condition_variable has_ended;
  std::deque<Note> notes;
  Note current, reload;  // configuration of the session, with the last reload, which the loop may not have taken yet
  bool has_file = false, is_done = false, is_abandoned = false;
  console::RecordingStatus status;
  std::string wish;  // who has ended the recording
  std::string summary;
};

}  // namespace touchline::recording
