#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "core/pipeline.h"
#include "core/step_inputs.h"
#include "core/types.h"
#include "firmware/recording/byte_ring.h"
#include "firmware/recording/pipeline_state.h"
#include "firmware/snapshot.h"
#include "hal/camera.h"

namespace touchline::recording {

enum class StepKind : std::uint8_t { kFrame, kStop };
/// kNone: the source sends poses, the picture is one of those that are left out, or there was no memory for it.
enum class PictureKind : std::uint8_t { kNone, kJpeg, kRaw };

/// What the loop notes of a step beside its larger parts.
struct StepHeader {
  std::uint64_t number = 0;   // of all steps and stops of the session, from 0 on; gaps are steps that were lost
  std::uint32_t session = 0;  // from 1 on
  std::uint32_t reload = 0;   // number of the last reload, from 1 on, whose settings apply in this step; 0: none
  StepKind kind = StepKind::kFrame;
  // The rest is that of a frame.
  PictureKind picture = PictureKind::kNone;
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::uint32_t sequence = 0;  // from the driver
  Instant captured{};
  bool revoked = false;            // StepTrace::revoked
  bool is_unusable = false;        // PictureTrace::is_unusable()
  bool was_cut_short = false;      // Sightings::cut_short
  std::uint64_t frame_number = 0;  // Snapshot::number
};

/// A step on its way from the loop to the recorder: these parts follow each other in the ring, then the snapshot, the
/// state after the step, and the bytes of the picture. A stop has no snapshot.
struct StepParts {
  StepHeader header;
  StepInputs inputs;
  DriveCorrections drives;  // in force
  OutgoingPackets packets;
  std::uint32_t state_bytes = 0;  // of write_state()
  std::uint32_t recording = 0;    // for which it was taken, see StepTap::begin()
};
static_assert(std::is_trivially_copyable_v<StepParts> && std::is_trivially_copyable_v<Snapshot>);

/// The loop's side of a recording: copies each step with all of its inputs into the ring, after its packet was sent.
/// Never blocks or allocates, unless the recorder may hold up simulated time, for two seconds at most. If memory runs
/// short, pictures are left out first, so that inputs and results, which are a hundredth of them, are still recorded. A
/// copy of a picture of 640 x 480 pixels of 3 bytes takes 0.1 ms, one of a JPEG 3 us.
///
/// The first step of a recording that begins within a session, the first one after steps that were lost, and every
/// kStatePeriod-th one are recorded with the pipeline's state after them, from which a replay can continue.
class StepTap {
 public:
  // 5 s at 60 Hz: a part that is cut out of a recording is soon compared. A state has 14 KB, an eighth of what the
  // steps have in a second.
  static constexpr std::uint64_t kStatePeriod = 300;

  /// Every `every`-th picture is recorded; 0: none. `ring` must outlive the tap.
  StepTap(ByteRing& ring, std::uint32_t every) : ring_(ring), every_(every) {}

  /// Called while no loop runs. `waits`: in simulated time, which waits for the recorder.
  void begin_session(bool waits);
  /// Number of the session, from 1 on.
  [[nodiscard]] std::uint32_t session() const { return session_; }
  /// The recorder takes steps for the recording with this number, from 1 on. Any thread may call it.
  void begin(std::uint32_t recording) { recording_.store(recording, std::memory_order_release); }
  /// The recorder no longer takes anything. Any thread may call it. A step on its way may still follow.
  void end() { begin(0); }

  // The loop calls these.
  void add(const Pipeline& pipeline, const StepTrace& trace, const Snapshot& snapshot, const hal::FrameLease& lease);
  void add_stop(const Pipeline& pipeline, const StepInputs& inputs, const OutgoingPackets& packets);

  // Any thread may call these.
  /// Returns the half of the game that the referee announces, from 1 on; 0: none. Also if nothing is recorded.
  [[nodiscard]] std::uint8_t half() const { return half_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t lost_steps() const { return lost_steps_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t lost_pictures() const { return lost_pictures_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] bool has_ended() const { return recording_.load(std::memory_order_acquire) == 0; }
  [[nodiscard]] StepHeader next_header(const StepInputs& inputs, StepKind kind);
  /// In simulated time, waits until so many bytes are free, but not for a recorder that makes no room any more.
  void wait_for(std::size_t bytes);
  /// Notes the pipeline's state if the recording lacks it.
  void note_state(const Pipeline& pipeline);
  /// Puts parts_ and the given parts into the ring.
  void put(const Snapshot* snapshot, const Frame* frame, std::span<const std::uint8_t> jpeg);

  ByteRing& ring_;
  const std::uint32_t every_;
  bool waits_ = false;
  std::uint32_t session_ = 0, reloads_ = 0;
  std::uint64_t next_ = 0;
  // Free bytes after a wait in vain: until there are more, nothing waits, as in real time.
  std::optional<std::size_t> stalled_free_;
  StepParts parts_;  // too large for the stack
  StateBytes state_;
  std::uint32_t complete_ = 0;  // recording that has all steps since a known state; 0: none
  std::atomic<std::uint32_t> recording_{1};
  std::atomic<std::uint8_t> half_{0};
  std::atomic<std::uint64_t> lost_steps_{0}, lost_pictures_{0};
};

}  // namespace touchline::recording
