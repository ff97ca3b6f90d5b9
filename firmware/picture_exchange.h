#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/region/pixel_classifier.h"
#include "core/types.h"

namespace touchline {

class Pipeline;

/// Findings of the pipeline in a picture, for other threads than the loop's. Takes 1 MB, so do not put it on the stack.
struct PictureFindings {
  Regions regions;
  FixedVector<Verdict, kMaxRegions> verdicts;  // one verdict per region
  PixelClassifier classifier;
};

/// Passes single pictures from the loop to one thread that asks for them. The loop copies a picture only if one was
/// asked for; it never waits, locks or allocates. There is memory for one picture. The asking thread owns it from the
/// arrival of a picture until it asks for the next one.
class PictureExchange {
 public:
  /// Allocates the memory. The asking thread calls it before the first request(). `bytes` is the size of the largest
  /// picture without padding of rows.
  void allocate(std::size_t bytes) { memory_.assign(bytes, 0); }
  /// Does the same as allocate() while no loop runs; an open request is forgotten.
  void reallocate(std::size_t bytes) {
    state_.store(State::kIdle, std::memory_order_release);
    if (bytes > memory_.size()) allocate(bytes);
  }
  /// The asking thread requests the next picture, and gives the last one back. `with_findings` requests its regions and
  /// classes as well.
  void request(bool with_findings = false) noexcept {
    wants_findings_ = with_findings;
    has_findings_ = false;
    state_.store(State::kWanted, std::memory_order_release);
  }
  /// Tells the asking thread whether a picture has arrived since request().
  [[nodiscard]] bool has_arrived() const noexcept { return state_.load(std::memory_order_acquire) == State::kArrived; }
  /// Returns the picture. Valid after has_arrived() until request(). A width of 0 means that there is no picture (the
  /// source sends poses), or that it was larger than the memory.
  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  /// Returns the findings, valid as long as frame(); null if they were not requested or the pipeline rejected the
  /// frame.
  [[nodiscard]] const PictureFindings* findings() const noexcept { return has_findings_ ? findings_.get() : nullptr; }
  /// Returns Snapshot::number of the frame.
  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }

  /// Tells the loop whether a picture is requested.
  [[nodiscard]] bool is_wanted() const noexcept { return state_.load(std::memory_order_acquire) == State::kWanted; }
  /// Copies the findings of the last step (about 0.5 MB) if they were requested. The loop calls it if is_wanted(),
  /// before Pipeline::adapt() and put().
  void put_findings(const Pipeline& pipeline, const StepTrace& trace) noexcept;
  /// Copies the picture. The loop calls it if is_wanted(). 640 x 480 pixels of 3 bytes take about 0.1 ms.
  void put(const Frame& frame, std::uint64_t number) noexcept;

 private:
  enum class State : std::uint8_t { kIdle, kWanted, kArrived };
  static_assert(std::atomic<State>::is_always_lock_free);

  std::vector<std::uint8_t> memory_;
  std::unique_ptr<PictureFindings> findings_ = std::make_unique<PictureFindings>();
  Frame frame_;
  std::uint64_t number_ = 0;
  bool wants_findings_ = false, has_findings_ = false;  // passed to the other thread together with state_
  std::atomic<State> state_{State::kIdle};
};

}  // namespace touchline
