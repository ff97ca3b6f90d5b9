#include "firmware/network/publisher.h"

#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

// What the sockets got and the publisher printed; from any thread.
class Record {
 public:
  void add(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    texts_.push_back(text);
  }
  [[nodiscard]] std::vector<std::string> texts() const {
    const std::scoped_lock lock(mutex_);
    return texts_;
  }
  [[nodiscard]] std::size_t count(const std::string& text) const {
    const std::vector<std::string> all = texts();
    return static_cast<std::size_t>(std::count(all.begin(), all.end(), text));
  }
  void wait_for(const std::string& text) const {
    for (int i = 0; i < 5000 && count(text) == 0; ++i) std::this_thread::sleep_for(1ms);
    EXPECT_GT(count(text), 0U) << text;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> texts_;
};

std::size_t write(const std::string& text, std::span<std::byte> out) {
  std::copy_n(reinterpret_cast<const std::byte*>(text.data()), text.size(), out.data());
  return text.size();
}

class NumberEncoder final : public Encoder {
 public:
  explicit NumberEncoder(const std::atomic<int>* geometry = nullptr) : geometry_(geometry) {}
  std::size_t encode_frame(const OutputFrame& frame, std::span<std::byte> out) override {
    if (frame.snapshot.number == 666) throw std::runtime_error("no memory");
    return write("frame " + std::to_string(frame.snapshot.number), out);
  }
  std::size_t encode_geometry(std::span<std::byte> out) override {
    return geometry_ == nullptr ? 0 : write("geometry " + std::to_string(geometry_->load()), out);
  }

 private:
  const std::atomic<int>* geometry_;
};

struct Network {
  Record sent;
  std::atomic<bool> up{true};
  std::atomic<int> opened{0};
};

class FakeOutput final : public hal::NetworkOutput {
 public:
  explicit FakeOutput(Network& network) : network_(network) {}
  Result<void> open() override {
    ++network_.opened;
    return {};
  }
  Result<void> send(std::span<const std::byte> message) override {
    if (!network_.up) return failure(ErrorCode::kDisconnected, "the network is down");
    network_.sent.add({reinterpret_cast<const char*>(message.data()), message.size()});
    return {};
  }
  void close() override {}
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }

 private:
  Network& network_;
};

class ThreadsPublisher : public ::testing::Test {
 protected:
  void add_output(Network& network, double rate_hz = 0.0, const std::atomic<int>* geometry = nullptr) {
    outputs_.push_back(std::make_unique<PublisherOutput>("fake", std::make_unique<NumberEncoder>(geometry),
                                                         std::make_unique<FakeOutput>(network), rate_hz));
  }
  void start() {
    publisher_ = std::make_unique<Publisher>(*ring_, std::move(outputs_), PublishedScene{},
                                             [this](const std::string& line) { printed_.add(line); });
  }
  void write_frame(std::uint64_t number, Duration after_start = {}) {
    Snapshot snapshot;
    snapshot.number = number;
    snapshot.machine_sent = begin_ + after_start;
    ring_->write(snapshot);
  }

  const std::unique_ptr<SnapshotRing> ring_ = std::make_unique<SnapshotRing>();
  const Instant begin_ = hal::MonotonicClock::read();
  Network network_, other_;
  Record printed_;
  PublisherOutputs outputs_;
  std::unique_ptr<Publisher> publisher_;
};

TEST_F(ThreadsPublisher, SendsEveryFrameToAllOutputs) {
  add_output(network_);
  add_output(other_);
  start();
  std::vector<std::string> expected;
  for (std::uint64_t i = 0; i < 20; ++i) {
    write_frame(i);
    expected.push_back("frame " + std::to_string(i));
  }
  publisher_->end();
  EXPECT_EQ(network_.sent.texts(), expected);
  EXPECT_EQ(other_.sent.texts(), expected);
  EXPECT_EQ(publisher_->outputs()[0]->sent(), 20U);
  EXPECT_EQ(publisher_->lost(), 0U);
  EXPECT_TRUE(printed_.texts().empty());
}

TEST_F(ThreadsPublisher, LimitsTheRate) {
  add_output(network_, 20.0);
  start();
  // 60 frames a second for a second, with a jitter of 2 ms.
  for (std::uint64_t i = 0; i < 60; ++i) write_frame(i, 16667us * i + (i % 3) * 1ms);
  publisher_->end();
  EXPECT_GE(network_.sent.texts().size(), 19U);
  EXPECT_LE(network_.sent.texts().size(), 21U);
}

TEST_F(ThreadsPublisher, GeometryComesWithoutFramesAndOnChange) {
  std::atomic<int> geometry{1};
  add_output(network_, 0.0, &geometry);
  start();
  network_.sent.wait_for("geometry 1");
  geometry = 2;
  network_.sent.wait_for("geometry 2");
  EXPECT_LT(hal::MonotonicClock::read() - begin_, 900ms) << "a change is not kept for a second";
  std::this_thread::sleep_for(1500ms);
  publisher_->end();
  EXPECT_EQ(network_.sent.count("geometry 1"), 1U);
  EXPECT_GE(network_.sent.count("geometry 2"), 2U);
  EXPECT_LE(network_.sent.count("geometry 2"), 3U);
}

TEST_F(ThreadsPublisher, LostNetworkIsReportedOnceAndUsedAgain) {
  network_.up = false;
  add_output(network_);
  add_output(other_);
  start();
  for (std::uint64_t i = 0; i < 40; ++i) {
    write_frame(i);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_LT(network_.opened, 6) << "with growing pauses";
  network_.up = true;
  for (std::uint64_t i = 40; i < 1000 && network_.sent.texts().empty(); ++i) {
    write_frame(i);
    std::this_thread::sleep_for(10ms);
  }
  publisher_->end();
  EXPECT_FALSE(network_.sent.texts().empty());
  EXPECT_GE(other_.sent.texts().size(), 40U) << "the other output does not wait";
  EXPECT_GE(publisher_->outputs()[0]->not_sent(), 40U);
  const std::vector<std::string> expected = {"network: fake: the network is down; trying again",
                                             "network: fake: works again"};
  EXPECT_EQ(printed_.texts(), expected);
}

TEST_F(ThreadsPublisher, ExceptionLosesOneFrame) {
  add_output(network_);
  start();
  write_frame(1);
  write_frame(666);
  network_.sent.wait_for("frame 1");
  write_frame(666);
  write_frame(2);
  network_.sent.wait_for("frame 2");
  publisher_->end();
  EXPECT_EQ(printed_.texts(), std::vector<std::string>{"network: the publisher failed: no memory"});
}

}  // namespace
}  // namespace touchline::network
