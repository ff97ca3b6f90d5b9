#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/linux/fake_kernel.h"

namespace touchline::fake {

/// A dma-buf on a machine where DMA bypasses the caches: a mapping shows the content of the caches, which is up to date
/// only after the beginning of a read was announced.
class DmaBufferFile final : public File {
 public:
  explicit DmaBufferFile(std::size_t bytes) : memory_(bytes), cached_(bytes) {}

  /// The device writes. Writing during a read is a violation.
  void write(std::size_t offset, const std::vector<std::uint8_t>& bytes);

  bool is_dma = true;  // false: ordinary memory, which rejects the request
  int fail_with = 0;   // error of the next synchronization
  [[nodiscard]] std::size_t size() const { return memory_.size(); }
  [[nodiscard]] bool reading() const { return reading_; }
  [[nodiscard]] bool mapped() const { return mapped_; }
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] const std::string& violation() const { return violation_; }

  void close() override { closed_ = true; }
  int ioctl(unsigned long request, void* argument) override;
  void* map(std::size_t length, long offset, int protection) override;
  bool unmap(void* memory) override;

 private:
  std::vector<std::uint8_t> memory_, cached_;
  bool mapped_ = false, reading_ = false, closed_ = false;
  std::string violation_;
};

/// A heap in /dev/dma_heap.
class DmaHeapFile final : public File {
 public:
  std::size_t room = SIZE_MAX;  // number of free bytes
  [[nodiscard]] const std::vector<std::unique_ptr<DmaBufferFile>>& buffers() const { return buffers_; }

  [[nodiscard]] bool never_blocks() const override { return true; }
  int ioctl(unsigned long request, void* argument) override;

 private:
  std::vector<std::unique_ptr<DmaBufferFile>> buffers_;
};

}  // namespace touchline::fake
